"""Which samplers are tested, and how: tests/test_sampling.py takes some, tools/measure_sampling.py all."""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import microfacet as mf
from microfacet.testing import Chi2Result, SlopeResult, chi2, ks_visible_slope
from shapes import several_shapes

ALPHAS = (0.01, 0.1, 0.5, 1.0, 3.0)
SHAPES = several_shapes(
    {"student_t": (1.55, 2.5, 20.0), "bessel_k": (0.3, 1.3, 10.0), "gtr": (0.5, 1.0, 1.5, 3.0)}
)
STRETCH = {"alpha_x": 0.1, "alpha_y": 0.6}
INCIDENCES = (0.0, 30.0, 60.0, 80.0, 88.0, 89.9, 95.0, 130.0, 170.0)
AZIMUTHS = (0.0, 35.0)  # along an axis of the stretched densities, and between both
SMALLEST = 1e-290  # sigma below that has no digits in double precision


@dataclass(frozen=True)
class Case:
    """One sampler: of all normals (scheme "all"), or of those seen from an incidence, in degrees."""

    family: str
    parameters: tuple[tuple[str, float], ...]
    scheme: str
    incidence: float = 0.0
    azimuth: float = 0.0
    dtype: str = "float64"

    def __str__(self) -> str:
        values = ", ".join(f"{name} {value:g}" for name, value in self.parameters)
        seen = "" if self.scheme == "all" else f" from {self.incidence:g}, {self.azimuth:g} degrees"
        return f"{self.family} ({values}), {self.scheme}{seen}, {self.dtype}"

    @property
    def seed(self) -> int:
        """Of its own, so that no two cases share their random numbers."""
        return zlib.crc32(str(self).encode())

    @cached_property
    def ndf(self) -> Any:
        """The distribution."""
        cls = next(family.cls for family in mf.families() if family.name == self.family)
        return cls(**dict(self.parameters))

    @cached_property
    def given(self) -> NDArray[Any]:
        """The direction of incidence, as the sampler is given it."""
        s, c = np.sin(np.radians(self.incidence)), np.sin(np.radians(90.0 - self.incidence))
        phi = np.radians(self.azimuth)
        return np.array([s * np.cos(phi), s * np.sin(phi), c]).astype(self.dtype)

    @cached_property
    def w(self) -> NDArray[np.float64]:
        """The same direction, of unit length in double precision."""
        w = self.given.astype(np.float64)
        return np.asarray(w / np.linalg.norm(w))

    @property
    def exists(self) -> bool:
        """Whether anything can be seen."""
        return self.scheme == "all" or bool(self.ndf.sigma(self.w) > SMALLEST)

    @property
    def dims(self) -> int:
        """Uniform random numbers of one normal."""
        if self.scheme in ("all", "bounded"):
            return 2
        return int(self.ndf.mixture_dims if self.scheme == "mixture" else self.ndf.visible_dims)

    def sample(self, xi: NDArray[Any]) -> NDArray[Any]:
        """Normals."""
        if self.scheme == "all":
            return np.asarray(self.ndf.sample(xi))
        how = {"bounded": True} if self.scheme == "bounded" else {"scheme": self.scheme}
        return np.asarray(self.ndf.sample_visible(self.given, xi, **how))

    def density(self, m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Their density, in double precision."""
        if self.scheme == "all":
            return np.asarray(self.ndf.pdf(m))
        return np.asarray(self.ndf.pdf_visible(m, self.w, bounded=self.scheme == "bounded"))

    def chi2(self, n: int, tests: int, resolution: tuple[int, int] = (32, 32)) -> Chi2Result:
        """The test in two dimensions, which also integrates the density."""
        options: dict[str, Any] = {"n": n, "tests": tests, "resolution": resolution, "dims": self.dims}
        return chi2(self.sample, self.density, **options, dtype=self.dtype, seed=self.seed)

    @property
    def has_slope(self) -> bool:
        """Whether slopes in the plane of incidence have a closed distribution function."""
        return self.scheme not in ("all", "bounded")

    def slope(self, n: int, tests: int) -> SlopeResult:
        """The test of these slopes."""
        options: dict[str, Any] = {"sampler": self.sample, "dims": self.dims, "dtype": self.dtype}
        return ks_visible_slope(self.ndf, self.w, n=n, tests=tests, seed=self.seed + 1, **options)


def _distributions() -> Iterator[tuple[str, dict[str, float]]]:
    for family in (family for family in mf.families() if not family.singular):
        shape = next((p.name for p in family.parameters if p.name != "alpha"), None)
        for value in SHAPES.get(family.name, (0.0,)):
            own = {} if shape is None else {shape: value}
            for alpha in ALPHAS:
                yield family.name, {"alpha": alpha, **own}
            if family.anisotropic:
                yield family.name, {**STRETCH, **own}


def cases() -> Iterator[Case]:
    """The full grid: what can be represented of families, roughness, shape, incidence, scheme, precision."""
    for (family, parameters), dtype in itertools.product(_distributions(), ("float64", "float32")):
        given = tuple(parameters.items())
        yield Case(family, given, "all", dtype=dtype)
        schemes = ("continuous", "mixture", *(("bounded",) if family == "ggx" else ()))
        azimuths = AZIMUTHS if "alpha_x" in parameters else AZIMUTHS[1:]
        for scheme, incidence, azimuth in itertools.product(schemes, INCIDENCES, azimuths):
            if scheme == "bounded" and incidence > 90.0:
                continue  # nothing reflects upwards from below
            case = Case(family, given, scheme, incidence, azimuth, dtype)
            if case.exists:
                yield case


def selection(share: int = 31) -> list[Case]:
    """One in `share`, which meets every family, roughness, shape, incidence and scheme."""
    everything = list(cases())
    chosen = everything[::share]
    for case in everything:
        if all((case.family, case.scheme) != (other.family, other.scheme) for other in chosen):
            chosen.append(case)
    return chosen
