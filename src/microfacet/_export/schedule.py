"""Where the operations of a graph stand in a program: a tree of blocks, each a list of statements.

Blocks are the body of the function, the bodies of loops and both sides of branches. A statement goes into the
deepest block around all of its uses, so that what one side of a branch needs is computed on that side only,
and then out of every loop that it does not depend on. This is C. Click's global code motion (PLDI 1995).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from microfacet._export.graph import Graph

__all__ = ["Block", "Schedule", "Unit"]

#: What stands in a block: ("node", index), ("loop", index) or ("branch", index).
Unit = tuple[str, int]


@dataclass(eq=False)
class Block:
    """A list of statements; `owner` is the loop or branch whose body or side it is."""

    parent: Block | None
    owner: Unit | None = None
    units: list[Unit] = field(default_factory=list)

    @property
    def depth(self) -> int:
        """How many blocks stand around it."""
        return 0 if self.parent is None else 1 + self.parent.depth


class Schedule:
    """The blocks of a graph, and how often each node is used.

    Attributes
    ----------
    body : Block
        The body of the function.
    bodies : dict of int to Block
        The bodies of the loops.
    sides : dict of int to (Block, Block)
        What a branch computes where its mask holds, and where not.
    place : dict of Unit to Block
        Where each statement stands.
    uses : dict of int to int
        How many nodes, statements and results need a node.
    used : dict of Unit to list of Block
        In which blocks they are.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.body = Block(None)
        self.bodies: dict[int, Block] = {}
        self.sides: dict[int, tuple[Block, Block]] = {}
        self.place: dict[Unit, Block] = {}
        self.uses: dict[int, int] = {}
        order = self._order()
        self._depends = self._loops_of(order)
        self.used: dict[Unit, list[Block]] = {}
        for _, node in graph.results:
            self._use(node, self.body)
        for unit in reversed(order):
            block = self._hoisted(unit, _around(self.used[unit]))
            self.place[unit] = block
            for node, where in self._needs(unit, block):
                self._use(node, where)
        for unit in order:
            self.place[unit].units.append(unit)

    def unit(self, node: int) -> Unit | None:
        """The statement that computes a node; none for what needs none."""
        operation = self.graph.operation[node]
        if operation in ("literal", "input", "state"):
            return None
        if operation == "loop_result":
            return "loop", self.graph.value[node][0]
        if operation == "branch_result":
            return "branch", self.graph.value[node][0]
        return "node", node

    def _use(self, node: int, where: Block) -> None:
        self.uses[node] = self.uses.get(node, 0) + 1
        unit = self.unit(node)
        if unit is not None:
            self.used.setdefault(unit, []).append(where)

    def _nodes(self, unit: Unit) -> tuple[int, ...]:
        """What a statement needs, in the order in which it is best computed."""
        kind, index = unit
        if kind == "node":
            return self.graph.arguments[index]
        if kind == "loop":
            loop = self.graph.loops[index]
            return (*loop.initial, loop.moving, *loop.next, loop.unsettled)
        branch = self.graph.branches[index]
        return (branch.mask, *branch.taken, *branch.other)

    def _needs(self, unit: Unit, block: Block) -> list[tuple[int, Block]]:
        """What a statement in `block` needs, and in which block each is used; makes its own blocks."""
        kind, index = unit
        if kind == "node":
            return [(node, block) for node in self.graph.arguments[index]]
        if kind == "loop":
            loop = self.graph.loops[index]
            body = self.bodies[index] = Block(block, unit)
            before = [(node, block) for node in (*loop.initial, loop.moving)]
            return before + [(node, body) for node in (*loop.next, loop.unsettled)]
        branch = self.graph.branches[index]
        taken, other = self.sides[index] = (Block(block, unit), Block(block, unit))
        on_sides = [(node, taken) for node in branch.taken] + [(node, other) for node in branch.other]
        return [(branch.mask, block), *on_sides]

    def _order(self) -> list[Unit]:
        """All statements that a result needs, each after what it needs itself."""
        order: list[Unit] = []
        seen: set[Unit] = set()
        for _, result in self.graph.results:
            stack: list[tuple[Unit | None, bool]] = [(self.unit(result), False)]
            while stack:
                unit, ready = stack.pop()
                if unit is None:
                    continue
                if ready:
                    order.append(unit)
                elif unit not in seen:
                    seen.add(unit)
                    stack.append((unit, True))
                    stack.extend((self.unit(node), False) for node in reversed(self._nodes(unit)))
        return order

    def _loops_of(self, order: list[Unit]) -> dict[Unit, frozenset[int]]:
        """The loops on whose states each statement depends."""
        found: dict[Unit, frozenset[int]] = {}
        for unit in order:
            loops: set[int] = set()
            for node in self._nodes(unit):
                other = self.unit(node)
                if other is not None:
                    loops |= found[other]
                elif self.graph.operation[node] == "state":
                    loops.add(self.graph.loop[node])
            found[unit] = frozenset(loops - {unit[1]} if unit[0] == "loop" else loops)
        return found

    def _hoisted(self, unit: Unit, block: Block) -> Block:
        """Out of every loop that the statement does not depend on."""
        best = block
        while block.parent is not None and block.owner is not None:
            kind, index = block.owner
            if kind == "loop":
                if index in self._depends[unit]:
                    break
                best = block.parent
            block = block.parent
        return best


def _around(blocks: list[Block]) -> Block:
    """The deepest block around all of these."""
    first, *rest = blocks
    for block in rest:
        while first is not block:
            if first.depth < block.depth:
                first, block = block, first
            assert first.parent is not None
            first = first.parent
    return first
