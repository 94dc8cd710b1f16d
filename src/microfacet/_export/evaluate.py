"""A graph evaluated on the arrays of NumPy, CuPy, JAX or PyTorch: one call of the library for each node.

What does not depend on large arrays is computed on the small ones, so that parameters which are single
numbers cost nothing. NumPy's large arrays are taken block by block: intermediate values then stay in the
cache.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from microfacet._export.graph import Graph
from microfacet._export.libraries import Library
from microfacet._export.program import Program, Step

__all__ = ["Evaluator"]

Values = list[Any]


class _Bound(NamedTuple):
    """A step with the function that computes it: of the values that it reads, or of all."""

    node: int
    function: Callable[..., Any]
    reads: tuple[int, ...] | None
    last_use_of: tuple[int, ...]


def _run(steps: Sequence[_Bound], values: Values) -> None:
    for node, function, reads, last_use_of in steps:
        values[node] = function(values) if reads is None else function(*[values[read] for read in reads])
        for done in last_use_of:
            values[done] = None


class Evaluator:
    """The results of a graph from its inputs, with one library.

    Parameters
    ----------
    graph : Graph
    library : Library
    """

    def __init__(self, graph: Graph, library: Library) -> None:
        self.graph, self.library = graph, library
        self._program = Program(graph)
        self._inputs = [(node, graph.value[node]) for node in self._program.nodes_of("input")]
        self._results = [node for _, node in graph.results]
        integer = "int32" if graph.real == "float32" else "int64"
        self._types = {"real": graph.real, "integer": integer, "mask": "bool"}
        self._steps = {
            scope: [self._bound(step) for step in steps] for scope, steps in self._program.steps.items()
        }
        self._constants: dict[str, Values] = {}
        self._tables: dict[tuple[str, int], Any] = {}

    def __call__(self, inputs: Sequence[Any]) -> list[Any]:
        """The results in the graph's order, each of the shape that the inputs broadcast to.

        Parameters
        ----------
        inputs : sequence of arrays
            In the graph's order and of its type.
        """
        shape = np.broadcast_shapes(*(tuple(array.shape) for array in inputs))
        with np.errstate(all="ignore"):
            block = self.library.block
            if block is not None and np.prod(shape, dtype=int) > block:
                return self._in_blocks(inputs, shape, block)
            values = self._given(inputs)
            _run(self._steps[-1], values)
        return [self.library.broadcast(values[node], shape) for node in self._results]

    def _in_blocks(self, inputs: Sequence[Any], shape: tuple[int, ...], block: int) -> list[Any]:
        """First what single numbers decide, then the rest for one stretch of the elements after the other."""
        single = frozenset(i for i, array in enumerate(inputs) if array.size == 1)
        flat = [
            array.reshape(()) if i in single else np.broadcast_to(array, shape).reshape(-1)
            for i, array in enumerate(inputs)
        ]
        inputs_of = self._program.inputs_of
        once = [step._replace(last_use_of=()) for step in self._steps[-1] if inputs_of[step.node] <= single]
        decided = {step.node for step in once}
        each = [
            step._replace(last_use_of=tuple(set(step.last_use_of) - decided))
            for step in self._steps[-1]
            if step.node not in decided
        ]
        common = self._given([array if i in single else None for i, array in enumerate(flat)])
        _run(once, common)
        results = [np.empty(shape, self.graph.real) for _ in self._results]
        rows = [result.reshape(-1) for result in results]
        for begin in range(0, rows[0].size, block):
            part, values = slice(begin, begin + block), list(common)
            for node, i in self._inputs:
                values[node] = flat[i] if i in single else flat[i][part]
            _run(each, values)
            for row, node in zip(rows, self._results, strict=True):
                row[part] = values[node]
        return results

    def _given(self, inputs: Sequence[Any]) -> Values:
        """All values before the first step: numbers of the graph and inputs stand there."""
        place = self.library.place_of(inputs)
        if place not in self._constants:
            literals: Values = [None] * (self._program.count + len(self.graph.loops))
            for node in self._program.nodes_of("literal"):
                dtype = self._types[self.graph.type[node]]
                literals[node] = self.library.literal(self.graph.value[node], dtype, place)
            self._constants[place] = literals
        values = list(self._constants[place])
        for node, i in self._inputs:
            values[node] = inputs[i]
        return values

    def _bound(self, step: Step) -> _Bound:
        node, last_use_of = step
        if node >= self._program.count:
            return _Bound(node, partial(self._loop, node - self._program.count), None, last_use_of)
        operation, value = self.graph.operation[node], self.graph.value[node]
        function: Callable[..., Any]
        if operation == "loop_result":
            function = itemgetter(value[1])
        elif operation == "branch_result":
            function = self.library.operations["select"]
        elif operation == "table":
            function = partial(self._looked_up, value)
        else:
            function = self.library.operations[operation]
        return _Bound(node, function, self._program.reads(node), last_use_of)

    def _looked_up(self, number: int, index: Any) -> Any:
        key = self.library.place_of([index]), number
        if key not in self._tables:
            self._tables[key] = self.library.table(self.graph.tables[number], key[0])
        return self.library.take(self._tables[key], index)

    def _loop(self, number: int, values: Values) -> list[Any]:
        """The final states of a loop, of the shape of the inputs that it depends on."""
        loop = self.graph.loops[number]
        inputs_of = self._program.inputs_of[self._program.count + number]
        shapes = [tuple(values[node].shape) for node, i in self._inputs if i in inputs_of]
        broadcast = partial(self.library.broadcast, shape=np.broadcast_shapes(*shapes))

        def turn(states: list[Any]) -> tuple[list[Any], Any]:
            own = list(values)
            for node, state in zip(loop.state, states, strict=True):
                own[node] = state
            _run(self._steps[number], own)
            return [broadcast(own[node]) for node in loop.next], broadcast(own[loop.unsettled])

        initial = [broadcast(values[node]) for node in loop.initial]
        return self.library.loop(loop.most, broadcast(values[loop.moving]), initial, turn)
