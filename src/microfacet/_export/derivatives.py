"""Graphs as functions that JAX and PyTorch differentiate, by derivatives that are recorded with them.

Each derivative of a result by an input is a result of a larger graph: solvers in it are differentiated at
their solution, not through their steps, and only derivatives that are asked for are recorded and computed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from microfacet._export.density import density_of
from microfacet._export.evaluate import Evaluator
from microfacet._export.graph import Graph
from microfacet._export.guard import Interval, clamped, guarded, without_unused
from microfacet._export.libraries import Library
from microfacet._frozen import Distribution

__all__ = ["Recipe", "function", "graph_of", "tables_of"]

_KEPT = 512  # graphs, each some hundred kilobytes at most
Function = Callable[[Sequence[Any]], Sequence[Any]]


class Recipe(NamedTuple):
    """What a graph is recorded from.

    Attributes
    ----------
    source : str or Distribution
        The name of a family, or a distribution.
    parameters : tuple of (str, float or None)
        None is an input.
    tabulated : bool
        Whether tables for these values stand for the formulas.
    """

    source: str | Distribution
    quantity: str
    parameters: tuple[tuple[str, float | None], ...]
    domains: tuple[tuple[str, Interval], ...]
    float64: bool
    cosine: bool
    native: bool
    tabulated: bool


@lru_cache(_KEPT)
def tables_of(recipe: Recipe) -> bytes | None:
    """The tables that stand for the formulas; None where there are none, or none that are accurate."""
    density = density_of(recipe.source)
    try:
        return density.tables(dict(recipe.parameters), recipe.float64)
    except ValueError:
        return None


@lru_cache(_KEPT)
def graph_of(recipe: Recipe, by: tuple[str, ...] = ()) -> Graph:
    """The graph, with the derivatives of its results by these inputs."""
    density, parameters = density_of(recipe.source), dict(recipe.parameters)
    if recipe.tabulated and "alpha" in density.tabulated:
        parameters["alpha"] = 1.0  # is in the tables
    graph = Graph.of(
        density.name,
        recipe.quantity,
        parameters,
        float64=recipe.float64,
        derivatives=by,
        native=recipe.native,
        cosine=recipe.cosine,
        tables=tables_of(recipe) if recipe.tabulated else None,
    )
    return guarded(clamped(without_unused(graph, "xi"), "u"), dict(recipe.domains))


@lru_cache(_KEPT)
def _evaluator(recipe: Recipe, library: Library, by: tuple[str, ...] = ()) -> Evaluator:
    return Evaluator(graph_of(recipe, by), library)


def function(recipe: Recipe, library: Library) -> Function:
    """The results of a graph from a sequence of arrays, in the order of its inputs."""
    if library.differentiates == "jax":
        return _of_jax(recipe, library)
    if library.differentiates == "torch":
        return _of_torch(recipe, library)
    return _evaluator(recipe, library)


def _derivatives(
    evaluator: Evaluator, results: Sequence[Any], by: Sequence[str]
) -> tuple[list[Any], list[list[Any]]]:
    """The values, and for each of them its derivatives by each input; None where it does not depend on it."""
    named = {name: value for (name, _), value in zip(evaluator.graph.results, results, strict=True)}
    values = [name for name in named if "/" not in name]
    return [named[name] for name in values], [[named.get(f"{name}/{x}") for x in by] for name in values]


@lru_cache(_KEPT)
def _of_jax(recipe: Recipe, library: Library) -> Function:
    import jax
    from jax.custom_derivatives import SymbolicZero

    plain = _evaluator(recipe, library)
    names = plain.graph.inputs
    evaluate = jax.jit(lambda *inputs: plain(inputs))

    @jax.custom_jvp  # type: ignore[untyped-decorator]
    def values(*inputs: Any) -> Any:
        return evaluate(*inputs)

    def rule(inputs: Sequence[Any], tangents: Sequence[Any]) -> tuple[Any, Any]:
        moved = [i for i, tangent in enumerate(tangents) if not isinstance(tangent, SymbolicZero)]
        by = tuple(names[i] for i in moved)
        found, partials = _derivatives(
            _evaluator(recipe, library, by), _jax_derivatives(recipe, library, by)(*inputs), by
        )
        changes = []
        for value, row in zip(found, partials, strict=True):
            change = jax.numpy.zeros_like(value)
            for i, partial in zip(moved, row, strict=True):
                change = change if partial is None else change + partial * tangents[i]
            changes.append(change)
        return found, changes

    values.defjvp(rule, symbolic_zeros=True)
    return lambda inputs: values(*inputs)


@lru_cache(_KEPT)
def _jax_derivatives(recipe: Recipe, library: Library, by: tuple[str, ...]) -> Callable[..., Any]:
    import jax

    evaluator = _evaluator(recipe, library, by)
    evaluate = jax.jit(lambda *inputs: evaluator(inputs))

    @jax.custom_jvp  # type: ignore[untyped-decorator]
    def derivatives(*inputs: Any) -> Any:
        return evaluate(*inputs)

    @derivatives.defjvp  # type: ignore[untyped-decorator]
    def refuse(inputs: Any, tangents: Any) -> Any:
        raise NotImplementedError(f"array_functions: {recipe.quantity} has first derivatives alone")

    found: Callable[..., Any] = derivatives
    return found


@lru_cache(_KEPT)
def _of_torch(recipe: Recipe, library: Library) -> Function:
    torch = library.xp
    plain = _evaluator(recipe, library)
    names = plain.graph.inputs

    class Values(torch.autograd.Function):  # type: ignore[misc,name-defined]
        @staticmethod
        def forward(ctx: Any, *inputs: Any) -> Any:
            ctx.set_materialize_grads(False)
            ctx.moved = [i for i, needs in enumerate(ctx.needs_input_grad) if needs]
            by = tuple(names[i] for i in ctx.moved)
            evaluator = _evaluator(recipe, library, by)
            values, partials = _derivatives(evaluator, evaluator(inputs), by)
            ctx.shapes = [inputs[i].shape for i in ctx.moved]
            ctx.save_for_backward(*(partial for row in partials for partial in row))
            return tuple(values)

        @staticmethod
        @torch.autograd.function.once_differentiable  # type: ignore[untyped-decorator]
        def backward(ctx: Any, *changes: Any) -> Any:
            result = [None] * len(ctx.needs_input_grad)
            partials = iter(ctx.saved_tensors)
            for change in changes:
                for i, shape in zip(ctx.moved, ctx.shapes, strict=True):
                    partial = next(partials)
                    if change is not None and partial is not None:
                        part = (change * partial).sum_to_size(shape)
                        result[i] = part if result[i] is None else result[i] + part
            return tuple(result)

    def function(inputs: Sequence[Any]) -> Sequence[Any]:
        if torch.is_grad_enabled() and any(array.requires_grad for array in inputs):
            return tuple(Values.apply(*inputs))
        with torch.no_grad():
            return plain(inputs)

    return function
