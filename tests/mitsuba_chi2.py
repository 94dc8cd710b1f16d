"""Mitsuba's chi-square harness on a plugin; to be imported where a variant is set.

The harness integrates the density over each of its cells by the trapezoidal rule. Where a density is infinite
at the mean normal that integral is wrong (it rejects exact samples of exact densities as well): there the
cells are integrated adaptively, and the histogram, the pooling and the statistic stay Mitsuba's.
"""

from __future__ import annotations

import json
import math
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import drjit
import mitsuba
import numpy as np
from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

from material_cases import towards
from microfacet.testing import chi2
from mitsuba_cases import Case, cases

SIGNIFICANCE = 0.01
SUBDIVISIONS = 64  # of each side of a cell; with 32 and less the harness rejects Mitsuba's own plugins
NODES, WEIGHTS = (0.5 * (a + b) for a, b in zip(np.polynomial.legendre.leggauss(20), (1.0, 0.0), strict=True))
PRECISION = 0.02  # of an integral, beside the scatter of the count
HALVINGS = 60
MOST = 1 << 17  # panels that are halved once more


@dataclass(frozen=True)
class Outcome:
    """What the harness said."""

    name: str
    p_value: float
    passed: bool
    mass: float  # integral of the density
    drawn: float  # share of samples that have a weight
    seconds: float
    messages: str
    plain: float = math.nan  # p-value of the harness as it comes


class Adaptive(ChiSquareTest):
    """The same test with cells integrated as finely as their density needs."""

    def tabulate_pdf(self) -> None:
        """The expected number of samples of each cell."""
        self.histogram_start = time.time()
        rows, columns = int(self.res.y), int(self.res.x)
        phi, down = np.linspace(-np.pi, np.pi, columns + 1), np.linspace(-1.0, 1.0, rows + 1)
        grid = (np.tile(phi[:-1], rows), np.tile(phi[1:], rows))
        panels = np.stack([*grid, np.repeat(down[:-1], columns), np.repeat(down[1:], columns)])
        owner = np.arange(rows * columns)
        value = self._integrals(panels)
        scatter = np.sqrt(np.maximum(value, 5.0 / self.sample_count) / self.sample_count)
        shares = np.zeros(rows * columns)
        for _ in range(HALVINGS):
            pairs = [_halved(panels, axis) for axis in (0, 1)]
            parts = [[self._integrals(half) for half in pair] for pair in pairs]
            change = np.abs([first + second - value for first, second in parts])
            across = change[0] > change[1]
            halves = [np.where(across, *sides) for sides in zip(*pairs, strict=True)]
            values = [np.where(across, *sides) for sides in zip(*parts, strict=True)]
            settled = change.max(axis=0) <= PRECISION * scatter[owner]
            np.add.at(shares, owner[settled], (values[0] + values[1])[settled])
            panels = np.hstack([half[:, ~settled] for half in halves])
            value = np.hstack([part[~settled] for part in values])
            owner = np.tile(owner[~settled], 2)
            if len(owner) == 0:
                break
            if len(owner) > MOST or not np.all(np.isfinite(value)):
                self._log(f"The density cannot be integrated: {len(owner)} panels, {value.max():g}")
                self.fail = True
                break
        np.add.at(shares, owner, value)
        self.pdf = mitsuba.Float((self.sample_count * shares).astype(np.float32))
        self.pdf_sum = drjit.sum(self.pdf) / self.sample_count
        self.histogram_end = time.time()

    def _integrals(self, panels: Any) -> Any:
        """Over panels of phi and -cos(theta) (4, n), by Gauss's rule; the directions in double precision."""
        n, nodes, F64 = panels.shape[1], len(NODES), mitsuba.Float64
        index = drjit.arange(mitsuba.UInt32, n * nodes * nodes)
        panel = index // (nodes * nodes)
        point = index - panel * (nodes * nodes)
        column, row = point % nodes, point // nodes
        low_x, high_x, low_y, high_y = (drjit.gather(F64, F64(side), panel) for side in panels)
        x = low_x + (high_x - low_x) * drjit.gather(F64, F64(NODES), column)
        y = low_y + (high_y - low_y) * drjit.gather(F64, F64(NODES), row)
        sine, (s, c) = drjit.sqrt((1.0 - y) * (1.0 + y)), drjit.sincos(x)
        density = self.pdf_func(mitsuba.Vector3f(sine * c, sine * s, -y))
        weight = drjit.gather(F64, F64(WEIGHTS), column) * drjit.gather(F64, F64(WEIGHTS), row)
        total = drjit.block_sum(F64(density) * weight, nodes * nodes)
        return np.array(total) * (panels[1] - panels[0]) * (panels[3] - panels[2])


def _halved(panels: Any, axis: int) -> tuple[Any, Any]:
    first, second = panels.copy(), panels.copy()
    first[2 * axis + 1] = second[2 * axis] = 0.5 * (panels[2 * axis] + panels[2 * axis + 1])
    return first, second


def _loaded(case: Case, wi: list[float]) -> Callable[[Any], Any]:
    """The density of BSDFAdapter, which makes the plugin anew for every call."""
    bsdf, context = mitsuba.load_dict(case.properties), mitsuba.BSDFContext()

    def density(wo: Any) -> Any:
        interaction = drjit.zeros(mitsuba.SurfaceInteraction3f, drjit.width(wo))
        interaction.wi = wi
        return bsdf.pdf(context, interaction, wo)

    return density


def run(case: Case, tests: int, samples: int = 1_000_000, plain: bool = False) -> Outcome:
    """One test of `tests`, in a variant of arrays; if `plain`, of the harness as it comes too."""
    begin = time.perf_counter()
    wi = [float(x) for x in towards(case.degrees, case.azimuth)]
    sample, density = BSDFAdapter(case.plugin, case.properties, wi=wi)
    seed = zlib.crc32(str(case).encode()) >> 1  # with one seed for all, their p-values would go together
    test = Adaptive(SphericalDomain(), sample, _loaded(case, wi), 3, samples, seed=seed)
    passed = test.run(SIGNIFICANCE, tests, quiet=True)
    as_it_comes = math.nan
    if plain:
        other = ChiSquareTest(SphericalDomain(), sample, density, 3, samples, ires=SUBDIVISIONS, seed=seed)
        other.run(SIGNIFICANCE, tests, quiet=True)
        as_it_comes = 0.0 if other.fail else float(other.p_value)
    mass, drawn = float(test.pdf_sum[0]), float(test.histogram_sum[0])
    spent = time.perf_counter() - begin
    return Outcome(
        str(case), float(test.p_value), bool(passed), mass, drawn, spent, test.messages, as_it_comes
    )


def run_scalar(case: Case, tests: int, samples: int = 20_000) -> Outcome:
    """The same question to a scalar variant, which Mitsuba's harness does not know: one call at a time."""
    begin = time.perf_counter()
    bsdf = mitsuba.load_dict(case.properties)
    context, interaction = mitsuba.BSDFContext(), mitsuba.SurfaceInteraction3f()
    interaction.wi = mitsuba.Vector3f(*(float(x) for x in towards(case.degrees, case.azimuth)))

    def draw(xi: Any) -> Any:
        """Directions; those without weight are lost."""
        found = np.full((len(xi), 3), np.nan)
        for k, (choice, *point) in enumerate(xi.tolist()):
            sample, weight = bsdf.sample(context, interaction, choice, point)
            if max(weight) > 0.0:
                found[k] = sample.wo
        return found

    def density(w: Any) -> Any:
        values = [bsdf.pdf(context, interaction, wo) for wo in w.reshape(-1, 3).tolist()]
        return np.array(values).reshape(w.shape[:-1])

    options: dict[str, Any] = {"dtype": np.float32, "resolution": (8, 8), "lossy": True}
    options |= {"seed": zlib.crc32(str(case).encode()), "significance": SIGNIFICANCE, "tests": tests}
    found = chi2(draw, density, domain="sphere", n=samples, dims=3, **options)
    drawn = 1.0 - found.outside / samples
    spent = time.perf_counter() - begin
    return Outcome(str(case), found.p_value, found.passed, found.mass, drawn, spent, repr(found))


def run_named(names: list[str], tests: int, **options: Any) -> Iterator[Outcome]:
    """The cases of these names."""
    known = {str(case): case for case in (*cases(), *cases(built_in=True))}
    harness = run_scalar if mitsuba.variant().startswith("scalar") else run
    for name in names:
        yield harness(known[name], tests, **options)


def report(names: list[str], tests: int, **options: Any) -> None:
    """Outcomes as lines of JSON."""
    for outcome in run_named(names, tests, **options):
        print(json.dumps(asdict(outcome)), flush=True)
