"""The families as mixtures of Beckmann surfaces: how the squared roughness is distributed.

A slope of the family is ``stretch sqrt(m) n``, where n has two independent normal components of variance 1/2
and m is independent of it: P22(p, q) = E[exp(-r^2/m)/(pi m)] in standard space. The laws are those of the
checks `*.beckmann_mixture`, `bessel_k.gamma_mixture` and `gtr.ggx_mixture`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special
from scipy.integrate import cumulative_simpson
from scipy.interpolate import PchipInterpolator

from microfacet._surface.checks import SurfaceError
from microfacet._surface.numeric_mixing import numeric_quantile

__all__ = ["gtr_density", "quantile", "stretch"]

Vector = NDArray[np.float64]

_GTR_NODES = 8001  # of the table of GTR's law, in the logarithm of 1/m


def stretch(ndf: Any) -> NDArray[np.float64]:
    """The symmetric matrix from standard slopes to those of the distribution."""
    values = ndf.parameters
    if "alpha_x" not in values:
        return np.eye(2)  # GTR: alpha is in the law of m
    c, s = math.cos(values["rotation"]), math.sin(values["rotation"])
    turn = np.array([[c, -s], [s, c]])
    return np.asarray(turn @ np.diag([values["alpha_x"], values["alpha_y"]]) @ turn.T)


def quantile(ndf: Any) -> Callable[[Vector], Vector] | None:
    """The quantile function of m for probabilities in (0, 1), None where m is 1."""
    family, values = getattr(ndf, "family", None), getattr(ndf, "parameters", {})
    if family == "beckmann":
        return None
    if family in ("ggx", "student_t"):
        excess = values.get("gamma", 2.0) - 1.0  # m = (gamma - 1)/b, b ~ Gamma(gamma - 1)
        return lambda u: np.asarray(excess / special.gammainccinv(excess, u))
    if family in ("k0", "bessel_k"):
        return lambda u: np.asarray(special.gammaincinv(values.get("a", 1.0), u))
    if family == "gtr":
        return _gtr_quantile(values["alpha"], values["gamma"])
    if "alpha_x" in values:
        return numeric_quantile(ndf)
    raise SurfaceError(f"no mixture of Beckmann surfaces is known for {family or type(ndf).__name__}")


def gtr_density(t: Vector, alpha: float, gamma: float) -> Vector:
    """Density of t = 1/m for GTR but for its constant factor: ``exp(-t) 1F1(gamma; 2; (1 - alpha^2) t)``.

    Its Laplace transform at 1 + r^2 is ``(1 + r^2)^(gamma-2) (r^2 + alpha^2)^-gamma``, which is P22
    (DLMF 13.10.3 with b = c = 2). It is positive for alpha <= 1 or gamma <= 2.
    """
    if alpha <= 1:  # Kummer's transformation, so that nothing overflows
        return np.asarray(np.exp(-(alpha**2) * t) * special.hyp1f1(2 - gamma, 2.0, (alpha**2 - 1) * t))
    return np.asarray(np.exp(-t) * special.hyp1f1(gamma, 2.0, (1 - alpha**2) * t))


def _gtr_quantile(alpha: float, gamma: float) -> Callable[[Vector], Vector]:
    if alpha > 1 and gamma > 2:
        raise SurfaceError("gtr is no mixture of Beckmann surfaces where alpha > 1 and gamma > 2")
    log_t = np.linspace(math.log(1e-16), math.log(800 / min(alpha**2, 1.0)), _GTR_NODES)
    density = gtr_density(np.exp(log_t), alpha, gamma) * np.exp(log_t)
    if not np.isfinite(density).all() or not density.max() > 0:
        raise SurfaceError(f"gtr with alpha {alpha:g} and gamma {gamma:g} is beyond double precision")
    share = cumulative_simpson(density, x=log_t, initial=0.0)
    share /= share[-1]
    # the flat ends of the cumulative distribution have no inverse
    rising = np.concatenate(([True], np.diff(np.maximum.accumulate(share)) > 1e-15))
    log_of = PchipInterpolator(share[rising], log_t[rising])
    return lambda u: np.asarray(np.exp(-log_of(1.0 - u)))
