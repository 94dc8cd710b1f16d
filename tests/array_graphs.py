"""Graphs made by hand, and what they mean: one number at a time, in plain Python."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from microfacet._export.graph import Graph

_REAL = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negate": lambda a: -a,
    "multiply_add": lambda a, b, c: a * b + c,
    "minimum": min,
    "maximum": max,
    "absolute": abs,
    "sqrt": math.sqrt,
    "floor": math.floor,
    "exp": math.exp,
    "log": math.log,
    "expm1": math.expm1,
    "log1p": math.log1p,
    "pow": math.pow,
    "sin": math.sin,
    "cos": math.cos,
}
_MASK = {
    "less": lambda a, b: a < b,
    "less_equal": lambda a, b: a <= b,
    "greater": lambda a, b: a > b,
    "greater_equal": lambda a, b: a >= b,
    "equal": lambda a, b: a == b,
    "not_equal": lambda a, b: a != b,
    "and": lambda a, b: a & b,
    "or": lambda a, b: a | b,
    "not": lambda a: not a,
}


@dataclass
class Builder:
    """A graph that grows; the methods give the numbers of nodes."""

    real: str = "float64"
    operation: list[str] = field(default_factory=list)
    type: list[str] = field(default_factory=list)
    arguments: list[tuple[int, ...]] = field(default_factory=list)
    value: list[Any] = field(default_factory=list)
    inputs: list[str] = field(default_factory=list)
    results: list[tuple[str, int]] = field(default_factory=list)
    loops: list[dict[str, Any]] = field(default_factory=list)
    branches: list[dict[str, Any]] = field(default_factory=list)
    tables: list[np.ndarray[Any, Any]] = field(default_factory=list)

    def node(self, operation: str, *arguments: int, type: str = "real", value: Any = None) -> int:
        self.operation.append(operation)
        self.type.append("mask" if operation in _MASK and type == "real" else type)
        self.arguments.append(arguments)
        self.value.append(value)
        return len(self.operation) - 1

    def input(self, name: str) -> int:
        self.inputs.append(name)
        return self.node("input", value=len(self.inputs) - 1)

    def literal(self, value: Any) -> int:
        kind = "mask" if isinstance(value, bool) else "integer" if isinstance(value, int) else "real"
        return self.node("literal", type=kind, value=value)

    def loop(self, most: int, moving: int, *initial: int, parent: int = -1) -> tuple[int, list[int]]:
        """A loop and its states; `close` says what follows them."""
        number = len(self.loops)
        states = [self.node("state", type=self.type[a], value=i) for i, a in enumerate(initial)]
        self.loops.append(
            {"most": most, "parent": parent, "initial": list(initial), "moving": moving, "state": states}
        )
        return number, states

    def close(self, loop: int, unsettled: int, *following: int) -> list[int]:
        self.loops[loop] |= {"next": list(following), "unsettled": unsettled}
        return [self.node("loop_result", type=self.type[a], value=(loop, i)) for i, a in enumerate(following)]

    def branch(self, mask: int, taken: list[int], other: list[int]) -> list[int]:
        number = len(self.branches)
        self.branches.append({"mask": mask, "taken": taken, "other": other})
        return [self.node("branch_result", type=self.type[a], value=(number, i)) for i, a in enumerate(taken)]

    def graph(self) -> Graph:
        """As the recorder would hand it over."""
        return Graph.from_record({**vars(self), "loop": [-1] * len(self.operation)})


def scalar(graph: Builder, inputs: list[float]) -> list[float]:
    """The results for one number each, as the definition of a graph says it: side by side, turn by turn."""
    fixed: dict[int, Any] = {}

    def bits(x: float) -> int:
        return (
            struct.unpack("<i", struct.pack("<f", x))[0]
            if single
            else struct.unpack("<q", struct.pack("<d", x))[0]
        )

    def from_bits(i: int) -> float:
        return (
            struct.unpack("<f", struct.pack("<i", i))[0]
            if single
            else struct.unpack("<d", struct.pack("<q", i))[0]
        )

    single = graph.real == "float32"
    width = 32 if single else 64

    def wrapped(i: int) -> int:
        i &= (1 << width) - 1
        return i - (1 << width) if i >> (width - 1) else i

    def of(node: int, states: dict[int, Any]) -> Any:
        if node in states:
            return states[node]
        operation, value = graph.operation[node], graph.value[node]
        if operation == "literal":
            return value
        if operation == "input":
            return inputs[value]
        if operation == "loop_result":
            return turned(value[0], states)[value[1]]
        if operation == "branch_result":
            branch = graph.branches[value[0]]
            side = branch["taken" if of(branch["mask"], states) else "other"]
            return of(side[value[1]], states)
        given = [of(a, states) for a in graph.arguments[node]]
        if operation == "select":
            return given[1] if given[0] else given[2]
        if operation == "bits":
            return bits(given[0])
        if operation == "from_bits":
            return from_bits(given[0])
        if operation == "table":
            return graph.tables[value][given[0]].item()
        if operation == "shift_left":
            return wrapped(given[0] << given[1])
        if operation == "shift_right":
            return given[0] >> given[1]
        if operation == "shift_right_logical":
            return wrapped((given[0] & ((1 << width) - 1)) >> given[1])
        result = (_REAL | _MASK)[operation](*given)
        return wrapped(result) if graph.type[node] == "integer" else result

    def turned(number: int, outer: dict[int, Any]) -> list[Any]:
        loop = graph.loops[number]
        now = [of(a, outer) for a in loop["initial"]]
        moving = of(loop["moving"], outer)
        for _ in range(loop["most"]):
            if not moving:
                break
            states = {**outer, **dict(zip(loop["state"], now, strict=True))}
            now, moving = [of(a, states) for a in loop["next"]], of(loop["unsettled"], states)
        return now

    return [of(node, fixed) for _, node in graph.results]


def every_operation(real: str) -> Builder:
    """Each operation of reals, integers and masks at least once, on two positive numbers."""
    g = Builder(real)
    x, y = g.input("x"), g.input("y")
    for name, function in _REAL.items():
        count = function.__code__.co_argcount if hasattr(function, "__code__") else 1
        count = 2 if name in ("minimum", "maximum", "pow") else count
        g.results.append((name, g.node(name, *[x, y, x][:count])))
    one, two = g.literal(1.0), g.literal(0.25)
    masks = [g.node(name, x, y) for name in _MASK if name not in ("and", "or", "not")]
    masks += [g.node("and", masks[0], masks[1]), g.node("or", masks[0], masks[2]), g.node("not", masks[0])]
    masks.append(g.node("select", masks[0], masks[3], masks[4], type="mask"))
    g.results += [(f"mask {i}", g.node("select", mask, one, two)) for i, mask in enumerate(masks)]
    exponent = 23 if real == "float32" else 52
    whole = g.node("bits", x, type="integer")
    negative = g.node("bits", g.node("negate", x), type="integer")
    shift = g.literal(exponent)
    e = g.node("shift_right", whole, shift, type="integer")
    signed = g.node("shift_right", negative, shift, type="integer")
    logical = g.node("shift_right_logical", negative, shift, type="integer")
    low = g.node("and", whole, g.literal((1 << exponent) - 1), type="integer")
    unit = g.node("or", low, g.node("bits", one, type="integer"), type="integer")
    up = g.node("shift_left", g.node("add", e, g.literal(1), type="integer"), shift, type="integer")
    g.results.append(("mantissa", g.node("from_bits", unit)))
    g.results.append(("power", g.node("from_bits", up)))
    g.tables.append(np.linspace(2, 3, 1 << 12).astype(real))
    g.tables.append(np.arange(4)[::-1].astype("int32" if real == "float32" else "int64"))
    mask = g.node("and", e, g.literal(3), type="integer")
    inner = g.node("table", mask, type="integer", value=1)
    for name, place in (
        ("inner", inner),
        ("logical", g.node("and", logical, g.literal(4095), type="integer")),
    ):
        g.results.append((name, g.node("table", place, value=0)))
    far = g.node("less", signed, g.node("subtract", e, g.literal(1), type="integer"))
    chosen = g.node("select", far, g.literal(7), inner, type="integer")
    g.results.append(("chosen", g.node("table", chosen, value=0)))
    return g


def nested_loops(real: str) -> Builder:
    """Square roots inside a cube root's iteration, with sides of a branch that loop, and a table."""
    g = Builder(real)
    x, p = g.input("x"), g.input("p")
    always, one, half, third = g.literal(True), g.literal(1.0), g.literal(0.5), g.literal(1 / 3)
    tiny = g.literal(1e-5 if real == "float32" else 1e-13)
    outer, (a, turns) = g.loop(60, always, one, g.literal(0))
    # s = sqrt(x) by a loop of its own, as long as the difference is not small; it starts at the outer state
    inner, (s,) = g.loop(80, g.node("greater", x, g.literal(0.5)), g.node("maximum", a, half), parent=outer)
    better = g.node("multiply", half, g.node("add", s, g.node("divide", x, s)))
    far = g.node(
        "greater", g.node("absolute", g.node("subtract", better, s)), g.node("multiply", tiny, better)
    )
    (root,) = g.close(inner, far, better)
    target = g.node("multiply", root, p)  # a^3 = root p
    square = g.node("multiply", a, a)
    step = g.node("subtract", g.node("divide", target, square), a)
    new = g.node("multiply_add", third, step, a)
    moves = g.node("greater", g.node("absolute", step), g.node("multiply", tiny, new))
    count = g.node("add", turns, g.literal(1), type="integer")
    cube, n = g.close(outer, moves, new, count)
    # a side that loops and is not taken everywhere, and a loop that depends on one input alone
    halving, (h,) = g.loop(200, always, p)
    (small,) = g.close(halving, g.node("greater", h, one), g.node("multiply", h, half))
    side = g.node("less", x, g.literal(2.0))
    value, _ = g.branch(side, [cube, small], [g.node("sqrt", cube), x])
    g.tables.append(np.arange(100, dtype=real))
    g.results += [("cube", cube), ("small", small), ("value", value), ("n", g.node("table", n, value=0))]
    return g
