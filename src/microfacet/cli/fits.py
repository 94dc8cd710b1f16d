"""Files to fit: one by one in this process, or many on the workers of dask."""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import microfacet as mf
from microfacet._fit.prediction import ANGLES, Prediction, predict
from microfacet._fit.result import remarks
from microfacet._optional import installed, sentence
from microfacet.cli import surfaces
from microfacet.cli.printing import finite

__all__ = ["Failure", "Fitted", "Job", "attempt", "run"]

Progress = Callable[[str, int, int], None]

_FIT = (
    "family", "params", "standard_errors", "log_likelihood", "log_likelihood_per_sample", "held_out",
    "held_out_error", "tied", "aic", "bic", "converged",
)  # fmt: skip


@dataclass(frozen=True)
class Job:
    """One file and what to do with it."""

    file: str
    reading: dict[str, Any] = field(default_factory=dict)
    families: tuple[Any, ...] = ()  # names, or families of one's own
    scales: bool = True
    max_slopes: int | None = None
    angles: tuple[float, ...] = ANGLES
    terrain: bool = False  # instead of a file

    def run(self, progress: Progress = lambda *_: None) -> Fitted:
        """Read, prepare, fit."""
        chosen = self.families or None
        options = {} if self.max_slopes is None else {"max_slopes": self.max_slopes}
        found = self._terrain() if self.terrain else surfaces.load(self.file, **self.reading)
        fitted_to = found.values if isinstance(found, mf.SlopeSample) else found
        results = mf.fit(fitted_to, chosen, progress=progress, **options)
        fitted = Fitted(found.source, found.steps, results, predict(results, self.angles), found)
        if isinstance(found, mf.SlopeSample):
            return fitted
        return replace(
            fitted,
            pixel=math.sqrt(math.prod(found.pixel_size)),
            roughness=mf.roughness(found),
            scales=mf.fit_scales(found, families=chosen, progress=progress) if self.scales else None,
        )

    def _terrain(self) -> mf.Surface:
        surface, lag = mf.sample_terrain().level(), self.reading.get("lag")
        return surface if lag is None else surface.at_lag(lag)


@dataclass(frozen=True)
class Fitted:
    """What came out; slopes without positions have neither roughness nor scales."""

    source: str
    steps: tuple[str, ...]
    results: list[mf.FitResult]
    predictions: list[Prediction]
    measured: mf.Surface | mf.SlopeSample | None = None
    pixel: float | None = None  # metres; of two sizes the geometric mean
    roughness: Any = None
    scales: mf.ScaleFit | None = None

    @property
    def notes(self) -> list[str]:
        """What the fits remark, and what the fits at several lags do."""
        return [*remarks(self.results), *(self.scales.notes if self.scales else ())]

    def as_dict(self) -> dict[str, Any]:
        """As a record for JSON: what was done, the ranked families, and what follows from them."""
        first = self.results[0]
        record = {
            "source": self.source,
            "steps": list(self.steps),
            "lag": first.lag,
            "lag_length": first.lag * self.pixel if first.lag and self.pixel else None,
            "n": first.n,
            "n_effective": first.n_effective,
            "mean_slope": first.mean_slope,
            "mean_slope_errors": first.mean_slope_errors,
            "ranking": [_ranked(result) for result in self.results],
            "prediction": [asdict(prediction) for prediction in self.predictions],
            "roughness": self.roughness._asdict() if self.roughness else None,
            "scales": _scales(self.scales) if self.scales else None,
            "notes": self.notes,
        }
        return dict(finite(record))


@dataclass(frozen=True)
class Failure:
    """A file that cannot be fitted, and why."""

    source: str
    error: str

    def as_dict(self) -> dict[str, Any]:
        """As a record for JSON."""
        return {"error": self.error}


def run(
    jobs: Sequence[Job], dask: str | None, progress: Progress, warn: Callable[[str], None]
) -> list[Fitted | Failure]:
    """Every job; of a single one the errors are raised, of several they are collected.

    `dask` is the address of a scheduler, "local", "none", or None: local for several files if dask is there.
    """
    if len(jobs) == 1 and dask in (None, "none"):
        return [jobs[0].run(progress)]
    there = installed("distributed")
    if dask not in (None, "none") and not there:
        raise ImportError(sentence(f"--dask {dask} needs", "distributed"))
    if dask == "none" or not there:
        if not there:
            warn(sentence("fitting several files at a time needs", "distributed"))
        return [_attempt(job, progress, done, len(jobs)) for done, job in enumerate(jobs)]
    with _client("local" if dask is None else dask, len(jobs)) as client:
        distributed: Any = importlib.import_module("distributed")
        futures = client.map(attempt, jobs, pure=False)
        for done, _ in enumerate(distributed.as_completed(futures), start=1):
            progress("files", done, len(jobs))
        return list(client.gather(futures))


def attempt(job: Job) -> Fitted | Failure:
    """On a worker: without the map, which would have to travel."""
    try:
        return replace(job.run(), measured=None)
    except (ValueError, ImportError, OSError) as error:
        return Failure(job.file, " ".join(str(error).split()))
    except MemoryError:
        return Failure(job.file, f"{job.file}: there is not enough memory")


def _attempt(job: Job, progress: Progress, done: int, total: int) -> Fitted | Failure:
    progress(job.file, done, total)
    return attempt(job)


@contextmanager
def _client(address: str, jobs: int) -> Iterator[Any]:
    """A client of the scheduler at an address, or of a cluster of processes on this machine."""
    distributed: Any = importlib.import_module("distributed")
    if address != "local":
        try:
            client = distributed.Client(address)
        except (OSError, ValueError) as error:
            raise ValueError(f"--dask: no scheduler answers at {address} ({error})") from error
        with client:
            yield client
        return
    workers = min(jobs, os.cpu_count() or 1)
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _ranked(result: Any) -> dict[str, Any]:
    record = {name: getattr(result, name) for name in _FIT}
    return record | {"goodness": asdict(result.goodness), "notes": list(result.notes)}


def _scales(scales: Any) -> dict[str, Any]:
    """Against the lag, for every family; the details of each fit are those of a fit at that lag."""
    families = sorted(result.family for result in scales.results[0])
    by_lag = [{result.family: result for result in results} for results in scales.results]
    return {
        "lags": scales.lags,
        "lengths": scales.lengths,
        "best": [results[0].family for results in scales.results],
        "typical_slopes": scales.typical_slopes,
        "exponents": scales.exponents,
        "noise_lags": scales.noise_lags,
        "params": {name: [fits[name].params for fits in by_lag] for name in families},
        "standard_errors": {name: [fits[name].standard_errors for fits in by_lag] for name in families},
    }
