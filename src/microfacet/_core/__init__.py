"""The compiled kernels, in the best build that this processor runs.

The same source is compiled for instruction sets, each into a module of its own: ``baseline`` and, on x86-64,
``avx2`` and ``avx512``; a wheel holds all of them, a build from source the best of its machine. The
environment variable ``MICROFACET_ISA`` forces one of them. Results are the same bits in all builds that round
a * b + c once, that is in all but an x86-64 baseline.
"""

from __future__ import annotations

import os
from importlib import import_module
from pkgutil import iter_modules

from microfacet._core.processor import instruction_sets

__all__ = ["available", "isa"]

# Of those that the processor has: a wheel holds all, a local build the best one of its machine.
_built = [module.name for module in iter_modules(__path__) if module.name != "processor"]
available = tuple(name for name in instruction_sets() if name in _built)


def _chosen() -> str:
    if not available:
        raise ImportError(
            f"microfacet was built for {', '.join(_built)}, which this processor does not have: build it on "
            "this machine, or for all machines with MICROFACET_INSTRUCTION_SETS=all in the environment of pip"
        )
    forced = os.environ.get("MICROFACET_ISA")
    if forced is None:
        return available[-1]
    if forced not in available:
        raise ImportError(f"MICROFACET_ISA must be one of {', '.join(available)} here, got {forced!r}")
    return forced


isa = _chosen()
_kernels = import_module(f"{__name__}.{isa}")
families = _kernels.families
exp = _kernels.exp
radial, prepared = _kernels.radial, _kernels.prepared
roughness = _kernels.roughness
slopes = _kernels.slopes
fresnel_dielectric = _kernels.fresnel_dielectric
fresnel_conductor = _kernels.fresnel_conductor
globals().update({name: getattr(_kernels, name) for name in families})
