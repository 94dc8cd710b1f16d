"""Domains: graphs hold the formulas of valid arguments, what is added here says nan where one is not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from microfacet._export.graph import Graph

__all__ = ["NUMBER", "Interval", "clamped", "cosines", "guarded", "without_unused"]


@dataclass(frozen=True)
class Interval:
    """Where an argument is valid."""

    lower: float
    upper: float
    with_lower: bool = False
    with_upper: bool = False


#: Anything but nan.
NUMBER = Interval(-np.inf, np.inf, True, True)


def cosines(real: str) -> Interval:
    """[-1, 1] and what the rounding of a normalised direction adds, in that precision."""
    most = 1 + 8 * float(np.finfo(real).eps)
    return Interval(-most, most, True, True)


def without_unused(graph: Graph, vector: str) -> Graph:
    """The graph without the components of a vector, such as uniform numbers, that it does not read."""
    read = {graph.value[node] for node, operation in enumerate(graph.operation) if operation == "input"}
    kept = [i for i, name in enumerate(graph.inputs) if i in read or not name.startswith(f"{vector}.")]
    value = tuple(
        kept.index(value) if operation == "input" else value
        for operation, value in zip(graph.operation, graph.value, strict=True)
    )
    return replace(graph, inputs=tuple(graph.inputs[i] for i in kept), value=value)


def clamped(graph: Graph, name: str) -> Graph:
    """The graph with an input that counts as 1 or -1 where it lies beyond."""
    places = [i for i, operation in enumerate(graph.operation) if operation == "input"]
    node = next((i for i in places if graph.inputs[graph.value[i]] == name), None)
    if node is None:
        return graph
    cut = node + 1  # where four nodes come in, of which the last stands for the input

    def moved(i: int) -> int:
        return i + 4 if i >= node else i

    def all_moved(nodes: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(map(moved, nodes))

    between = ((), (), (node, node + 1), (node + 3, node + 2))
    arguments = tuple(map(all_moved, graph.arguments))
    operations = ("literal", "literal", "maximum", "minimum")
    return replace(
        graph,
        operation=graph.operation[:cut] + operations + graph.operation[cut:],
        type=graph.type[:cut] + ("real",) * 4 + graph.type[cut:],
        arguments=arguments[:cut] + between + arguments[cut:],
        value=(*graph.value[:cut], -1.0, 1.0, None, None, *graph.value[cut:]),
        loop=graph.loop[:cut] + (-1,) * 4 + graph.loop[cut:],
        results=tuple((result, moved(i)) for result, i in graph.results),
        loops=tuple(
            replace(
                loop,
                initial=all_moved(loop.initial),
                moving=moved(loop.moving),
                state=all_moved(loop.state),
                next=all_moved(loop.next),
                unsettled=moved(loop.unsettled),
            )
            for loop in graph.loops
        ),
        branches=tuple(
            replace(
                branch,
                mask=moved(branch.mask),
                taken=all_moved(branch.taken),
                other=all_moved(branch.other),
            )
            for branch in graph.branches
        ),
    )


def guarded(graph: Graph, domains: Mapping[str, Interval]) -> Graph:
    """The graph with results that are nan wherever an input lies outside of its domain.

    Parameters
    ----------
    graph : Graph
    domains : mapping of str to Interval
        By the name of an input; one without a domain is anything but nan.
    """
    added = _Nodes(graph)
    present = {
        graph.value[node]: node for node, operation in enumerate(graph.operation) if operation == "input"
    }
    valid = None
    for place, name in enumerate(graph.inputs):
        node = present.get(place)
        if node is None:  # a quantity that does not depend on an argument has its domain nevertheless
            node = added.node("input", "real", value=place)
        condition = added.within(node, domains.get(name, NUMBER))
        valid = condition if valid is None else added.node("and", "mask", valid, condition)
    if valid is None:
        return graph
    nan = added.node("literal", "real", value=float("nan"))
    results = tuple((name, added.node("select", "real", valid, node, nan)) for name, node in graph.results)
    return replace(
        graph,
        operation=tuple(added.operation),
        type=tuple(added.type),
        arguments=tuple(added.arguments),
        value=tuple(added.value),
        loop=(*graph.loop, *[-1] * (len(added.operation) - len(graph.loop))),
        results=results,
    )


class _Nodes:
    """The nodes of a graph, and more."""

    def __init__(self, graph: Graph) -> None:
        self.operation, self.type = list(graph.operation), list(graph.type)
        self.arguments, self.value = list(graph.arguments), list(graph.value)
        self._largest = float(np.finfo(graph.real).max)

    def node(self, operation: str, kind: str, *arguments: int, value: object = None) -> int:
        self.operation.append(operation)
        self.type.append(kind)
        self.arguments.append(arguments)
        self.value.append(value)
        return len(self.operation) - 1

    def within(self, node: int, domain: Interval) -> int:
        """A mask; nan lies in no interval."""
        if domain == NUMBER:
            return self.node("equal", "mask", node, node)
        above = "greater_equal" if domain.with_lower else "greater"
        below = "less_equal" if domain.with_upper else "less"
        return self.node(
            "and",
            "mask",
            self.node(above, "mask", node, self._number(domain.lower)),
            self.node(below, "mask", node, self._number(domain.upper)),
        )

    def _number(self, value: float) -> int:
        """A bound beyond the range of the precision is infinite."""
        if abs(value) > self._largest:
            value = float(np.copysign(np.inf, value))
        return self.node("literal", "real", value=value)
