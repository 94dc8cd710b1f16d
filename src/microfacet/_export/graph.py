"""A quantity as a graph of operations: what the recording scalar of the headers leaves behind.

Printers write a graph in another language, the evaluator runs it on arrays. Nodes stand after their
arguments; loops and branches are statements whose results are nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAVES", "OPERATIONS", "RESULTS", "Branch", "Graph", "Loop"]

#: Operations and how many arguments each takes.
OPERATIONS: Mapping[str, int] = {
    **dict.fromkeys(("literal", "input", "state", "loop_result", "branch_result"), 0),
    **dict.fromkeys(("negate", "absolute", "sqrt", "floor", "exp", "log", "expm1", "log1p", "sin", "cos"), 1),
    **dict.fromkeys(("from_bits", "bits", "table", "not"), 1),
    **dict.fromkeys(("add", "subtract", "multiply", "divide", "minimum", "maximum", "pow", "and", "or"), 2),
    **dict.fromkeys(("shift_left", "shift_right", "shift_right_logical"), 2),
    **dict.fromkeys(("less", "less_equal", "greater", "greater_equal", "equal", "not_equal"), 2),
    **dict.fromkeys(("multiply_add", "select"), 3),
}
#: Nodes that a statement gives, rather than an expression.
RESULTS = frozenset({"loop_result", "branch_result"})
#: Nodes that need no calculation.
LEAVES = frozenset({"literal", "input", "state"}) | RESULTS
_TYPES = frozenset({"real", "integer", "mask"})


@dataclass(frozen=True)
class Loop:
    """At most `most` turns of `state` = `next` while `moving`, which becomes `unsettled` after each turn."""

    most: int
    parent: int
    initial: tuple[int, ...]
    moving: int
    state: tuple[int, ...]
    next: tuple[int, ...]
    unsettled: int


@dataclass(frozen=True)
class Branch:
    """The values `taken` where `mask` holds, else `other`: leaving out one side pays."""

    mask: int
    taken: tuple[int, ...]
    other: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Graph:
    """Nodes in an order in which they can be computed, what they take and what they give.

    Attributes
    ----------
    real : str
        "float32" or "float64", the type of real nodes; integers have the same width.
    operation, type, arguments, value, loop : tuple
        One entry a node: a key of `OPERATIONS`; "real", "integer" or "mask"; the nodes it is computed from;
        what else it needs (a number, an index); and the innermost loop on which it depends, -1 for none.
    inputs : tuple of str
        Names of the arguments, for instance "w.x".
    results : tuple of (str, int)
        Names and nodes of the results.
    loops, branches : tuple
        Statements.
    tables : tuple of ndarray
        Constant numbers that are looked up by index.
    """

    real: str
    operation: tuple[str, ...]
    type: tuple[str, ...]
    arguments: tuple[tuple[int, ...], ...]
    value: tuple[Any, ...]
    loop: tuple[int, ...]
    inputs: tuple[str, ...]
    results: tuple[tuple[str, int], ...]
    loops: tuple[Loop, ...]
    branches: tuple[Branch, ...]
    tables: tuple[NDArray[Any], ...]

    @classmethod
    def of(cls, family: str, quantity: str, parameters: Mapping[str, float | None], **options: Any) -> Graph:
        """Record a quantity of a family; a parameter that is None is an argument, a number is folded in."""
        from microfacet import _graphs  # type: ignore[attr-defined,unused-ignore]

        return cls.from_record(_graphs.record(family, quantity, dict(parameters), **options))

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Graph:
        """The graph in the form in which the compiled core hands it over; ValueError if it is not sound."""

        def nodes(values: Any) -> tuple[int, ...]:
            return tuple(int(value) for value in values)

        graph = cls(
            real=record["real"],
            operation=tuple(record["operation"]),
            type=tuple(record["type"]),
            arguments=tuple(map(nodes, record["arguments"])),
            value=tuple(
                tuple(value) if isinstance(value, list | tuple) else value for value in record["value"]
            ),
            loop=nodes(record["loop"]),
            inputs=tuple(record["inputs"]),
            results=tuple((name, int(node)) for name, node in record["results"]),
            loops=tuple(
                Loop(
                    int(loop["most"]),
                    int(loop["parent"]),
                    nodes(loop["initial"]),
                    int(loop["moving"]),
                    nodes(loop["state"]),
                    nodes(loop["next"]),
                    int(loop["unsettled"]),
                )
                for loop in record["loops"]
            ),
            branches=tuple(
                Branch(int(branch["mask"]), nodes(branch["taken"]), nodes(branch["other"]))
                for branch in record["branches"]
            ),
            tables=tuple(np.asarray(table) for table in record["tables"]),
        )
        graph._check()
        return graph

    def needs(self, node: int) -> tuple[int, ...]:
        """All nodes that must be known before a node is: its arguments, or those of its statement."""
        if self.operation[node] == "loop_result":
            loop = self.loops[self.value[node][0]]
            return (*loop.initial, loop.moving, *loop.next, loop.unsettled)
        if self.operation[node] == "branch_result":
            branch = self.branches[self.value[node][0]]
            return (branch.mask, *branch.taken, *branch.other)
        return self.arguments[node]

    @property
    def operations(self) -> int:
        """How many operations: a product with a sum counts once, a literal with its sign not at all."""
        return sum(self.counts(node) for node in range(len(self.operation)))

    def counts(self, node: int) -> bool:
        """Whether a node is an operation."""
        operation = self.operation[node]
        if operation == "negate":
            return self.operation[self.arguments[node][0]] != "literal"
        return operation not in LEAVES

    def _check(self) -> None:
        count = len(self.operation)
        columns = (self.type, self.arguments, self.value, self.loop)
        if any(len(column) != count for column in columns):
            raise ValueError(f"graph: {count} operations, but {[len(column) for column in columns]} entries")
        if self.real not in ("float32", "float64"):
            raise ValueError(f"graph: real must be float32 or float64, got {self.real!r}")
        for node in range(count):
            self._check_node(node)
        for name, node in self.results:
            if not 0 <= node < count:
                raise ValueError(f"graph: result {name} is node {node} of {count}")
        for loop in self.loops:
            if not len(loop.initial) == len(loop.state) == len(loop.next):
                raise ValueError("graph: a loop has as many initial and next values as it has states")

    def _check_node(self, node: int) -> None:
        operation, arguments = self.operation[node], self.arguments[node]
        if operation not in OPERATIONS:
            raise ValueError(f"graph: node {node} is {operation!r}, which is no operation")
        if self.type[node] not in _TYPES:
            raise ValueError(f"graph: node {node} has the type {self.type[node]!r}")
        if operation not in RESULTS and len(arguments) != OPERATIONS[operation]:
            raise ValueError(f"graph: {operation} of node {node} takes {OPERATIONS[operation]} arguments")
        if any(not 0 <= argument < node for argument in self.needs(node)):
            raise ValueError(f"graph: node {node} stands before what it needs")
