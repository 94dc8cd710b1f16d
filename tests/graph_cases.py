"""Graphs made by hand that hold every operation, and what they give in plain Python.

The order of nodes and the meaning of loops and branches are those of the compiled core's recorder.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from microfacet._export.graph import Graph

__all__ = ["CASES", "Builder", "evaluate"]


class Builder:
    """Adds nodes one after the other; `graph` is the whole."""

    def __init__(self, *inputs: str) -> None:
        self.record: dict[str, Any] = {
            "real": "float32",
            **{name: [] for name in ("operation", "type", "arguments", "value", "loop")},
            "inputs": list(inputs),
            **{name: [] for name in ("results", "loops", "branches", "tables")},
        }
        self.inputs = {name: self.add("input", value=i) for i, name in enumerate(inputs)}

    def add(
        self, operation: str, *arguments: int, value: Any = None, type_: str = "real", loop: int = -1
    ) -> int:
        """A node; it depends on the loops of its arguments."""
        loops = [loop, *(self.record["loop"][argument] for argument in arguments)]
        entry = (operation, type_, tuple(arguments), value, max(loops))
        for name, part in zip(("operation", "type", "arguments", "value", "loop"), entry, strict=True):
            self.record[name].append(part)
        return len(self.record["operation"]) - 1

    def real(self, value: float) -> int:
        """A literal."""
        return self.add("literal", value=value)

    def integer(self, value: int) -> int:
        """A literal."""
        return self.add("literal", value=value, type_="integer")

    def mask(self, operation: str, *arguments: int) -> int:
        """A comparison, or masks combined."""
        return self.add(operation, *arguments, type_="mask")

    def true(self) -> int:
        """A literal."""
        return self.add("literal", value=True, type_="mask")

    def whole(self, operation: str, *arguments: int, value: Any = None) -> int:
        """An operation that gives an integer."""
        return self.add(operation, *arguments, type_="integer", value=value)

    def loop(
        self,
        most: int,
        initial: Sequence[int],
        body: Callable[..., tuple[Sequence[int], int]],
        moving: int | None = None,
        parent: int = -1,
    ) -> list[int]:
        """A loop whose body makes the next states and the mask from the states; its results."""
        index = len(self.record["loops"])
        entry: dict[str, Any] = {"most": most, "parent": parent, "initial": list(initial)}
        self.record["loops"].append(entry)
        entry["moving"] = self.true() if moving is None else moving
        types = [self.record["type"][node] for node in initial]
        entry["state"] = [
            self.add("state", value=i, type_=type_, loop=index) for i, type_ in enumerate(types)
        ]
        following, unsettled = body(*entry["state"])
        entry["next"], entry["unsettled"] = list(following), unsettled
        return [
            self.add("loop_result", value=(index, i), type_=type_, loop=parent)
            for i, type_ in enumerate(types)
        ]

    def branch(self, mask: int, taken: Sequence[int], other: Sequence[int]) -> list[int]:
        """One side or the other; its results."""
        index = len(self.record["branches"])
        self.record["branches"].append({"mask": mask, "taken": list(taken), "other": list(other)})
        loop = max(self.record["loop"][node] for node in (mask, *taken, *other))
        return [
            self.add("branch_result", value=(index, i), type_=self.record["type"][node], loop=loop)
            for i, node in enumerate(taken)
        ]

    def table(self, values: Any) -> int:
        """The number of a constant array."""
        self.record["tables"].append(np.asarray(values))
        return len(self.record["tables"]) - 1

    def graph(self, **results: int) -> Graph:
        """The whole; two underscores in a name stand for a point."""
        self.record["results"] = [(name.replace("__", "."), node) for name, node in results.items()]
        return Graph.from_record(self.record)


# Evaluation, in single precision and one lane


def evaluate(graph: Graph, values: Mapping[str, float]) -> dict[str, float]:
    """The results by name, for arguments by name."""
    known: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        return {name: float(_value(graph, node, values, known)) for name, node in graph.results}


def _value(graph: Graph, node: int, inputs: Mapping[str, float], known: dict[int, Any]) -> Any:
    if node in known:
        return known[node]
    operation, value = graph.operation[node], graph.value[node]
    if operation == "loop_result":
        _run(graph, value[0], inputs, known)
        return known[node]
    if operation == "branch_result":
        branch = graph.branches[value[0]]
        side = branch.taken if _value(graph, branch.mask, inputs, known) else branch.other
        result = _value(graph, side[value[1]], inputs, known)
    elif operation == "literal":
        result = np.float32(value) if graph.type[node] == "real" else value
    elif operation == "input":
        result = np.float32(inputs[graph.inputs[value]])
    elif operation == "table":
        result = graph.tables[value][_value(graph, graph.arguments[node][0], inputs, known)]
        result = int(result) if graph.type[node] == "integer" else np.float32(result)
    else:
        arguments = [_value(graph, argument, inputs, known) for argument in graph.arguments[node]]
        result = _OPERATIONS[operation](*arguments)
        result = _wrapped(result) if graph.type[node] == "integer" else result
        result = np.float32(result) if graph.type[node] == "real" else result
    known[node] = result
    return result


def _run(graph: Graph, index: int, inputs: Mapping[str, float], known: dict[int, Any]) -> None:
    loop = graph.loops[index]
    state = [_value(graph, node, inputs, known) for node in loop.initial]
    moving, turns = _value(graph, loop.moving, inputs, known), 0
    while turns < loop.most and moving:
        inside = {node: value for node, value in known.items() if graph.loop[node] != index}
        inside |= dict(zip(loop.state, state, strict=True))
        state = [_value(graph, node, inputs, inside) for node in loop.next]
        moving = _value(graph, loop.unsettled, inputs, inside)
        turns += 1
    for node, operation in enumerate(graph.operation):
        if operation == "loop_result" and graph.value[node][0] == index:
            known[node] = state[graph.value[node][1]]


def _wrapped(value: int) -> int:
    return (int(value) + 2**31) % 2**32 - 2**31


def _either(a: Any, b: Any) -> Any:
    return bool(a or b) if isinstance(a, bool | np.bool_) else a | b


def _both(a: Any, b: Any) -> Any:
    return bool(a and b) if isinstance(a, bool | np.bool_) else a & b


def _as_real(bits: int) -> Any:
    return np.array(bits, np.int32).view(np.float32)[()]


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "multiply_add": lambda a, b, c: np.float64(a) * np.float64(b) + np.float64(c),
    "negate": lambda a: -a,
    "minimum": min,
    "maximum": max,
    "absolute": abs,
    "pow": lambda a, b: np.float64(a) ** np.float64(b),
    **{name: getattr(np, name) for name in ("sqrt", "floor", "exp", "log", "expm1", "log1p", "sin", "cos")},
    "select": lambda mask, a, b: a if mask else b,
    "from_bits": _as_real,
    "bits": lambda a: int(np.float32(a).view(np.int32)),
    "and": _both,
    "or": _either,
    "not": lambda a: not a,
    "shift_left": lambda a, n: a << n,
    "shift_right": lambda a, n: a >> n,
    "shift_right_logical": lambda a, n: (a % 2**32) >> n,
    "less": lambda a, b: a < b,
    "less_equal": lambda a, b: a <= b,
    "greater": lambda a, b: a > b,
    "greater_equal": lambda a, b: a >= b,
    "equal": lambda a, b: a == b,
    "not_equal": lambda a, b: a != b,
}


# Cases


def arithmetic() -> Graph:
    """Every real operation that all languages have, signs where they are awkward."""
    b = Builder("u", "alpha")
    u, alpha = b.inputs["u"], b.inputs["alpha"]
    minus = b.add("negate", b.add("multiply", u, u))
    total = b.add("subtract", b.add("add", minus, b.real(-0.5)), b.add("negate", alpha))
    total = b.add("multiply_add", b.add("subtract", u, alpha), b.add("add", u, alpha), total)
    total = b.add("subtract", total, b.add("subtract", u, b.add("multiply", b.real(-3.0), alpha)))
    total = b.add("divide", total, b.add("divide", b.add("add", alpha, b.real(2.0)), b.real(7.0)))
    total = b.add("multiply_add", b.add("negate", alpha), u, total)
    bounded = b.add("maximum", b.add("minimum", total, b.real(3.0)), b.real(-3.0))
    total = b.add("add", total, b.add("floor", b.add("multiply", bounded, b.real(2.25))))
    for name in ("sqrt", "exp", "log"):
        total = b.add("add", total, b.add(name, b.add("add", b.add("absolute", bounded), b.real(0.25))))
    power = b.add("pow", b.add("absolute", alpha), b.add("multiply", u, b.real(1.5)))
    return b.graph(value=b.add("add", total, b.add("negate", b.add("negate", power))))


def circle() -> Graph:
    """Sine and cosine: a driver's own may be coarse."""
    b = Builder("u", "alpha")
    return b.graph(
        value=b.add("multiply_add", b.add("sin", b.inputs["u"]), b.real(2.0), b.add("cos", b.inputs["alpha"]))
    )


def native() -> Graph:
    """The functions that C and array libraries have."""
    b = Builder("u", "alpha")
    product = b.add("multiply", b.inputs["u"], b.inputs["alpha"])
    return b.graph(value=b.add("add", b.add("expm1", product), b.add("log1p", b.add("absolute", product))))


def directions() -> Graph:
    """Vectors in and out, and an argument that is not used."""
    b = Builder("w.x", "w.y", "w.z", "xi.x", "xi.y", "alpha", "gamma")
    w = [b.inputs[f"w.{letter}"] for letter in "xyz"]
    scaled = [b.add("multiply", part, b.inputs["alpha"]) for part in w[:2]]
    squares = [b.add("multiply", part, part) for part in (*scaled, w[2])]
    norm = b.add("divide", b.real(1.0), b.add("sqrt", b.add("add", b.add("add", *squares[:2]), squares[2])))
    return b.graph(
        m__x=b.add("multiply_add", b.inputs["xi.x"], norm, b.add("multiply", scaled[0], norm)),
        m__y=b.add("multiply", scaled[1], norm),
        m__z=b.add("multiply", w[2], norm),
    )


def material() -> Graph:
    """Several results, of which one is a direction, another an argument."""
    b = Builder("wi.x", "wi.y", "wi.z", "xi.x", "xi.y", "xi.z", "xi.w", "alpha")
    total = b.inputs["xi.x"]
    for letter in "yzw":
        total = b.add("multiply_add", total, b.inputs["alpha"], b.inputs[f"xi.{letter}"])
    return b.graph(
        wo__x=b.add("negate", b.inputs["wi.x"]),
        wo__y=b.add("negate", b.inputs["wi.y"]),
        wo__z=b.inputs["wi.z"],
        weight=total,
        pdf=b.add("exp", b.add("negate", total)),
    )


def masks() -> Graph:
    """Comparisons and what combines them."""
    b = Builder("u", "alpha")
    u, alpha = b.inputs["u"], b.inputs["alpha"]
    orders = [b.mask(name, u, alpha) for name in ("less", "less_equal", "greater", "greater_equal")]
    near = b.mask("less", b.add("absolute", b.add("subtract", u, alpha)), b.real(0.25))
    either = b.mask("or", b.mask("and", orders[0], near), b.mask("and", orders[2], b.mask("not", near)))
    both = b.mask("and", b.mask("or", orders[1], near), b.mask("or", either, b.mask("not_equal", u, u)))
    kept = b.add("select", both, either, b.mask("equal", alpha, alpha), type_="mask")
    first = b.add("select", both, u, alpha)
    second = b.add("select", kept, b.add("select", orders[3], first, b.real(3.0)), b.real(-1e-10))
    return b.graph(value=b.add("add", b.add("multiply", first, b.real(10.0)), second))


def loops() -> Graph:
    """A root by Newton's method, an inner loop, states that trade places, something to hoist."""
    b = Builder("u", "alpha")
    target = b.add("add", b.add("absolute", b.inputs["u"]), b.real(0.5))

    def newton(x: int, turns: int) -> tuple[list[int], int]:
        hoisted = b.add("sqrt", b.add("multiply", target, b.real(3.0)))

        def inner(low: int, high: int) -> tuple[list[int], int]:
            middle = b.add("multiply_add", low, b.real(0.5), b.add("multiply", x, hoisted))
            return [high, middle], b.mask("less", middle, b.real(40.0))

        _, high = b.loop(3, [x, b.inputs["alpha"]], inner, parent=0)
        step = b.add("divide", b.add("subtract", b.add("multiply", x, x), target), x)
        following = b.add("multiply_add", b.real(-0.5), step, x)
        counted = b.whole("add", turns, b.integer(1))
        small = b.add("multiply", high, b.real(1e-4))
        moves = b.mask("greater", b.add("absolute", step), b.add("multiply", small, b.real(1e-2)))
        return [b.add("add", following, small), counted], moves

    root, turns = b.loop(7, [target, b.integer(0)], newton)
    few = b.add("select", b.mask("less", turns, b.integer(4)), b.real(1.0), b.real(2.0))
    return b.graph(value=b.add("multiply", root, few))


def swap() -> Graph:
    """States that take each other's values, in a loop that may not start."""
    b = Builder("u", "alpha")
    start = b.mask("less", b.inputs["u"], b.inputs["alpha"])

    def body(a: int, c: int) -> tuple[list[int], int]:
        return [c, b.add("multiply_add", a, b.real(0.5), c)], b.mask("less", a, b.real(2.0))

    a, c = b.loop(9, [b.inputs["alpha"], b.inputs["u"]], body, start)
    return b.graph(value=b.add("multiply_add", a, b.real(10.0), c))


def branches() -> Graph:
    """A loop on one side, a branch inside a branch, what both sides share."""
    b = Builder("u", "alpha")
    u, alpha = b.inputs["u"], b.inputs["alpha"]
    shared = b.add("exp", b.add("multiply", u, b.real(0.5)))

    def doubled(x: int) -> tuple[list[int], int]:
        more = b.add("multiply_add", x, b.real(1.5), shared)
        return [more], b.mask("less", more, b.real(30.0))

    (grown,) = b.loop(20, [alpha], doubled)
    inner = b.branch(b.mask("greater", alpha, b.real(0.5)), [b.add("sqrt", shared)], [b.add("log", shared)])
    value, flag = b.branch(
        b.mask("less", u, b.real(0.0)), [grown, b.mask("less", grown, b.real(31.0))], [inner[0], b.true()]
    )
    return b.graph(value=b.add("select", flag, value, b.add("negate", value)))


def integers() -> Graph:
    """The bits of numbers, shifts and tables."""
    b = Builder("u", "alpha")
    numbers = b.table(np.linspace(-1.0, 1.0, 16, dtype=np.float32) ** 3)
    offsets = b.table(np.arange(16, dtype=np.int32)[::-1] * 3 - 20)
    b.table(np.ones(8, np.float32))  # nobody reads it
    u = b.inputs["u"]
    bits = b.whole("bits", b.add("add", b.add("absolute", u), b.real(0.5)))
    exponent = b.whole("subtract", b.whole("shift_right", bits, b.integer(23)), b.integer(127))
    index = b.whole("and", b.whole("shift_right_logical", bits, b.integer(19)), b.integer(15))
    offset = b.whole("add", b.whole("table", index, value=offsets), exponent)
    negative = b.mask("less", offset, b.integer(0))
    masked = b.whole("and", b.whole("or", offset, b.integer(8)), b.integer(15))
    picked = b.whole("select", negative, masked, index)
    scale = b.add("from_bits", b.whole("shift_left", b.whole("add", exponent, b.integer(130)), b.integer(23)))
    sign = b.whole("shift_right_logical", b.whole("bits", u), b.integer(31))
    same = b.mask("equal", sign, b.integer(1))
    odd = b.mask("not_equal", b.whole("and", b.integer(-(2**31)), b.whole("bits", u)), b.integer(0))
    flagged = b.add("select", b.mask("and", same, odd), b.real(-1.0), b.inputs["alpha"])
    total = b.add("multiply_add", b.add("table", picked, value=numbers), scale, flagged)
    return b.graph(value=total)


def ends() -> Graph:
    """Numbers that no literal stands for."""
    b = Builder("u", "alpha")
    big = b.add("select", b.mask("greater", b.inputs["u"], b.real(0.5)), b.real(math.inf), b.inputs["u"])
    low = b.add("select", b.mask("less", b.inputs["u"], b.real(-0.5)), b.real(-math.inf), big)
    least = b.add("multiply", b.inputs["alpha"], b.real(1.1754944e-38))
    return b.graph(value=b.add("maximum", b.add("add", low, least), b.real(-3.4028235e38)))


CASES: dict[str, Callable[[], Graph]] = {
    case.__name__: case
    for case in (
        arithmetic,
        circle,
        native,
        directions,
        material,
        masks,
        loops,
        swap,
        branches,
        integers,
        ends,
    )
}
