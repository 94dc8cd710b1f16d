"""The evaluator carries out every operation, loop and branch of a graph as its definition says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from array_graphs import Builder, every_operation, nested_loops, scalar
from microfacet._export.evaluate import Evaluator
from microfacet._export.graph import OPERATIONS, Graph
from microfacet._export.guard import Interval, clamped, guarded, without_unused
from microfacet._export.libraries import NAMES, NumPy, library_of
from microfacet._export.program import Program

GRAPHS = [every_operation, nested_loops]
TOLERANCE = {"float32": 1e-6, "float64": 1e-14}


def numbers(real: str) -> tuple[Any, Any, Any]:
    """Inputs that broadcast, and what a graph of them gives number by number."""
    rng = np.random.default_rng(1)
    return rng.uniform(0.01, 4, (12, 1)).astype(real), rng.uniform(0.01, 4, 5).astype(real), real


@pytest.mark.parametrize("real", ["float32", "float64"])
@pytest.mark.parametrize("make", GRAPHS, ids=lambda make: make.__name__)
@pytest.mark.parametrize("block", [None, 7, 1000])
def test_arrays_give_what_single_numbers_give(
    make: Any, real: str, block: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(NumPy, "block", block)
    built = make(real)
    x, y, _ = numbers(real)
    found = Evaluator(built.graph(), library_of("numpy"))([x, y])
    check(built, found, x, y)


def check(built: Builder, found: Any, x: Any, y: Any) -> None:
    want = np.array([[scalar(built, [float(a), float(b)]) for b in y] for a in x[:, 0]])
    assert len(found) == len(built.results)
    for i, (name, _) in enumerate(built.results):
        assert found[i].dtype == built.real
        assert found[i].shape == (len(x), len(y))
        np.testing.assert_allclose(
            found[i], want[..., i], TOLERANCE[built.real], TOLERANCE[built.real], err_msg=name
        )


def test_the_graphs_have_every_operation() -> None:
    """A new operation needs a line in the evaluator and one here."""
    used = {name for make in GRAPHS for name in make("float64").operation}
    assert used == set(OPERATIONS)


def test_single_numbers_and_empty_arrays() -> None:
    built = nested_loops("float64")
    evaluate = Evaluator(built.graph(), library_of("numpy"))
    for result, want in zip(
        evaluate([np.float64(2.5), np.float64(0.3)]), scalar(built, [2.5, 0.3]), strict=True
    ):
        assert result.shape == ()
        assert float(result) == pytest.approx(want, rel=1e-13)
    assert [result.shape for result in evaluate([np.ones((0, 3)), np.ones(1)])] == [(0, 3)] * 4


def test_what_depends_on_one_input_alone_has_its_shape() -> None:
    """A loop over a parameter turns once for all elements."""
    built = nested_loops("float64")
    program = Program(built.graph())
    by_input = {name: program.inputs_of[node] for name, node in built.results}
    assert by_input["small"] == {1}
    assert by_input["cube"] == {0, 1}


def test_values_are_freed_after_their_last_use() -> None:
    program = Program(every_operation("float64").graph())
    results = {node for _, node in program.graph.results}
    freed = [node for step in program.steps[-1] for node in step.last_use_of]
    assert len(freed) == len(set(freed))
    computed = {step.node for step in program.steps[-1]}
    assert set(freed) == computed - results


def test_a_loop_inside_is_evaluated_inside() -> None:
    built = nested_loops("float64")
    program = Program(built.graph())
    inner = program.count + 1
    assert inner in {step.node for step in program.steps[0]}
    assert inner not in {step.node for step in program.steps[-1]}


def test_a_table_is_not_read_outside_of_itself() -> None:
    """Lanes that do not count may ask for any element."""
    g = Builder("float64")
    place = g.node("floor", g.input("x"))
    g.tables.append(np.arange(4.0))
    index = g.node("shift_right", g.node("bits", place, type="integer"), g.literal(40), type="integer")
    g.results.append(("value", g.node("table", index, value=0)))
    found = Evaluator(g.graph(), library_of("numpy"))([np.array([0.0, 7.0, -7.0])])[0]
    assert found[0] == 0
    assert np.isin(found, np.arange(4.0)).all()


def test_results_are_nan_outside_of_domains() -> None:
    g = Builder("float32")
    g.input("alpha")
    g.results.append(("value", g.node("negate", g.input("x"))))
    graph = guarded(g.graph(), {"alpha": Interval(0.0, 1e101), "x": Interval(-1.0, 1.0, with_lower=True)})
    evaluate = Evaluator(graph, library_of("numpy"))
    alpha = np.array([0, 1e-30, 3e38, np.inf, np.nan], np.float32)
    np.testing.assert_array_equal(evaluate([alpha, np.float32(0.5)])[0], [np.nan, -0.5, -0.5, np.nan, np.nan])
    x = np.array([-1.1, -1, 0.5, 1, np.nan], np.float32)
    np.testing.assert_array_equal(evaluate([np.float32(1), x])[0], [np.nan, 1, -0.5, np.nan, np.nan])


def test_inputs_without_use() -> None:
    g = Builder("float64")
    for name in ("xi.x", "xi.z", "w.x"):
        g.input(name)
    g.results.append(("value", g.node("negate", g.input("xi.y"))))
    graph = without_unused(g.graph(), "xi")
    assert graph.inputs == ("xi.x", "xi.z", "w.x", "xi.y")  # they have nodes
    g.operation[0] = g.operation[1] = "literal"
    g.value[0] = g.value[1] = 0.0
    assert without_unused(g.graph(), "xi").inputs == ("w.x", "xi.y")


@pytest.mark.parametrize("make", GRAPHS, ids=lambda make: make.__name__)
def test_a_clamped_input_changes_nothing_else(make: Any) -> None:
    built, (x, y, _) = make("float64"), numbers("float64")
    for name, at in (("x", [x / 4, y]), (make("float64").inputs[1], [x, y / 4])):
        graph = clamped(built.graph(), name)
        Graph.from_record(
            vars(graph) | {"loops": list(map(vars, graph.loops)), "branches": list(map(vars, graph.branches))}
        )
        found = Evaluator(graph, library_of("numpy"))(at)
        for one, other in zip(found, Evaluator(built.graph(), library_of("numpy"))(at), strict=True):
            np.testing.assert_array_equal(one, other)
    beyond = Evaluator(clamped(built.graph(), "x"), library_of("numpy"))([2 + x, y])
    for one, other in zip(
        beyond, Evaluator(built.graph(), library_of("numpy"))([np.ones_like(x), y]), strict=True
    ):
        np.testing.assert_array_equal(one, other)
    graph = built.graph()
    assert clamped(graph, "z") is graph


def test_libraries_by_name_and_module() -> None:
    assert library_of(np) is library_of("numpy")
    with pytest.raises(ValueError, match=r"xp must be one of numpy, cupy, jax, torch, got 'tensorflow'"):
        library_of("tensorflow")
    assert set(NAMES) == {"numpy", "cupy", "jax", "torch"}
