"""The fit of all families beside the same likelihoods in scipy.stats, scipy.special and scipy.optimize.

    python -m benchmarks.fitting [--slopes 1000000] [--family student_t]

`microfacet.fit` includes what SciPy's side leaves out: standard errors, cross-validation and goodness of fit.
SciPy starts at the moments' answer and stops at a gradient of 1e-5 per slope; both maxima are compared.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy import special, stats
from scipy.optimize import minimize

import microfacet as mf

Vector = NDArray[np.float64]
Likelihood = Callable[[Vector, Vector], float]
SEED, GAMMA = 7, 4.0


def sample(n: int) -> Vector:
    """Student-T slopes along turned axes, with heavier tails than most families."""
    rng = np.random.default_rng(SEED)
    radius, azimuth = mf.student_t.sample_slope(rng.random(n), 1.0, GAMMA), 2 * np.pi * rng.random(n)
    p, q = 0.12 * radius * np.cos(azimuth), 0.3 * radius * np.sin(azimuth)
    return np.column_stack((math.cos(0.4) * p - math.sin(0.4) * q, math.sin(0.4) * p + math.cos(0.4) * q))


def _scatter(variables: Vector) -> Vector:
    """A A^T from the logarithms of the diagonal of its Cholesky factor, and the element below it."""
    factor = np.array([[math.exp(variables[0]), 0.0], [variables[2], math.exp(variables[1])]])
    return np.asarray(factor @ factor.T)


def _beckmann(variables: Vector, slopes: Vector) -> float:
    return float(np.mean(stats.multivariate_normal(np.zeros(2), _scatter(variables) / 2).logpdf(slopes)))


def _student_t(variables: Vector, slopes: Vector, gamma: float | None = None) -> float:
    gamma = 1.5 + math.exp(variables[3]) if gamma is None else gamma
    return float(
        np.mean(stats.multivariate_t(np.zeros(2), _scatter(variables) / 2, 2 * gamma - 2).logpdf(slopes))
    )


def _ggx(variables: Vector, slopes: Vector) -> float:
    return _student_t(variables, slopes, 2.0)


def _bessel_k(variables: Vector, slopes: Vector, a: float | None = None) -> float:
    a = math.exp(variables[3]) if a is None else a
    scatter = _scatter(variables)
    r = np.sqrt(np.einsum("ij,jk,ik->i", slopes, np.linalg.inv(scatter), slopes))
    logs = math.log(2 / math.pi) - special.gammaln(a) + (a - 1) * np.log(r)
    logs += np.log(special.kve(a - 1, 2 * r)) - 2 * r - 0.5 * math.log(np.linalg.det(scatter))
    return float(np.mean(logs))


def _k0(variables: Vector, slopes: Vector) -> float:
    return _bessel_k(variables, slopes, 1.0)


def _gtr(variables: Vector, slopes: Vector) -> float:
    alpha, gamma = math.exp(variables[0]), math.exp(variables[1])
    r2 = slopes[:, 0] ** 2 + slopes[:, 1] ** 2
    constant = (1 - gamma) * (1 - alpha**2) / (math.pi * (1 - alpha ** (2 - 2 * gamma)))
    logs = math.log(constant) + (gamma - 2) * np.log1p(r2) - gamma * np.log(r2 + alpha**2)
    return float(np.mean(logs))


LIKELIHOODS: dict[str, tuple[Likelihood, list[float]]] = {
    "beckmann": (_beckmann, []),
    "ggx": (_ggx, []),
    "gtr": (_gtr, []),
    "student_t": (_student_t, [0.5]),
    "k0": (_k0, []),
    "bessel_k": (_bessel_k, [0.5]),
}


def scipy_fit(name: str, slopes: Vector) -> Any:
    """L-BFGS-B on SciPy's densities, gradients by its differences."""
    density, shape = LIKELIHOODS[name]
    centred = slopes - np.median(slopes, axis=0)
    if name == "gtr":
        start = [math.log(float(np.median(np.hypot(*centred.T)))), math.log(2.5)]
    else:
        factor = np.linalg.cholesky(2 * np.cov(centred.T))
        start = [math.log(factor[0, 0]), math.log(factor[1, 1]), factor[1, 0], *shape]
    return minimize(
        lambda variables: -density(variables, centred),
        np.array(start),
        method="L-BFGS-B",
        options={"gtol": 1e-5, "ftol": 1e-12},
    )


@click.command()
@click.option("--slopes", "n", type=click.IntRange(1000), default=1_000_000, show_default=True)
@click.option("--family", "names", multiple=True, type=click.Choice(list(LIKELIHOODS)))
def main(n: int, names: tuple[str, ...]) -> None:
    """Seconds per family, and of all together."""
    slopes = sample(n)
    mf.fit(slopes[:1000])  # imports and tables
    table = Table("family", "microfacet", "SciPy", "ratio", "log-likelihood, ours", "SciPy's", "evaluations")
    totals = np.zeros(2)
    for name in names or LIKELIHOODS:
        begin = time.perf_counter()
        axes = "isotropic" if name == "gtr" else "anisotropic"  # as SciPy's side
        (ours,) = mf.fit(slopes, name, max_slopes=None, symmetry=axes)
        middle = time.perf_counter()
        theirs = scipy_fit(name, slopes)
        seconds = np.array([middle - begin, time.perf_counter() - middle])
        totals += seconds
        table.add_row(
            name,
            f"{seconds[0]:.2f} s",
            f"{seconds[1]:.2f} s",
            f"{seconds[1] / seconds[0]:.1f}",
            f"{ours.log_likelihood_per_sample:.8f}",
            f"{-theirs.fun:.8f}",
            str(theirs.nfev),
        )
    table.add_row(
        "sum", f"{totals[0]:.2f} s", f"{totals[1]:.2f} s", f"{totals[1] / totals[0]:.1f}", "", "", ""
    )
    Console(width=110).print(f"{n} slopes", table)


if __name__ == "__main__":
    main()
