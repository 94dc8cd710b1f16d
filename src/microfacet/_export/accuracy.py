"""How accurate an exported function is: its graph in single precision beside the library in double."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microfacet._export.choice import Choice
from microfacet._export.evaluate import Evaluator
from microfacet._export.functions import OPTICS, is_of_material
from microfacet._export.graph import Graph
from microfacet._export.libraries import library_of
from microfacet._export.points import parameter_sets, points

__all__ = ["error_of", "measured"]

_SETS, _POINTS = 16, 512
_MOST_OPERATIONS = 5000  # of graphs that are measured: it shall cost no more than printing does
# Smaller values count as 0: nobody sees them, and what single precision keeps of them ends soon.
_LEAST = 1e-20
_DIRECTIONS = ("m.", "wo.")
# At the edge of what a direction sees, the cosine to it is the small difference of large numbers.
_EDGE = 0.01

Columns = Mapping[str, NDArray[Any]]
Results = Mapping[str, NDArray[Any]]


def measured(graphs: Mapping[str, Graph], choice: Choice) -> list[str]:
    """Sentences on the errors found, for the head of a file; none where nothing is measured."""
    found = {
        name: error_of(name, graph, choice)
        for name, graph in graphs.items()
        if graph.operations <= _MOST_OPERATIONS
    }
    texts = {name: _upwards(error) for name, error in found.items() if not math.isnan(error)}
    kinds: dict[str, list[str]] = {"values": [], "materials": [], "directions": []}
    for name, text in texts.items():
        most = "materials" if is_of_material(name) or _is_a_ring(choice) else "values"
        kinds["directions" if "sample" in name else most].append(f"{name} {text}")
    sentences = {
        "values": "Largest relative errors found in single precision: {}.",
        "materials": "Relative errors of 99.9 % of the values: {}.",
        "directions": "Errors of 99.9 % of the directions drawn: {}.",
    }
    return [sentences[kind].format(", ".join(parts)) for kind, parts in kinds.items() if parts]


def _upwards(error: float) -> str:
    """To one digit, upwards."""
    if math.isinf(error):
        return "unbounded"
    exponent = math.floor(math.log10(max(error, 1e-12)))
    digit = math.ceil(error / 10.0**exponent - 1e-9)
    return f"1e{exponent + 1}" if digit == 10 else f"{digit}e{exponent}"


def error_of(
    function: str,
    graph: Graph,
    choice: Choice,
    evaluate: Callable[[Columns], Results] | None = None,
    sets: int = _SETS,
) -> float:
    """The largest relative error; that of 99.9 % of materials' and rings' values and of samples; or nan.

    Parameters
    ----------
    evaluate : callable, optional
        What gives the results from columns of inputs, both by their names; the graph on NumPy otherwise.
    sets : int
        How many values of the parameters there are, for each of which 512 points.
    """
    sampled = "sample" in function
    tables = choice.density.tabulated
    by_tables = choice.density.tables_alone or (bool(tables) and all(name in choice.fixed for name in tables))
    if sampled and by_tables and any(name.startswith("w") for name in graph.inputs):
        return math.nan  # tables take other uniforms for the same normal, each as exactly as the others
    values = parameter_sets(choice.of(function), choice.intervals, sets)
    given = [points(graph.inputs, one.get("alpha", one.get("alpha_x", 1.0)), _POINTS) for one in values]
    references = [_reference(function, choice, *pair) for pair in zip(given, values, strict=True)]
    columns = {name: np.concatenate([part[name] for part in given]) for name in given[0]}
    columns |= {name: np.repeat([one[name] for one in values], _POINTS) for name in values[0]}
    single = evaluate(columns) if evaluate else _results(graph, columns)
    if references[0]:
        exact = {name: np.concatenate([part[name] for part in references]) for name in references[0]}
    else:
        exact = _results(choice.graph(function, native=True, float64=True), columns)
    counted = np.ones(sets * _POINTS, bool)
    if "w.x" in columns and (sampled or "m.x" in columns):
        counted = np.concatenate([_seen(choice, *pair) for pair in zip(given, values, strict=True)])
    if _is_a_ring(choice) and not sampled:  # whose density is 0 or infinite, which is nothing to compare
        counted &= np.all(
            [np.isfinite(values) & (np.abs(values) > _LEAST) for values in exact.values()], axis=0
        )
    if not counted.any():
        return math.nan
    if sampled:
        distances = [_distance(single[name], exact[name]) for name in exact if name.startswith(_DIRECTIONS)]
        return float(np.quantile(np.max(distances, axis=0)[counted], 0.999, method="higher"))
    errors = np.max([_relative(single[name], exact[name])[counted] for name in exact], axis=0)
    # Half vectors of arbitrary directions are now and then a small difference, as is what is left next to the
    # end of a ring.
    if is_of_material(function) or _is_a_ring(choice):
        return float(np.quantile(errors, 0.999, method="higher"))
    return float(errors.max())


def _is_a_ring(choice: Choice) -> bool:
    return choice.density.family is not None and choice.density.family.singular


def _distance(single: NDArray[Any], exact: NDArray[Any]) -> NDArray[np.float64]:
    """Of components of directions; where there is none, none must be given."""
    far = np.abs(single.astype(np.float64) - exact)
    return np.where(np.isnan(single) & np.isnan(exact), 0.0, np.where(np.isnan(far), np.inf, far))


def _seen(choice: Choice, given: Columns, values: Mapping[str, float]) -> NDArray[np.bool_]:
    """Where a direction sees anything, and a normal is neither at the edge of it nor rare."""
    ndf: Any = choice.density.at(values)
    wide = {name: x.astype(np.float64) for name, x in given.items()}
    w = _array("w", wide)
    seen = ndf.sigma(w) > _LEAST
    if "m.x" in wide:
        m = _array("m", wide)
        seen &= (np.abs(np.sum(m * w, axis=-1)) > _EDGE) & (ndf.D(m) > _LEAST)
    return np.asarray(seen)


def _relative(single: NDArray[Any], exact: NDArray[Any]) -> NDArray[np.float64]:
    """Relative errors, of values that are not too small; of equal ones, nan too, there is none."""
    with np.errstate(all="ignore"):
        errors = np.abs(single.astype(np.float64) - exact) / np.abs(exact)
    alike = (single == exact) | (np.isnan(single) & np.isnan(exact)) | (np.abs(exact) < _LEAST)
    return np.where(alike, 0.0, np.where(np.isnan(errors), np.inf, errors))


def _results(graph: Graph, columns: Columns) -> dict[str, NDArray[Any]]:
    inputs = [columns[name].astype(graph.real) for name in graph.inputs]
    results = Evaluator(graph, library_of("numpy"))(inputs)
    return {name: np.asarray(value) for (name, _), value in zip(graph.results, results, strict=True)}


def _reference(
    function: str, choice: Choice, given: Columns, values: Mapping[str, float]
) -> dict[str, NDArray[Any]]:
    """What the library says in double precision; empty where its graph in double is to say it."""
    if any(name.partition(".")[0] in OPTICS for name in values):
        return {}
    if (
        function == "sample_visible" and choice.scheme == "mixture"
    ):  # tables take other uniforms than formulas
        return {}
    columns = {name: value.astype(np.float64) for name, value in given.items()}
    names = list(dict.fromkeys(name.partition(".")[0] for name in columns))
    arguments = [_array(name, columns) for name in sorted(names, key=_ORDER.index)]
    if function == "survival":
        family = choice.density.family
        if family is None:
            return {}
        shape = [values[parameter.name] for parameter in family.parameters]
        return {"value": family.kernels.survival(*arguments, *shape)}
    scheme = {"scheme": choice.scheme} if function == "sample_visible" else {}
    result = np.asarray(getattr(choice.density.at(values), function)(*arguments, **scheme))
    if function.startswith("sample"):
        return {f"m.{letter}": result[..., i] for i, letter in enumerate("xyz")}
    return {"value": result}


_ORDER = ("p", "q", "r", "m", "wi", "wo", "w", "xi")


def _array(name: str, columns: Columns) -> NDArray[Any]:
    if name in columns:
        return columns[name]
    return np.stack([columns[f"{name}.{c}"] for c in "xyzw" if f"{name}.{c}" in columns], axis=-1)
