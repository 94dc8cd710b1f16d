"""A graph in the order of its evaluation: what is computed once, what in each turn, what is freed."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from microfacet._export.graph import Graph

__all__ = ["Program", "Step"]

_GIVEN = ("literal", "input", "state")  # nodes that stand there before any step


class Step(NamedTuple):
    """A node or a whole loop, and the values that nothing needs after it."""

    node: int
    last_use_of: tuple[int, ...]


class Program:
    """Where each node of a graph is evaluated.

    A run keeps its values in one list: those of the nodes, followed by the final states of the loops.

    Parameters
    ----------
    graph : Graph
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.count = len(graph.operation)
        self._loop_of_state = {state: i for i, loop in enumerate(graph.loops) for state in loop.state}
        self._body: dict[int, list[int]] = {scope: [] for scope in range(-1, len(graph.loops))}
        for node, loops in enumerate(self._states_behind()):
            self._body[max(loops, key=self._depth, default=-1)].append(node)
        #: What is computed in each turn of a loop, in order; under -1 what is computed once.
        self.steps: dict[int, list[Step]] = {}
        for scope in sorted(self._body, key=self._depth, reverse=True):  # loops inside of others first
            self.steps[scope] = self._with_last_uses(scope, self._order(scope))

    def nodes_of(self, operation: str) -> list[int]:
        """All nodes of an operation."""
        return [node for node, name in enumerate(self.graph.operation) if name == operation]

    def reads(self, node: int) -> tuple[int, ...]:
        """The values that a node is computed from; a result of a loop is one of the loop's final states."""
        operation, value = self.graph.operation[node], self.graph.value[node]
        if operation == "loop_result":
            return (self.count + value[0],)
        if operation == "branch_result":
            branch = self.graph.branches[value[0]]
            return branch.mask, branch.taken[value[1]], branch.other[value[1]]
        return tuple(self.graph.arguments[node])

    @cached_property
    def inputs_of(self) -> list[frozenset[int]]:
        """The inputs on which each value depends, by their place."""
        found: list[frozenset[int]] = [frozenset()] * (self.count + len(self.graph.loops))
        for node in self.nodes_of("input"):
            found[node] = frozenset([self.graph.value[node]])
        while True:  # a state depends on what follows it: until nothing changes
            before = list(found)
            for node, operation in enumerate(self.graph.operation):
                if operation == "state":
                    found[node] = found[self.count + self._loop_of_state[node]]
                elif operation != "input":
                    found[node] = frozenset().union(*(found[read] for read in self.reads(node)))
            for loop in range(len(self.graph.loops)):
                found[self.count + loop] = frozenset().union(*(found[part] for part in self._parts(loop)))
            if found == before:
                return found

    def _parts(self, loop: int) -> tuple[int, ...]:
        of = self.graph.loops[loop]
        return (*of.initial, of.moving, *of.next, of.unsettled)

    def _states_behind(self) -> list[frozenset[int]]:
        """The loops on whose states each node depends."""
        found: list[frozenset[int]] = []
        for node, operation in enumerate(self.graph.operation):
            if operation == "state":
                found.append(frozenset([self._loop_of_state[node]]))
            elif operation == "loop_result":
                loop = self.graph.value[node][0]
                found.append(frozenset().union(*(found[part] for part in self._parts(loop))) - {loop})
            else:
                found.append(frozenset().union(*(found[read] for read in self.reads(node))))
        return found

    def _depth(self, loop: int) -> int:
        return 0 if loop < 0 else 1 + self._depth(self.graph.loops[loop].parent)

    def _order(self, scope: int) -> list[int]:
        """What is to be computed in a scope, each loop before its first result."""
        order: dict[int, None] = {}
        for node in self._body[scope]:
            if self.graph.operation[node] == "loop_result":
                order.setdefault(self.count + self.graph.value[node][0])
            if self.graph.operation[node] not in _GIVEN:
                order.setdefault(node)
        return list(order)

    def _reads_of_step(self, node: int) -> set[int]:
        """Of a loop, what it is computed from and does not compute itself."""
        if node < self.count:
            return set(self.reads(node))
        loop = node - self.count
        read = set(self._parts(loop))
        for step in self.steps[loop]:
            read |= self._reads_of_step(step.node)
        return read - set(self._body[loop]) - {step.node for step in self.steps[loop]}

    def _with_last_uses(self, scope: int, order: list[int]) -> list[Step]:
        kept = {node for _, node in self.graph.results} if scope < 0 else set(self._parts(scope))
        steps = []
        for node in reversed(order):
            last = ({node} | self._reads_of_step(node)) & set(order) - kept
            kept |= last
            steps.append(Step(node, tuple(sorted(last))))
        return steps[::-1]
