"""Where memory ends: MemoryError in Python, one sentence of the commands, and no end of the process."""

from __future__ import annotations

import subprocess
import sys
import textwrap

import pytest
from click.testing import CliRunner

import microfacet as mf
from limits import HANG
from microfacet.cli import main, sample

FILL = """
import resource
import sys
import numpy as np
import microfacet as mf
from microfacet import _core

def fill():
    size = int(open("/proc/self/status").read().split("VmSize:")[1].split()[0]) * 1024
    resource.setrlimit(resource.RLIMIT_AS, (size, resource.RLIM_INFINITY))
    blocks, size = [], 2**24
    while size >= 2**14:
        try:
            blocks.append(bytearray(size))
        except MemoryError:
            size //= 2
    return blocks
"""
linux = pytest.mark.skipif(sys.platform != "linux", reason="limits of address space")


def run(code: str) -> set[str]:
    """What the code prints, in a process whose memory it fills."""
    done = subprocess.run(
        [sys.executable, "-c", FILL + textwrap.dedent(code)], capture_output=True, text=True, timeout=HANG
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


@linux
def test_every_loop_raises() -> None:
    """Each ufunc of each namespace, in both precisions: values, parameters and results are there already."""
    failed = run("""
    calls = []
    for family in (*_core.families, "radial"):
        space = getattr(_core, family)
        for name, ufunc in vars(space).items():
            if isinstance(ufunc, np.ufunc):
                for types in ufunc.types:
                    given, _, made = types.partition("->")
                    x = [np.full(9000 if k < 12 else (), 0.61, kind) for k, kind in enumerate(given)]
                    y = tuple(np.empty(9000, kind) for kind in made)
                    if "walk_eval" not in name:  # these take a number of walks
                        calls.append((family, name, types, ufunc, x, y))
    # Parameters are constant where a table of them would be made.
    for family, name, types, ufunc, x, y in calls:
        for k in range(ufunc.nin - 6, ufunc.nin):
            if k > 0:
                x[k] = np.asarray(x[k].flat[0] * 3)
    failed = [None] * len(calls)
    blocks = fill()
    for number, (family, name, types, ufunc, x, y) in enumerate(calls):
        try:
            ufunc(*x, out=y)
        except MemoryError:
            failed[number] = True
    del blocks
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    for call, raised in zip(calls, failed):
        if raised:
            print(f"{call[0]}.{call[1]}:{call[2][0]}")
    """)
    for name in ("bessel_k.Lambda:d", "bessel_k.sigma:d", "ggx.conductor_walk:d", "k0.dielectric_walk:f"):
        assert name in failed


@linux
@pytest.mark.parametrize("call", ["load(stored)", "build(density, -20.0, 5.0, 1.0, None)"])
def test_densities_of_a_users_own_raise(call: str) -> None:
    assert run(f"""
    radial = _core.radial
    density = lambda L: np.exp(-np.exp(2 * L))
    (capsule, handle, _), _, _ = radial.build(density, -20.0, 5.0, 1.0, None)
    stored = radial.dump(handle)
    blocks = fill()
    try:
        kept = [radial.{call} for _ in range(1000)]
        print("fine")
    except MemoryError:
        print("MemoryError")
    """) == {"MemoryError"}


def test_a_command_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError("Unable to allocate 7.45 EiB")

    monkeypatch.setattr(sample, "write_csv", exhausted)
    result = CliRunner().invoke(main, ["sample", "ggx", "--alpha", "0.3"])
    assert result.exit_code == 2
    assert result.stderr == "microfacet: there is not enough memory: Unable to allocate 7.45 EiB\n"
    monkeypatch.setattr(sample, "write_csv", lambda *_: bytes(2**62))
    result = CliRunner().invoke(main, ["sample", "ggx", "--alpha", "0.3"])
    assert result.exit_code == 2
    assert result.stderr == "microfacet: there is not enough memory\n"


def test_one_file_of_several_says_so(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    import numpy as np

    def exhausted(*_: object, **__: object) -> None:
        raise MemoryError

    for name in ("a.npy", "b.npy"):
        np.save(tmp_path / name, np.random.default_rng(0).normal(size=(50, 2)))
    monkeypatch.setattr(mf, "fit", exhausted)
    files = [str(tmp_path / name) for name in ("a.npy", "b.npy")]
    result = CliRunner().invoke(main, ["fit", *files, "--slopes", "table", "--dask", "none"])
    assert result.exit_code == 2
    assert result.stderr.count("there is not enough memory") == 2
