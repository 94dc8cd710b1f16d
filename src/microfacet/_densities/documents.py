"""How a density is written down: a small document of numbers, as JSON or as an npz file.

::

    {"kind": "microfacet density", "version": 1,
     "P22": {"r": [...], "values": [...], "interpolation": "cubic", "beyond": "power"},
     "alpha": 0.3}

In place of P22 there may be {"D": {"theta": [...] or "u": [...], "values": [...], "beyond": ...}} or
{"histogram": {"edges": [...], "counts": [...]}}. What says how P22 goes on between and beyond the points may
be missing, and so may the roughness (alpha, or alpha_x and alpha_y with rotation). An npz file has the same
under names such as "P22.r".
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._densities.curve import column
from microfacet._densities.nodes import sampled
from microfacet._files import ending, replacing
from microfacet._text import listed, printable

__all__ = ["KIND", "PARTS", "VERSION", "described", "document_of", "flattened", "slopes_of_angles", "write"]

Array = NDArray[np.float64]

KIND, VERSION = "microfacet density", 1
#: What describes the density, and the numbers of each.
PARTS = {
    "P22": ("r", "values", "powers", "interpolation", "beyond"),
    "D": ("theta", "u", "values", "beyond"),
    "histogram": ("edges", "counts"),
}
_ROUGHNESS = ("alpha", "alpha_x", "alpha_y", "rotation")


def slopes_of_angles(theta: ArrayLike | None, u: ArrayLike | None, D: ArrayLike) -> tuple[Array, Array]:
    """Slopes, increasing, and P22 there, from angles or cosines and D."""
    if (theta is None) == (u is None):
        raise ValueError("RadialNDF: give either theta or u, the angles of D or their cosines")
    values = column("D", D)
    if u is None:
        assert theta is not None
        angles = column("theta", theta)
        if not (np.all(np.diff(angles) > 0.0) and np.all((angles >= 0.0) & (angles <= math.pi / 2 + 1e-12))):
            raise ValueError("RadialNDF: theta must increase in [0, pi/2], in radians")
        cosines, r = np.cos(angles), np.tan(np.minimum(angles, math.pi / 2))
        horizon = angles > math.pi / 2 - 1e-12
    else:
        cosines = column("u", u)
        if len(cosines) > 1 and cosines[0] < cosines[-1] and len(cosines) == len(values):
            cosines, values = cosines[::-1], values[::-1]
        if not (np.all(np.diff(cosines) < 0.0) and np.all((cosines >= 0.0) & (cosines <= 1.0))):
            raise ValueError(
                "RadialNDF: u must be monotone in [0, 1], cosines of angles from the macronormal"
            )
        horizon = cosines == 0.0
        r = np.sqrt((1.0 - cosines) * (1.0 + cosines)) / np.where(horizon, 1.0, cosines)
    if len(cosines) != len(values):
        raise ValueError(f"RadialNDF: D needs as many values as angles, got {len(values)} of {len(cosines)}")
    if np.any(values < 0.0):
        at = int(np.argmax(values < 0.0))
        where = math.degrees(math.acos(cosines[at]))
        raise ValueError(f"RadialNDF: D must not be negative, got {values[at]:g} at {where:g} degrees")
    seen = ~horizon  # no slope belongs to a vertical facet
    return r[seen], (values * cosines**4)[seen]


def described(document: Any) -> tuple[str, dict[str, Any], dict[str, float]]:
    """Which of PARTS a document has, what stands there, and its roughness; ValueError where it is none."""
    if not isinstance(document, Mapping) or document.get("kind") != KIND:
        raise ValueError(f'it is no density: its "kind" is not "{KIND}"')
    if document.get("version") != VERSION:
        given = printable(repr(document.get("version")))
        raise ValueError(f"its version is {given}, this library reads version {VERSION}")
    unknown = set(document) - {"kind", "version", *PARTS, *_ROUGHNESS}
    if unknown:
        raise ValueError(f"it has the unknown keys {listed(sorted(unknown))}")
    parts = [name for name in PARTS if name in document]
    if len(parts) != 1:
        raise ValueError(f"it must have one of {', '.join(PARTS)}, got {listed(parts) or 'none'}")
    part, content = parts[0], document[parts[0]]
    if not isinstance(content, Mapping) or set(content) - set(PARTS[part]):
        raise ValueError(f"{part} may have the keys {', '.join(PARTS[part])} alone")
    roughness = {}
    for name in _ROUGHNESS:
        if name in document:
            value = document[name]
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ValueError(f"{name} must be a number, got {printable(repr(value))}")
            roughness[name] = float(value)
    return part, dict(content), roughness


def flattened(document: Mapping[str, Any]) -> dict[str, Any]:
    """The document with one level, as the arrays of an npz file are named."""
    flat: dict[str, Any] = {}
    for name, value in document.items():
        flat |= {f"{name}.{key}": part for key, part in value.items()} if name in PARTS else {name: value}
    return flat


def write(path: str | Path, document: Mapping[str, Any]) -> None:
    """Write FILE.json or FILE.npz, whole or not at all; a pipe gets JSON."""
    if ending(path, (".json", ".npz"), ".json") == ".npz":
        arrays = {name: np.asarray(value) for name, value in flattened(document).items()}
        with replacing(path) as stream:
            np.savez(stream, **arrays)  # type: ignore[arg-type]
        return
    text = json.dumps(document, allow_nan=False)
    with replacing(path) as stream:
        stream.write(text.encode() + b"\n")


def document_of(ndf: Any) -> dict[str, Any]:
    """A distribution of a density of one's own, with P22 at as many slopes as a cubic needs."""
    standard = ndf.with_roughness(alpha=1.0)
    x, y, turn = ndf._values[:3]
    axes = {"alpha": x} if x == y and turn == 0.0 else {"alpha_x": x, "alpha_y": y, "rotation": turn}
    P22 = sampled(lambda log_r: standard.P22(np.exp(log_r), 0.0))
    return {"kind": KIND, "version": VERSION, "P22": P22, **axes}
