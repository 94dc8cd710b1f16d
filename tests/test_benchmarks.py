"""The benchmarks measure what they say they do. Speeds themselves are asserted nowhere in the tests."""

from __future__ import annotations

import importlib.util
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from benchmarks import arrays, gate, page, renderer, scaling, suite, targets  # noqa: E402
from benchmarks import mitsuba as pictures  # noqa: E402
from benchmarks.__main__ import main  # noqa: E402
from benchmarks.expressions import EXPRESSIONS  # noqa: E402
from benchmarks.kernels import KERNELS, PARAMETERS, Inputs, Kernel, bind  # noqa: E402
from benchmarks.results import Results  # noqa: E402
from benchmarks.threads import parts, together  # noqa: E402
from benchmarks.timing import Contender, Spread, interleave, ratios, speed  # noqa: E402

NAMES = {kernel.name for kernel in KERNELS}
each_kernel = pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.name)


# What is compared is the same quantity


@pytest.mark.parametrize(
    ("key", "name"), [(key, name) for key, table in EXPRESSIONS.items() for name in table], ids=str
)
def test_expressions_are_the_quantity(key: tuple[str, str], name: str) -> None:
    """Where no digits cancel: the textbook forms lose them in the tails."""
    family, quantity = key
    u = np.linspace(-0.99, 0.99, 200) if quantity == "sigma" else np.linspace(0.01, 0.99, 100)
    given = PARAMETERS[family].values()
    with np.errstate(all="ignore"):
        value = EXPRESSIONS[key][name](u, *given)
    exact = getattr(getattr(mf, family), quantity)(u, *given)
    central = exact > 1e-3
    assert central.sum() > 20
    np.testing.assert_allclose(value[central], exact[central], rtol=1e-11)


@each_kernel
@pytest.mark.parametrize("dtype", suite.DTYPES)
def test_kernels_run_alike_in_parts_and_threads(kernel: Kernel, dtype: str) -> None:
    inputs = Inputs(101, dtype)
    whole = np.array(bind(kernel, inputs)())
    assert whole.dtype == dtype
    assert not np.isnan(whole).any()
    normals = kernel.quantity == "sample" or kernel.form == "w, xi"
    sink = inputs.normals if normals else inputs.out
    sink[...] = np.nan
    with ThreadPoolExecutor(3) as pool:
        together(pool, [bind(kernel, inputs, part) for part in parts(101, 3)])()
    np.testing.assert_array_equal(sink.T if normals else sink, whole)


@pytest.mark.parametrize("kernel", arrays.MEASURED, ids=lambda kernel: kernel.name)
def test_functions_on_arrays_are_the_kernels(kernel: Kernel) -> None:
    inputs = Inputs(101, "float64")
    found = arrays.on_numpy(kernel, arrays.arguments(kernel, inputs))()
    np.testing.assert_allclose(found, bind(kernel, inputs)(), rtol=1e-11)


def test_functions_on_arrays_are_measured() -> None:
    pytest.importorskip("jax", reason="JAX is not installed")
    (kernel,) = (kernel for kernel in arrays.MEASURED if kernel.name == "ggx.D(u)")
    measurements = list(arrays.run((kernel,), 101, 0.0))
    assert [m.dtype for m in measurements] == list(suite.DTYPES)
    assert all(set(m.speeds) == {"ours", "JAX", "NumPy"} for m in measurements)
    results = Results({}, "", arrays=measurements)
    assert "| `ggx.D(u)` |" in "\n".join(page.arrays(results))


@pytest.mark.parametrize("dtype", suite.DTYPES)
def test_ufuncs_work_on_dask_arrays(dtype: str) -> None:
    da = pytest.importorskip("dask.array", reason="dask is not installed")
    u = Inputs(1000, dtype).u
    lazy = mf.beckmann.D(da.from_array(u, chunks=300), 0.3)
    assert isinstance(lazy, da.Array)
    np.testing.assert_array_equal(lazy.compute(scheduler="threads"), mf.beckmann.D(u, 0.3))


# How it is compared


def test_rounds_are_shared() -> None:
    calls: list[str] = []
    contenders = [Contender(name, lambda name=name: calls.append(name), 1) for name in ("a", "b")]
    times = interleave(contenders, 1e-4)
    assert {len(t) for t in times.values()} == {len(times["a"])}
    assert set(calls) == {"a", "b"}
    assert all((t > 0).all() for t in times.values())


def test_ratios_are_formed_within_a_round() -> None:
    """A machine that slows down by half between rounds leaves the ratio alone."""
    drift = np.array([1.0, 2.0, 4.0])
    times = {"ours": 1e-9 * drift, "other": 3e-9 * drift}
    assert ratios(times)["other"] == Spread(pytest.approx(3), pytest.approx(3), pytest.approx(3))
    assert speed(times["ours"]) == pytest.approx(1e9)


# The tables of names belong together


def test_targets_and_thresholds_name_what_is_measured() -> None:
    assert {target.kernel for target in targets.TARGETS} <= NAMES | set(renderer.NAMES)
    gated = {f"{kernel.name} {dtype}" for kernel in gate.GATED for dtype in suite.DTYPES}
    thresholds = gate.read()
    for isa, table in thresholds.items():
        assert set(table) <= gated, isa
    assert set().union(*thresholds.values()) == gated  # an instruction set may not have been measured since


# The commands


def invoke(*arguments: str | Path) -> Any:
    return CliRunner().invoke(main, [str(argument) for argument in arguments], catch_exceptions=False)


def test_a_run_writes_page_charts_and_results(tmp_path: Path) -> None:
    page, file = tmp_path / "page.md", tmp_path / "results.json"
    part = ("--only", "ggx.*(u)", "--length", "64", "--length", "128", "--seconds", "0.001")
    done = invoke("run", *part, "--json", file, "--output", page)
    assert done.exit_code == 0
    assert "ggx.sigma(u)" in done.output
    results = Results.read(file)
    assert [m.length for m in results.measurements] == [64] * 6 + [128] * 6
    assert all({"copy", "own exp", "numpy.exp", "NumPy"} == set(m.ratios) for m in results.measurements)
    text = page.read_text(encoding="utf-8")
    assert "| `ggx.D(u)` |" in text
    assert (tmp_path / "images" / "performance.png").stat().st_size > 1000
    assert invoke("page", file, "--output", tmp_path / "again.md").exit_code == 0
    assert (tmp_path / "again.md").read_text(encoding="utf-8") == text


def test_scaling_has_all_its_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scaling, "PREPARED", (64, 128))
    done = invoke(
        "run", "--quick", "--seconds", "0.001", "--only", "scaling.*", "--output", tmp_path / "page.md"
    )
    assert done.exit_code == 0
    text = (tmp_path / "page.md").read_text(encoding="utf-8")
    for heading in ("Length of the array", "Threads and dask", "Memory", "Fixed costs"):
        assert f"## {heading}" in text
    assert (tmp_path / "images" / "performance_scaling.png").exists()


def test_a_call_makes_no_temporary_larger_than_a_block() -> None:
    record = scaling.memory(1_000_000)
    if not record:
        pytest.skip("the system does not state the peak of memory")
    growth = record["growth"]
    assert growth.pop("the NumPy expression") > record["array"]  # so that the others would be seen
    assert max(growth.values()) < record["array"] / 4


def thresholds(path: Path, value: float) -> Path:
    isa = gate.instruction_set()
    path.write_text(f'[{isa}]\n"ggx.D(u) float32" = {{ "numpy.exp" = {value}, copy = {value} }}\n')
    return path


def test_the_gate_closes_with_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "thresholds.toml"
    assert invoke("check", "--seconds", "0.001", "--thresholds", thresholds(path, 1e-9)).exit_code == 0
    done = invoke("check", "--seconds", "0.001", "--thresholds", thresholds(path, 1e9))
    assert done.exit_code == 1
    assert "ggx.D(u) in float32 runs at" in done.stderr
    assert "at least 1e+09 is expected" in done.stderr


def test_the_gate_is_open_for_an_unknown_instruction_set(tmp_path: Path) -> None:
    done = invoke("check", "--thresholds", tmp_path / "none.toml")
    assert done.exit_code == 0
    assert "nothing is checked" in done.output


def test_a_missing_mitsuba_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    names, sentence = renderer.usable()
    assert names == ()
    assert sentence == "Mitsuba is not installed (pip install mitsuba)"


def test_pictures_stand_beside_the_built_in_plugin_of_their_family() -> None:
    """Or beside Beckmann; ratios are formed within a round."""
    rounds = np.array([1.0, 2.0, 4.0])
    times = {
        "built-in beckmann": rounds,
        "built-in ggx": 0.5 * rounds,
        "ggx single": 0.5 * rounds,
        "k0 single": 2.0 * rounds,
        "k0 multiple": 9.0 * rounds,
    }
    found = {(r.family, r.scattering): r for r in pictures.compared("conductor", times, 10)}
    assert len(found) == 3
    assert found["ggx", "single"].beside == "built-in ggx"
    assert found["k0", "single"].beside == "built-in beckmann"
    assert [r.ratio.median for r in found.values()] == [1.0, 2.0, 9.0]
    assert [r.missed for r in found.values()] == [False, True, False]
    assert found["ggx", "single"].milliseconds == 1e4
