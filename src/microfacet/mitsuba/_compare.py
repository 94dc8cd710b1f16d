"""How far plugins are from Mitsuba's own: ``python _compare.py LIBRARY VARIANT``.

The last line of the output is JSON: relative deviations by name, "eval of microfacet_conductor" and so on.
Nothing here knows the rest of the package: its import would register plugins that have not been checked.
"""

from __future__ import annotations

import ctypes
import json
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ETA = 1.5
COMMON = {"distribution": "ggx", "alpha": 0.3}
METAL = {**COMMON, "eta": 0.2, "k": 3.9}
GLASS = {**COMMON, "int_ior": ETA, "ext_ior": 1.0}
PAIRS = {
    "microfacet_conductor": ("roughconductor", METAL),
    "microfacet_dielectric": ("roughdielectric", GLASS),
}
N = 24


def directions(transmit: bool) -> tuple[Array, Array]:
    """Pairs near the mirror direction, or near the refracted one, apart from grazing and critical angles."""
    k = np.arange(N)
    theta, phi = 0.1 + 0.7 * k / N, 2.4 * k
    wi = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    x, y = -wi[:, 0] + 0.2 * np.cos(5.0 * k), -wi[:, 1] + 0.2 * np.sin(5.0 * k)
    if transmit:
        x, y = x / ETA, y / ETA
    z = np.sqrt(1.0 - x**2 - y**2)
    return wi, np.stack([x, y, -z if transmit else z], axis=-1)


def rows(value: Any, n: int, polarized: bool) -> Array:
    """Numbers of `n` directions, shape (n, channels); of a Mueller matrix its first entry, the intensity."""
    array = np.asarray(value, dtype=np.float64)
    if polarized and array.ndim >= 2:
        array = array[0, 0]
    return array.reshape(-1, n).T


def values(mi: Any, bsdf: Any, wi: Array, wo: Array) -> dict[str, Array]:
    """eval, pdf and a sample of each pair; scalar variants take one at a time."""
    count = 1 if mi.variant().startswith("scalar") else len(wi)
    polarized = "polarized" in mi.variant()
    context = mi.BSDFContext()
    found: dict[str, list[Array]] = {"eval": [], "pdf": [], "weight": [], "wo": [], "sample pdf": []}
    for at in range(0, len(wi), count):
        chosen = slice(at, at + count)
        interaction = mi.SurfaceInteraction3f()
        interaction.wi = vectors(mi, wi[chosen])
        out = vectors(mi, wo[chosen])
        xi = np.modf(np.arange(at, at + count) * 0.618034)[0]
        first, x, y = (number(mi, np.modf(factor * xi)[0]) for factor in (1.0, 7.0, 13.0))
        sampled, weight = bsdf.sample(context, interaction, first, mi.Point2f(x, y))
        for name, value in (
            ("eval", bsdf.eval(context, interaction, out)),
            ("pdf", bsdf.pdf(context, interaction, out)),
            ("weight", weight),
            ("wo", sampled.wo),
            ("sample pdf", sampled.pdf),
        ):
            found[name].append(rows(value, count, polarized and name in ("eval", "weight")))
    return {name: np.concatenate(parts) for name, parts in found.items()}


def number(mi: Any, x: Array) -> Any:
    single = x.astype(np.float32)
    return float(single[0]) if mi.variant().startswith("scalar") else mi.Float(single)


def vectors(mi: Any, w: Array) -> Any:
    return mi.Vector3f(*(number(mi, np.ascontiguousarray(w[:, axis])) for axis in range(3)))


def deviation(value: Array, expected: Array | float) -> float:
    """The largest relative one; a zero has to be a zero, and the whole must not be zero."""
    if not np.any(expected > 1e-3):
        return float("inf")
    scale = np.where(expected != 0.0, np.abs(expected), 1.0)
    return float(np.max(np.abs(value - expected) / scale))


def compare(mi: Any, ours: str) -> dict[str, float]:
    """Deviations of one plugin from Mitsuba's own of the same parameters."""
    theirs, parameters = PAIRS[ours]
    worst = {f"{what} of {ours}": 0.0 for what in ("eval", "pdf", "sample")}
    builtin = mi.load_dict({"type": theirs, **parameters})
    try:
        plugin = mi.load_dict({"type": ours, "correlated": False, **parameters})
    except RuntimeError as error:
        if f"{ours}: " not in str(error):
            raise
        return dict.fromkeys(worst, float("inf"))  # it reads other values than the ones that are given
    for transmit in (False, True) if ours == "microfacet_dielectric" else (False,):
        wi, wo = directions(transmit)
        here, there = values(mi, plugin, wi, wo), values(mi, builtin, wi, wo)
        # Theirs in the directions that ours drew. A sample of no weight has no direction.
        drawn = np.flatnonzero(np.any(here["weight"] != 0.0, axis=-1))
        again = values(mi, builtin, wi[drawn], here["wo"][drawn]) if 2 * len(drawn) > N else {}
        density = here["sample pdf"][drawn]
        for what, value, expected in (
            ("eval", here["eval"], there["eval"]),
            ("pdf", here["pdf"], there["pdf"]),
            ("sample", density, again.get("pdf", np.nan)),
            ("sample", density * here["weight"][drawn], again.get("eval", np.nan)),
        ):
            name = f"{what} of {ours}"
            worst[name] = float(np.maximum(worst[name], deviation(value, expected)))  # nan stays
    return worst


def main(path: str, variant: str) -> None:
    import mitsuba as mi

    mi.set_variant(variant)
    library = ctypes.CDLL(path)
    library.microfacet_register.restype = ctypes.c_char_p
    refusal = library.microfacet_register()
    if refusal is not None:
        raise SystemExit(refusal.decode(errors="replace"))
    found: dict[str, float] = {}
    for ours in PAIRS:
        found.update(compare(mi, ours))
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
