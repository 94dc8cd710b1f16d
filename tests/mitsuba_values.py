"""Values of Mitsuba's rough materials: ``python mitsuba_values.py DIRECTIONS.npz VALUES.npz``.

In a process of its own: Dr.Jit compiles with whatever LLVM library it finds, and an unsuitable one can end
the process.
"""

from __future__ import annotations

import sys
from typing import Any

import mitsuba
import numpy as np

mitsuba.set_variant("llvm_ad_rgb")

ROUGHNESS = {"alpha_u": 0.2, "alpha_v": 0.5}
METAL = {"eta": [0.2, 1.04, 1.18], "k": [3.9, 2.6, 2.4]}
ETA = 1.5
MODES = {"radiance": mitsuba.TransportMode.Radiance, "importance": mitsuba.TransportMode.Importance}


def vectors(w: Any) -> Any:
    return mitsuba.Vector3f(*(mitsuba.Float(np.ascontiguousarray(w[:, k])) for k in range(3)))


def values(wi: Any, wo: Any) -> dict[str, Any]:
    """f |cos| and densities by name, of directions (n, 3) in single precision."""
    found = {}
    interaction = mitsuba.SurfaceInteraction3f()
    interaction.wi = vectors(wi)
    for family in ("ggx", "beckmann"):
        metal = mitsuba.load_dict(
            {
                "type": "roughconductor",
                "distribution": family,
                **ROUGHNESS,
                **{name: {"type": "rgb", "value": value} for name, value in METAL.items()},
            }
        )
        context = mitsuba.BSDFContext()
        found[f"{family}-metal"] = np.array(metal.eval(context, interaction, vectors(wo))).T
        found[f"{family}-metal-pdf"] = np.array(metal.pdf(context, interaction, vectors(wo)))
        glass = mitsuba.load_dict(
            {"type": "roughdielectric", "distribution": family, **ROUGHNESS, "int_ior": ETA, "ext_ior": 1.0}
        )
        for name, mode in MODES.items():
            value = np.array(glass.eval(mitsuba.BSDFContext(mode), interaction, vectors(wo)))
            found[f"{family}-{name}"] = value.reshape(-1, len(wi))[0]
    return found


if __name__ == "__main__":
    given = np.load(sys.argv[1])
    np.savez(sys.argv[2], **values(given["wi"], given["wo"]))
