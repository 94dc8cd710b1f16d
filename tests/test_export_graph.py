"""Graphs, where their operations stand, and how expressions are written."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import export_programs as programs
from graph_cases import CASES, Builder, evaluate
from microfacet._export.density import density_of
from microfacet._export.graph import Graph
from microfacet._export.languages import languages
from microfacet._export.schedule import Schedule


def text_of(graph: Graph, language: str = "c") -> str:
    """The function alone."""
    text, _ = programs.text_and_functions(language, {"case": graph})
    return text[text.rindex("// The case case.") :]


# Graphs


def test_operations_count_as_processors_do() -> None:
    b = Builder("u", "alpha")
    product = b.add("multiply_add", b.inputs["u"], b.inputs["alpha"], b.add("negate", b.real(2.0)))
    assert b.graph(value=b.add("negate", product)).operations == 2
    assert CASES["swap"]().operations == 4  # two comparisons, two products with a sum; no state, no result


@pytest.mark.parametrize(
    ("column", "index", "value", "says"),
    [
        ("operation", 2, "divine", "no operation"),
        ("type", 2, "complex", "type 'complex'"),
        ("arguments", 2, (0,), "takes 2 arguments"),
        ("arguments", 2, (0, 5), "stands before what it needs"),
    ],
)
def test_unsound_graphs_are_refused(column: str, index: int, value: Any, says: str) -> None:
    b = Builder("u", "alpha")
    b.graph(value=b.add("add", b.inputs["u"], b.inputs["alpha"]))
    b.record[column][index] = value
    with pytest.raises(ValueError, match=says):
        Graph.from_record(b.record)


def test_other_unsound_graphs_are_refused() -> None:
    b = Builder("u")
    b.graph(value=b.inputs["u"])
    for change, says in (
        ({"real": "float16"}, "float32 or float64"),
        ({"results": [("value", 7)]}, "result value is node 7"),
        ({"loop": []}, "entries"),
    ):
        with pytest.raises(ValueError, match=says):
            Graph.from_record({**b.record, **change})


def test_the_core_hands_over_sound_graphs() -> None:
    assert Graph.of("ggx", "D", {"alpha": None}).inputs
    with pytest.raises(ValueError, match="phong"):
        Graph.of("phong", "D", {"alpha": None})


# Places


def test_what_a_loop_does_not_change_stands_before_it() -> None:
    text = text_of(CASES["loops"]())
    assert text.index("sqrtf") < text.index("for (")
    assert text.count("for (") == 2


def test_what_one_side_needs_stands_on_that_side() -> None:
    text = text_of(CASES["branches"]())
    before, taken, other = re.split(r"if \(u < 0.0f\) \{|\n  \} else \{", text, maxsplit=2)
    assert "expf" in before  # both sides need it
    assert "for (" in taken
    assert "for (" not in other
    assert "logf" in other
    assert "logf" not in taken


def test_states_change_at_once() -> None:
    text = text_of(CASES["swap"]())
    body = text[text.index("for (") :]
    first, second = body.index("s1 = s2;"), body.index("s2 = t")
    assert first < second
    assert body.index("const float t") < first  # from the old value of s1


def test_every_operation_has_one_place() -> None:
    density = density_of("student_t")
    assert density.exact
    graph = Graph.of("student_t", "sample_visible", {"alpha": None, "gamma": None}, native=False)
    schedule = Schedule(graph)
    blocks = [
        schedule.body,
        *schedule.bodies.values(),
        *(side for two in schedule.sides.values() for side in two),
    ]
    placed = [unit for block in blocks for unit in block.units]
    assert len(placed) == len(set(placed))
    for unit, block in schedule.place.items():
        assert unit in block.units


def test_what_nobody_needs_is_not_printed() -> None:
    b = Builder("u")
    b.add("exp", b.inputs["u"])
    b.table(np.ones(4, np.float32))
    assert "exp" not in text_of(b.graph(value=b.add("negate", b.inputs["u"])))


# Expressions


@pytest.mark.parametrize(
    ("make", "written"),
    [
        (lambda b, u, v: b.add("subtract", u, b.add("subtract", v, u)), "u - (v - u)"),
        (lambda b, u, v: b.add("add", u, b.add("negate", v)), "u - v"),
        (lambda b, u, v: b.add("subtract", u, b.add("negate", v)), "u + v"),
        (lambda b, u, v: b.add("add", b.add("negate", u), v), "v - u"),
        (lambda b, u, v: b.add("multiply", u, b.add("negate", v)), "u * (-v)"),
        (lambda b, u, v: b.add("subtract", u, b.add("multiply", b.add("negate", v), u)), "u + v * u"),
        (lambda b, u, v: b.add("negate", b.add("negate", u)), "u"),
        (lambda b, u, v: b.add("divide", u, b.add("multiply", v, v)), "u / (v * v)"),
        (lambda b, u, v: b.add("multiply_add", u, v, b.real(-0.25)), "u * v - 0.25f"),
        (lambda b, u, v: b.add("add", u, b.real(1e-10)), "u + 1e-10f"),
        (lambda b, u, v: b.add("add", u, b.real(float(np.finfo(np.float32).max))), "u + 3.4028234e38f"),
        (lambda b, u, v: b.add("add", u, b.real(0.1)), "u + 0.1f"),
    ],
)
def test_expressions_read_well(make: Any, written: str) -> None:
    b = Builder("u", "v")
    graph = b.graph(value=make(b, b.inputs["u"], b.inputs["v"]))
    assert f"return {written};" in text_of(graph)
    (value,) = evaluate(graph, {"u": 0.7, "v": 0.3}).values()
    found = eval(re.sub(r"(\d)f\b", r"\1", written), {"u": 0.7, "v": 0.3})
    np.testing.assert_allclose(value, found, rtol=1e-6)


def test_a_language_says_what_it_cannot_have() -> None:
    with pytest.raises(ValueError, match=r"try_case cannot be had in GLSL 4\.50: GLSL 4\.50 has no expm1"):
        text_of(CASES["native"](), "glsl")
    with pytest.raises(ValueError, match="cannot be had in OSL"):
        text_of(CASES["integers"](), "osl")
    assert len(languages()) == 10
