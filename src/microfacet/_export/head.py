"""What an exported file says of itself: its arguments with their domains, its accuracy, how it was made."""

from __future__ import annotations

import math
import shlex

from microfacet._export.accuracy import measured
from microfacet._export.choice import Choice
from microfacet._export.functions import OPTICS
from microfacet._export.graph import Graph
from microfacet._export.language import Language

__all__ = ["command", "head"]

# Between these ends of the roughness the headers keep their accuracy in single precision.
_SINGLE = (1e-6, 1e6)
_DIRECTIONS = (
    "Directions are unit vectors in the local frame (n = +z) that point away from the surface; "
    "xi and choice are uniform random numbers in [0, 1)."
)


def head(language: Language, choice: Choice, graphs: dict[str, Graph], prefix: str) -> list[str]:
    """The lines."""
    import microfacet as mf

    fixed = [f"{name} = {value!r}" for name, value in choice.fixed.items()]
    lines = [
        f"The {choice.density.title} distribution of microfacet normals in {language.title}.",
        "",
        _DIRECTIONS,
        language.note,
        "Arguments: " + "; ".join(_argument(name, *choice.intervals[name]) for name in choice.free) + "."
        if choice.free
        else "",
        "Fixed: " + ", ".join(fixed) + "." if fixed else "",
        "Mirrors send light back whence it came: wi is turned about the normal."
        if choice.retroreflective
        else "",
        *measured(graphs, choice),
        "Operations: " + ", ".join(f"{name} {graph.operations}" for name, graph in graphs.items()) + ".",
    ]
    return [
        *lines[:2],
        *filter(None, lines[2:]),
        "",
        *_origin(choice, mf.__version__, command(language, choice, list(graphs), prefix)),
        "SPDX-License-Identifier: BSD-3-Clause",
        "Copyright (c) 2026, The microfacet authors",
    ]


def _origin(choice: Choice, version: str, words: str) -> list[str]:
    if choice.density.radial is not None:
        return [f"Made by microfacet {version} from {choice.density.radial!r}."]
    return [f"Made by microfacet {version}; the same command makes it again:", f"  {words}"]


def _argument(name: str, lower: float, upper: float) -> str:
    """A name with its interval, which for roughness is that of single precision."""
    if math.isinf(lower):
        return f"{name} (radians)"
    if name in OPTICS:
        return f"{name} >= {lower:g}" if math.isinf(upper) else f"{name} in [{lower:g}, {upper:g}]"
    lower = _SINGLE[0] if 0.0 < lower < 1e-30 else lower
    upper = _SINGLE[1] if 1e30 < upper < math.inf else upper
    return f"{name} in ({lower:g}, {upper:g})"


def command(language: Language, choice: Choice, functions: list[str], prefix: str) -> str:
    """The command that makes the file again."""
    words = ["microfacet", "export", language.name, choice.density.name, "--functions", ",".join(functions)]
    if choice.free:
        words += ["--free", ",".join(choice.free)]
    for name, value in choice.fixed.items():
        if name == "rotation":
            words += ["--rotation", repr(math.degrees(value))] if value else []
        else:
            words += [f"--{name.replace('_', '-')}", repr(value)]
    words += ["--anisotropic"] if "alpha_x" in choice.parameters else []
    words += ["--scheme", choice.scheme] if choice.scheme != "mixture" else []
    words += ["--fresnel", choice.fresnel] if choice.fresnel != "conductor" else []
    words += ["--channels", str(choice.channels)] if choice.channels != 1 else []
    words += ["--retroreflective"] if choice.retroreflective else []
    return shlex.join([*words, *(["--prefix", prefix] if prefix else [])])
