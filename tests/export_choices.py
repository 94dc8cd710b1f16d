"""Families as tests export them, and rows of arguments for what they export."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import export_programs as programs
from microfacet._export.choice import Choice, chosen
from microfacet._export.density import density_of
from microfacet._export.file import Content, Tables, function_of, plain_file
from microfacet._export.functions import FUNCTIONS
from microfacet._export.graph import Graph
from microfacet._export.languages import languages
from microfacet._export.printer import Function

__all__ = ["choice_of", "file_of", "named", "rows_of"]


@cache
def choice_of(family: str, anisotropic: bool) -> Choice:
    """All parameters free; those that tables are made for have values."""
    density = density_of(family)
    fixed = {
        p.name: 0.3 if p.name == "alpha" else min(p.lower + 1.25, 0.5 * (p.lower + p.upper))
        for p in density.parameters
        if p.name in density.tabulated
    }
    return chosen(density, tuple(FUNCTIONS), fixed, None, anisotropic and density.anisotropic)


def file_of(
    language: str, choice: Choice, names: tuple[str, ...]
) -> tuple[str, dict[str, Function], dict[str, Graph]]:
    """The text, and what its functions take and give."""
    described = languages()[language]
    graphs = {name: choice.graph(name, described.native) for name in names}
    content = Content(programs.PREFIX, graphs, dict.fromkeys(names, "It."), [], choice.intervals)
    tables = Tables(described, programs.PREFIX)
    functions = {name: function_of(described, content, name, tables) for name in names}
    return plain_file(described, content), functions, graphs


def rows_of(function: Function, columns: dict[str, NDArray[Any]]) -> NDArray[np.float32]:
    """The arguments of a function, a row a call."""
    names = []
    for name, _, count in function.parameters:
        names += [name] if count == 1 else [f"{name}.{letter}" for letter in "xyzw"[:count]]
    return np.stack([columns[name].astype(np.float32) for name in names], axis=-1)


def named(graph: Graph, results: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
    return {name: results[:, i] for i, (name, _) in enumerate(graph.results)}
