"""The ABC or K-correlation model of a power spectral density, fitted to rings of the frequency plane."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from microfacet._value import Value

__all__ = ["KCorrelation", "fitted"]

_C = (0.05, 30.0)  # the range of C; beyond it the fall is faster than that of any power
_STARTS = [(where, c) for where in (0.05, 0.3, 0.7) for c in (1.0, 3.0, 8.0)]
_MANY = 50  # coefficients: a ring that has so many is full, and the model is averaged over it
_NODES, _WEIGHTS = leggauss(5)
_SCATTER, _MISFIT = 4.0, 0.2  # of the rings about a model that is said not to fit
_UNDETERMINED = 1.0  # standard error of ln B
_FEWEST = 6  # rings, for three parameters

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class KCorrelation(Value):
    r"""The ABC (K-correlation) model of a power spectral density.

    .. math:: S(f) = \frac{A}{(1 + (B f)^2)^{(C + 1)/2}}

    A (m^4) is the plateau at low frequencies, B (m) is the inverse of the frequency where it ends (B/(2 pi)
    is called the correlation length) and the density falls as f^-(C + 1), that of a profile as f^-C.

    Attributes
    ----------
    A, B, C : float
        The parameters; nan where there are too few rings.
    errors : dict of str to float
        Standard errors of ``A``, ``B``, ``C``: from the information of a Gaussian surface, times the scatter
        of the rings about the model where that is larger; nan where a parameter is undetermined.
    misfit : float
        Root mean square of ln(measured/model) over the rings: 0.05 is five per cent.
    low, high : float
        Frequencies between which it was fitted, in cycles per metre.
    notes : tuple of str
        Says when the model does not describe the map.
    """

    A: float
    B: float
    C: float
    errors: dict[str, float]
    misfit: float
    low: float
    high: float
    notes: tuple[str, ...]

    def psd(self, frequencies: ArrayLike) -> Vector:
        """The model's density in m^4 at these frequencies in cycles per metre.

        Examples
        --------
        >>> import microfacet as mf
        >>> model = mf.KCorrelation(1e-24, 1e-5, 3.0, {}, 0.0, 1e3, 1e5, ())
        >>> [f"{density:.3g}" for density in model.psd([0.0, 1e5])]
        ['1e-24', '2.5e-25']
        """
        return _density(np.asarray(frequencies, dtype=np.float64), math.log(self.A), math.log(self.B), self.C)

    @property
    def Sq(self) -> float:
        """The root mean square height of the model over all frequencies, in metres; infinite for C <= 1."""
        return math.sqrt(2 * math.pi * self.A / (self.C - 1)) / self.B if self.C > 1 else math.inf

    def as_dict(self) -> dict[str, Any]:
        """As a record of numbers, in units of the metre."""
        return self._record()


def _density(f: Vector, log_a: float, log_b: float, c: float) -> Vector:
    return np.asarray(np.exp(log_a - (c + 1) / 2 * np.log1p((math.exp(log_b) * f) ** 2)))


def fitted(frequencies: Vector, psd: Vector, weights: Vector, edges: Vector, lowest: float) -> KCorrelation:
    """The most likely model, each ring being the mean of `weights` independent squared Gaussian coefficients.

    Whittle's likelihood: twice the deviance of a ring is its squared residual. Frequencies below `lowest` are
    left out.
    """
    use = (frequencies >= lowest) & (psd > 0)
    f, measured, weight, edges = frequencies[use], psd[use], weights[use], edges[:, use]
    if f.size < _FEWEST:
        nan = math.nan
        missing = ("the map is too small for a fit of the ABC model",)
        return KCorrelation(nan, nan, nan, dict.fromkeys("ABC", nan), nan, nan, nan, missing)
    unit = float(np.max(measured))
    ratio = measured / unit
    log_measured = np.log(ratio)
    nodes = (edges[0] + edges[1]) / 2 + _NODES[:, np.newaxis] * (edges[1] - edges[0]) / 2
    full = weight >= _MANY

    def log_model(at: Vector) -> Vector:
        log_mean = np.log(_density(f, *at))
        share = _WEIGHTS @ (_density(nodes[:, full], *at) * nodes[:, full]) / (_WEIGHTS @ nodes[:, full])
        log_mean[full] = np.log(share)
        return np.asarray(log_mean)

    def residuals(at: Vector) -> Vector:
        t = log_measured - log_model(at)
        return np.asarray(np.sign(t) * np.sqrt(2 * weight * np.maximum(np.expm1(t) - t, 0.0)))

    bounds = ([-200.0, -math.log(100 * f[-1]), _C[0]], [200.0, math.log(100 / f[0]), _C[1]])
    best: Any = None
    for where, c in _STARTS:
        b = -math.log(f[0] * (f[-1] / f[0]) ** where)
        start = [math.log(float(np.mean(ratio[: max(1, f.size // 5)]))), b, c]
        found = least_squares(residuals, start, bounds=bounds, x_scale=(1.0, 1.0, 1.0), max_nfev=200)
        best = found if best is None or found.cost < best.cost else best
    return _result(best.x, log_model, log_measured, weight, unit, f, bounds)


def _result(
    at: Vector, log_model: Any, log_measured: Vector, weight: Vector, unit: float, f: Vector, bounds: Any
) -> KCorrelation:
    t = log_measured - log_model(at)
    step = 1e-5
    jacobian = np.stack(
        [(log_model(at + step * e) - log_model(at - step * e)) / (2 * step) for e in np.eye(3)]
    )
    information = jacobian * weight @ jacobian.T
    scatter = float(np.sum(weight * np.expm1(t) ** 2)) / (f.size - 3)
    at_end = [not low + 1e-3 < value < high - 1e-3 for value, low, high in zip(at, *bounds, strict=True)]
    deviations = _deviations(information, np.array([True, not at_end[1], True])) * math.sqrt(
        max(scatter, 1.0)
    )
    notes = []
    if at_end[2]:
        notes.append(
            "the spectrum falls faster than any power of the frequency, so the ABC model does not fit"
        )
        deviations[:] = math.nan
    elif at_end[1] or not deviations[1] < _UNDETERMINED:
        notes.append(
            "no plateau or no fall lies inside the spectrum: A and B of the ABC model are undetermined"
        )
        deviations[:2] = math.nan
    a, b, c = unit * math.exp(at[0]), math.exp(at[1]), float(at[2])
    errors = deviations * np.array([a, b, 1.0])
    misfit = math.sqrt(float(np.mean(t * t)))
    if scatter > _SCATTER and misfit > _MISFIT and not at_end[2]:
        notes.append(f"the ABC model misses the spectrum by a factor of {math.exp(misfit):.2g} on average")
    named = {name: float(error) for name, error in zip("ABC", errors, strict=True)}
    return KCorrelation(a, b, c, named, misfit, float(f[0]), float(f[-1]), tuple(notes))


def _deviations(information: Vector, free: NDArray[np.bool_]) -> Vector:
    """Standard deviations of the parameters that are free, nan of the others."""
    result = np.full(3, math.nan)
    with suppress(np.linalg.LinAlgError):
        result[free] = np.sqrt(np.diag(np.linalg.inv(information[np.ix_(free, free)])))
    return result
