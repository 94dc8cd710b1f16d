"""Settings for all tests: property tests are the same in every run, BLAS keeps to one thread, one cache."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from limits import HANG

settings.register_profile(
    "microfacet",
    deadline=None,  # as for too_slow: how long an example takes depends on what else the machine does
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
    derandomize=True,
    database=None,
)
settings.load_profile("microfacet")

# Where the workers of pytest-xdist fill the cores, the threads of a small eigenvalue problem wait for each
# other: a hundredth of a second becomes three. NumPy, which is not yet imported, reads it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# So does dask, which otherwise gives up on a connection after half a minute.
for _kind in ("CONNECT", "TCP"):
    os.environ.setdefault(f"DASK_DISTRIBUTED__COMM__TIMEOUTS__{_kind}", f"{HANG:.0f}s")


def pytest_configure(config: pytest.Config) -> None:
    """Compiled plugins live with pytest's other memories: one compilation serves all workers and runs."""
    if cache := getattr(config, "cache", None):
        os.environ.setdefault("MICROFACET_CACHE", str(cache.mkdir("microfacet")))


@pytest.fixture
def run() -> Callable[..., Any]:
    """The command line in this process: arguments to what `click.testing` says of it."""
    from click.testing import CliRunner

    from microfacet.cli import main

    def call(*arguments: str, stdin: str | None = None) -> Any:
        return CliRunner().invoke(main, list(arguments), input=stdin)

    return call


@pytest.fixture
def stub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A source of one line in place of Mitsuba's plugins."""
    import mitsuba_process
    from mitsuba_stub import VARIANT, Stub

    mitsuba_process.require(VARIANT)
    return Stub(tmp_path, monkeypatch)
