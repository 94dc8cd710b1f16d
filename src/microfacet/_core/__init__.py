"""The compiled kernels, in the best build that this processor runs.

The same source is compiled for several instruction sets, each into a module of its own: ``baseline`` and, on
x86-64, ``avx2`` and ``avx512``. The environment variable ``MICROFACET_ISA`` forces one of them. Results are
the same bits in all builds that round a * b + c once, that is in all but an x86-64 baseline.
"""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec

from microfacet._core.processor import instruction_sets

__all__ = ["available", "isa"]

# Of those that the processor has; a compiler that lacks one leaves its module out.
available = tuple(name for name in instruction_sets() if find_spec(f"{__name__}.{name}"))


def _chosen() -> str:
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
radial = _kernels.radial
roughness = _kernels.roughness
fresnel_dielectric = _kernels.fresnel_dielectric
fresnel_conductor = _kernels.fresnel_conductor
globals().update({name: getattr(_kernels, name) for name in families})
