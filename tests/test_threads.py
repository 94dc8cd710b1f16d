"""Threads: materials use all processors for large arrays, and nothing about a result shows how many."""

from __future__ import annotations

import os
import pathlib
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from material_cases import Array, directions
from microfacet import _threads
from microfacet._bsdf import kernels

N = 3_001
COLOURS = ([0.2, 1.04, 1.18], [3.9, 2.6, 2.4])
METAL = mf.Conductor(mf.StudentT(alpha_x=0.2, alpha_y=0.5, rotation=0.3, gamma=2.5), *COLOURS)
GOLD = mf.Conductor(mf.GGX(alpha=0.6), *COLOURS, scattering="multiple")
MIRROR = mf.Conductor(mf.Beckmann(alpha=0.3))
GLASS = mf.Dielectric(mf.K0(alpha=0.4), 1.5)
CLAY = mf.Diffuse(mf.GTR(alpha=0.5, gamma=1.5), [[0.2, 0.5], [0.7, 0.9]])
GREY = mf.Diffuse(mf.GGX(alpha=0.5), 0.5, scattering="single")

WI, WO = directions(N, 2), directions(N, 3)
XI = np.random.default_rng(1).random((N, 4))
CALLS: dict[str, Callable[[], Any]] = {
    "eval": lambda: MIRROR.eval(WI, WO),
    "eval, float32": lambda: MIRROR.eval(WI.astype(np.float32), WO.astype(np.float32)),
    "eval, channels": lambda: METAL.eval(WI, WO),
    "eval, one direction": lambda: METAL.eval(WI[0], WO),
    "eval, broadcast": lambda: METAL.eval(WI[:40, np.newaxis], WO[:50]),
    "pdf": lambda: GLASS.pdf(WI, WO),
    "sample": lambda: GLASS.sample(WI, XI),
    "sample, channels": lambda: METAL.sample(WI, XI),
    "walk": lambda: GOLD.walk(WI, rng=1),
    "walk, shape": lambda: GOLD.walk(WI[:3000].reshape(50, 60, 3), rng=1),
    "sample by walks": lambda: CLAY.sample(WI, rng=2),
    "eval by walks": lambda: CLAY.eval(WI, WO, n=3, rng=1),
    "eval by walks, one element": lambda: CLAY.eval(WI[0], WO[0], n=300, rng=1),
    "eval by walks, one element, no channels": lambda: GREY.eval(WI[0], WO[0], n=300, rng=1),
    "albedo": lambda: MIRROR.albedo(WI[:40]),
    "albedo by walks": lambda: CLAY.albedo(WI[:7], n=500, rng=1),
    "average_albedo": lambda: MIRROR.average_albedo(),
    "average_albedo by walks": lambda: GOLD.average_albedo(n=5000, rng=1),
}


@pytest.fixture
def eager(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Threads for arrays of any length; the sizes of the pools that were started."""
    monkeypatch.setattr(kernels, "WORTH_THREADS", 1)
    return pools(monkeypatch)


def pools(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    started: list[int] = []

    class Counted(ThreadPoolExecutor):
        def __init__(self, workers: int) -> None:
            started.append(workers)
            super().__init__(workers)

    monkeypatch.setattr(_threads, "ThreadPoolExecutor", Counted)
    return started


def arrays(result: Any) -> list[Array]:
    return list(result) if isinstance(result, tuple) else [result]


@pytest.mark.parametrize("name", CALLS)
def test_the_same_bits_for_any_number_of_threads(
    name: str, eager: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for count in ("1", "2", "5"):
        monkeypatch.setenv("MICROFACET_THREADS", count)
        found.append(arrays(CALLS[name]()))
    assert 1 not in eager
    if "one element" not in name:
        assert {2, 5} <= {*eager} if "albedo" not in name else 2 in eager
    for other in found[1:]:
        for a, b in zip(other, found[0], strict=True):
            assert (a.dtype, a.shape) == (b.dtype, b.shape)
            np.testing.assert_array_equal(a, b)


def test_small_arrays_start_no_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    started = pools(monkeypatch)
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    METAL.eval(WI, WO)
    METAL.sample(WI, XI)
    GOLD.walk(WI, rng=1)
    GLASS.albedo(WI[0])
    assert started == []
    many = np.broadcast_to(WI[0], (kernels.WORTH_THREADS, 3))
    MIRROR.pdf(many, many)
    assert started == [2]


def test_other_threads_than_the_main_one_start_none(
    eager: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    found: list[Any] = []
    thread = threading.Thread(target=lambda: found.append(METAL.eval(WI, WO)))
    thread.start()
    thread.join()
    assert eager == []
    np.testing.assert_array_equal(found[0], METAL.eval(WI, WO))
    assert eager == [2]


def test_the_number_of_threads_is_that_of_the_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MICROFACET_THREADS", raising=False)
    assert 1 <= _threads.threads() <= (os.cpu_count() or 1)
    monkeypatch.setenv("MICROFACET_THREADS", "7")
    assert _threads.threads() == 7


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, 4),
        ({"cpu.max": "max 100000\n"}, 4),
        ({"cpu.max": "150000 100000\n"}, 2),
        ({"cpu.max": "900000 100000\n"}, 4),
        ({"cpu.max": "1000 100000\n"}, 1),
        ({"cpu.max": "nonsense"}, 4),
        ({"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, 4),
        ({"cpu/cpu.cfs_quota_us": "100000\n", "cpu/cpu.cfs_period_us": "100000\n"}, 1),
    ],
)
def test_a_container_that_grants_fewer_processors_is_heeded(
    files: dict[str, str], expected: int, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_threads, "_CONTROL_GROUP", tmp_path)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2, 3}, raising=False)
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    assert _threads.processors() == expected


@pytest.mark.parametrize("bad", ["0", "-1", "two", "", "1.5", "²"])
def test_no_number_of_threads_is_one_sentence(
    bad: str, eager: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", bad)
    with pytest.raises(ValueError, match=r"^MICROFACET_THREADS must be a whole number in \[1, inf\), got '"):
        MIRROR.eval(WI, WO)


@pytest.mark.parametrize("count", [1, 2, 7, 100, 1000])
def test_blocks_make_up_the_whole(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "3")
    parts = _threads.blocks(count)
    np.testing.assert_array_equal(
        np.concatenate([np.arange(count)[part] for part in parts]), np.arange(count)
    )
    assert len(parts) <= 12


def test_the_first_error_ends_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    before = set(threading.enumerate())  # of which those of other libraries may end meanwhile
    ran: list[int] = []
    fails = threading.Event()

    def work(i: int) -> int:
        if i == 0:
            fails.set()
            raise ArithmeticError("of part 0")
        fails.wait()
        ran.append(i)
        return i

    with pytest.raises(ArithmeticError, match="of part 0"):
        _threads.in_threads(work, range(10_000))
    assert len(ran) < 10_000
    assert set(threading.enumerate()) <= before


def test_threads_see_the_callers_error_state(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    with np.errstate(divide="raise"), pytest.raises(FloatingPointError):
        _threads.in_threads(lambda x: np.ones(1) / x, [np.zeros(1)] * 4)


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="there is no signal for one thread")
def test_an_interrupt_ends_a_long_call(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    before = set(threading.enumerate())  # of which those of other libraries may end meanwhile
    main = threading.main_thread().ident
    ran: list[int] = []

    def work(i: int) -> None:
        if i == 20:
            assert main is not None
            signal.pthread_kill(main, signal.SIGINT)
        time.sleep(0.001)
        ran.append(i)

    # A run in the background may have been started with interrupts ignored.
    ignored = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            _threads.in_threads(work, range(10_000))
    finally:
        signal.signal(signal.SIGINT, ignored)
    assert 0 < len(ran) < 10_000
    assert set(threading.enumerate()) <= before


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_starts_threads_of_its_own(
    eager: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MICROFACET_THREADS", "2")
    expected = METAL.eval(WI, WO)
    child = os.fork()
    if child == 0:
        signal.alarm(30)
        os._exit(0 if np.array_equal(METAL.eval(WI, WO), expected) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
