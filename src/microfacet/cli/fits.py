"""Files to fit: one by one in this process, or many on the workers of dask."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, NamedTuple

import microfacet as mf
from microfacet._fit.prediction import ANGLES, Prediction, predict
from microfacet._fit.result import remarks
from microfacet._fit.scales import by_family
from microfacet._optional import installed, sentence
from microfacet._surface.lateral import lateral
from microfacet.cli import areal, cluster, profiles, surfaces
from microfacet.cli.printing import finite

__all__ = ["Extent", "Failure", "Fitted", "Job", "attempt", "run"]

Progress = Callable[[str, int, int], None]

_FIT = (
    "family", "symmetry", "params", "standard_errors", "log_likelihood", "log_likelihood_per_sample",
    "held_out", "held_out_error", "tied", "aic", "bic", "converged",
)  # fmt: skip


class Extent(NamedTuple):
    """What is measured: size of a pixel in metres (dx, dy), pixels (ny, nx), and which share has a height."""

    pixel_size: tuple[float, float]
    shape: tuple[int, int]
    valid_fraction: float

    @classmethod
    def of(cls, surface: mf.Surface) -> Extent:
        """Of a map."""
        ny, nx = surface.mask.shape
        return cls(surface.pixel_size, (ny, nx), float(surface.mask.mean()))

    @classmethod
    def of_profile(cls, profile: mf.Profile) -> Extent:
        """Of traces, which are rows of nothing between them."""
        longest = max(trace.size for trace in profile.traces)
        return cls((profile.spacing, math.nan), (len(profile), longest), profile.valid_fraction)


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
    symmetry: str | None = None  # both
    max_slope: float | None = None  # that the instrument measures

    def run(self, progress: Progress = lambda *_: None) -> Fitted:
        """Read, prepare, fit."""
        chosen = self.families or None
        options: dict[str, Any] = {} if self.max_slopes is None else {"max_slopes": self.max_slopes}
        options |= {"symmetry": self.symmetry, "max_slope": self.max_slope}
        progress(f"reading {self.file}", 0, 0)
        found = self._terrain() if self.terrain else surfaces.load(self.file, **self.reading)
        results = mf.fit(found, chosen, progress=progress, **options)
        fitted = Fitted(found.source, found.steps, results, predict(results, self.angles), found)
        if isinstance(found, mf.SlopeSample):
            return fitted
        if isinstance(found, mf.Profile):
            return replace(
                fitted,
                predictions=fitted.predictions[: len(self.angles)],  # no azimuth differs from another
                pixel=found.spacing,
                extent=Extent.of_profile(found),
                roughness=found.roughness(),
                scales=self._scales(found, progress) if self.scales else None,
                profile=profiles.record(found),
            )
        progress("roughness, spectrum and autocorrelation", 0, 0)
        spectrum, autocorrelation = lateral(found) or (None, None)
        return replace(
            fitted,
            spectrum=spectrum,
            autocorrelation=autocorrelation,
            pixel=math.sqrt(math.prod(found.pixel_size)),
            extent=Extent.of(found),
            roughness=mf.roughness(found),
            scales=self._scales(found, progress) if self.scales else None,
        )

    def _scales(self, surface: mf.Surface | mf.Profile, progress: Progress) -> mf.ScaleFit:
        chosen = self.families or None
        return mf.fit_scales(surface, families=chosen, progress=progress, symmetry=self.symmetry)

    def _terrain(self) -> mf.Surface:
        surface, lag = mf.sample_terrain().level(), self.reading.get("lag")
        return surface if lag is None else surface.at_lag(lag)


@dataclass(frozen=True)
class Fitted:
    """What came out; slopes without positions have neither roughness nor scales."""

    source: str
    steps: tuple[str, ...]
    results: mf.FitResults
    predictions: list[Prediction]
    measured: mf.Surface | mf.Profile | mf.SlopeSample | None = None
    pixel: float | None = None  # metres; of two sizes the geometric mean
    roughness: Any = None
    spectrum: mf.Spectrum | None = None
    autocorrelation: mf.Autocorrelation | None = None
    scales: mf.ScaleFit | None = None
    extent: Extent | None = None
    profile: dict[str, Any] | None = None

    @property
    def notes(self) -> list[str]:
        """What the fits remark, what the fits at several lags do, and what the lateral structure says."""
        return [
            *remarks(self.results),
            *(self.scales.notes if self.scales else ()),
            *areal.notes(self.spectrum, self.autocorrelation),
        ]

    def as_dict(self) -> dict[str, Any]:
        """As a record for JSON: what was done, the ranked families, and what follows from them."""
        first = self.results[0]
        record = {
            "source": self.source,
            "steps": list(self.steps),
            "extent": self.extent._asdict() if self.extent else None,
            "lag": first.lag,
            "lag_length": first.lag * self.pixel if first.lag and self.pixel else None,
            "n": first.n,
            "n_effective": first.n_effective,
            "mean_slope": first.mean_slope,
            "mean_slope_errors": first.mean_slope_errors,
            "verdict": asdict(self.results.verdict),
            "warnings": list(self.results.warnings),
            "halves": asdict(self.results.halves) if self.results.halves else None,
            "ranking": [_ranked(result) for result in self.results],
            "prediction": [asdict(prediction) for prediction in self.predictions],
            **(
                profiles.roughness_record(self.roughness)
                if self.profile
                else areal.record(self.roughness, self.spectrum, self.autocorrelation)
            ),
            "scales": _scales(self.scales) if self.scales else None,
            **({"profile": self.profile} if self.profile else {}),
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

    `dask` is the address of a scheduler, "local", "none", or None: local for several files
    that are large enough together, if dask is there.
    """
    if len(jobs) == 1 and dask in (None, "none"):
        return [jobs[0].run(progress)]
    there = installed("distributed")
    if dask not in (None, "none") and not there:
        raise ImportError(sentence(f"--dask {dask} needs", "distributed"))
    wanted = dask or ("local" if cluster.worthwhile(job.file for job in jobs) else "none")
    if wanted == "none" or not there:
        if wanted != "none":
            warn(sentence("fitting several files at a time needs", "distributed"))
        return [_attempt(job, progress, done, len(jobs)) for done, job in enumerate(jobs)]
    with cluster.client(wanted, len(jobs)) as client:
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


def _ranked(result: Any) -> dict[str, Any]:
    record = {name: getattr(result, name) for name in _FIT}
    return record | {"goodness": asdict(result.goodness), "notes": list(result.notes)}


def _scales(scales: Any) -> dict[str, Any]:
    """Against the lag, for every family; the details of each fit are those of a fit at that lag."""
    by_lag = by_family(scales.results)
    families = sorted(by_lag[0])
    return {
        "lags": scales.lags,
        "lengths": scales.lengths,
        "best": [results[0].family for results in scales.results],
        "symmetry": {name: by_lag[0][name].symmetry for name in families},
        "typical_slopes": scales.typical_slopes,
        "exponents": scales.exponents,
        "noise_lags": scales.noise_lags,
        "params": {name: [fits[name].params for fits in by_lag] for name in families},
        "standard_errors": {name: [fits[name].standard_errors for fits in by_lag] for name in families},
    }
