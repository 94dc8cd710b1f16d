"""A density of slopes of the user's own, with everything that follows from it.

Python checks what it is given and says where it may be asked; the compiled core integrates it and keeps
tables of the results, which the kernels of all families' directions then read.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._core import prepared, radial
from microfacet._densities.constructors import Constructors
from microfacet._frozen import StretchedDistribution

__all__ = ["RadialNDF"]

Array = NDArray[np.float64]
Function = Callable[[Any], Any]

# log r where a density is looked at: slopes below and above decide nothing in double precision. Densely where
# a ring may lie.
_LOG_SLOPES = np.unique(np.concatenate((np.arange(-690.0, 85.5, 0.5), np.arange(-1600, 1601) / 128)))
_TINY, _HUGE = 1e-290, 1e290


def _sampled(name: str, samples: tuple[ArrayLike, ArrayLike]) -> Function:
    """Samples (r, values) as a function: monotone cubic in log-log, power laws beyond both ends."""
    from scipy.interpolate import PchipInterpolator

    r, values = (np.asarray(part, dtype=np.float64) for part in samples)
    if r.ndim != 1 or r.shape != values.shape or len(r) < 8:
        raise ValueError(
            f"RadialNDF: {name} as samples must be two 1-D arrays (r, values) of one length, 8 at least; "
            f"got shapes {r.shape} and {values.shape}"
        )
    if not (np.all(np.isfinite(r)) and r[0] > 0.0 and np.all(np.diff(r) > 0.0)):
        raise ValueError(
            f"RadialNDF: the slopes r of {name} must be finite, positive and strictly increasing"
        )
    if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
        raise ValueError(f"RadialNDF: the values of {name} must be finite and positive")
    x = np.log(r)
    inside = PchipInterpolator(x, np.log(values))
    ends = inside.derivative()([x[0], x[-1]])

    def function(slopes: Array) -> Any:
        at = np.log(slopes)
        low, high = np.minimum(at - x[0], 0.0), np.maximum(at - x[-1], 0.0)
        return np.exp(inside(np.clip(at, x[0], x[-1])) + ends[0] * low + ends[1] * high)

    return function


def _values(name: str, function: Function, log_r: Array) -> Array:
    """The user's function at slopes exp(log_r), as float64 of the same shape."""
    with np.errstate(all="ignore"):
        r = np.exp(log_r)
        values = np.asarray(function(r))
    if values.shape != r.shape or values.dtype.kind not in "fiub":
        raise ValueError(
            f"RadialNDF: {name} must return real numbers of the shape of its argument {r.shape}, "
            f"got {values.dtype} of shape {values.shape}"
        )
    return values.astype(np.float64)


def _refuse(name: str, log_r: Array, values: Array, bad: NDArray[np.bool_]) -> None:
    if np.any(bad):
        i = int(np.argmax(bad))
        raise ValueError(
            f"RadialNDF: {name} must be finite and not negative, "
            f"got {values[i]:g} at r = {np.exp(log_r[i]):g}"
        )


class _Density:
    """A positive function of log r where it can be used, checked, with its ends."""

    def __init__(self, name: str, function: Function) -> None:
        self.name, self.function = name, function
        x, values = _LOG_SLOPES, _values(name, function, _LOG_SLOPES)
        _refuse(name, x, values, values < 0.0)
        usable = (values > _TINY) & (values < _HUGE)
        if not np.any(usable):
            raise ValueError(f"RadialNDF: {name} is nowhere positive and finite")
        mass = np.where(usable, np.log(np.where(usable, values, 1.0)) + 2.0 * x, -np.inf)
        peak = int(np.argmax(mass))
        first, last = peak, peak
        while first > 0 and usable[first - 1]:
            first -= 1
        while last + 1 < len(x) and usable[last + 1]:
            last += 1
        # A value that is not finite is an error, unless the density has ended there.
        matters = ~np.isfinite(values) & (np.abs(np.arange(len(x)) - peak) <= 1)
        for edge, beyond in ((first, first - 1), (last, last + 1)):
            if 0 <= beyond < len(x) and mass[edge] > mass[peak] - 40.0:
                matters[beyond] |= not np.isfinite(values[beyond])
        _refuse(name, x, values, matters)
        self.lower, self.upper = float(x[first]), float(x[-1])
        self.end = self.upper if last + 1 == len(x) else float(x[last + 1])
        self.last = float(x[last])
        logs = np.log(values[first : last + 1])
        self.low_power = float((logs[2] - logs[0]) / (x[first + 2] - x[first])) if len(logs) > 2 else 0.0
        self.high_power = float(logs[-1] - logs[-3]) if last + 1 == len(x) else -np.inf
        self.first = float(values[first])

    def __call__(self, log_r: Array) -> Array:
        values = _values(self.name, self.function, log_r)
        near = log_r < self.last
        _refuse(self.name, log_r, values, near & ~(values >= 0.0) | near & np.isinf(values) | (values < 0.0))
        return np.where(np.isfinite(values), values, 0.0)

    def at_zero(self) -> float:
        """The limit at r = 0: what the function says, or what its power there does."""
        try:
            with np.errstate(all="ignore"):
                value = float(np.asarray(self.function(np.zeros(1)))[0])
        except (ArithmeticError, ValueError, IndexError, TypeError):
            value = np.nan
        if value >= 0.0:
            return value
        return np.inf if self.low_power < -1e-9 else 0.0 if self.low_power > 1e-9 else self.first


def _same(density: _Density, survival: _Density, norm: float) -> None:
    """Refuse a survival function whose slope is not the density."""
    x = np.linspace(-30.0, 30.0, 1201)
    step = 1e-3
    above = survival(x)
    inside = (above > 0.05) & (above < 0.95)
    x = x[inside]
    slope = (survival(x - step) - survival(x + step)) / (2.0 * step)
    expected = 2.0 * np.pi * np.exp(2.0 * x) * density(x) / norm
    if not np.any(inside) or np.max(np.abs(slope - expected)) > 1e-3 * np.max(expected):
        raise ValueError(
            "RadialNDF: survival must be Pr(slope > r) of P22: its derivative is not -2 pi r P22"
        )


class _Kernels:
    """The kernels that read the tables of a density."""

    def __get__(self, ndf: RadialNDF | None, owner: type) -> Any:
        return prepared if getattr(ndf, "_prepared", False) else radial


class RadialNDF(Constructors, StretchedDistribution):
    """Slopes with a radial density of your own, which need not be normalised, and all that follows from it.

    Parameters
    ----------
    P22 : callable or (r, values)
        Joint density of slopes at alpha = 1 as a function of r = sqrt(p^2 + q^2), up to a factor: a function
        of float64 arrays that returns arrays, positive up to where it ends; or samples of it, 8 at least, at
        increasing r > 0, which a monotone cubic joins in log-log and power laws continue. It may be
        integrably singular at 0 and have any integrable tail.
    survival : callable or (r, values), optional
        Probability of a slope above r, if you know it more accurately than an integral of P22 gives it.
    alpha : float
        Isotropic roughness, in (1e-101, 1e101), by default 1; or give both of
    alpha_x, alpha_y : float
        Roughness along the two axes, in (1e-101, 1e101).
    rotation : float
        Angle of the first axis from +x (radians, counter-clockwise).

    Attributes
    ----------
    norm : float
        The integral of P22 over the plane, by which it is divided.
    error : float
        Largest relative error found between the tables and the quadrature that they stand for, where results
        lie within a factor exp(50) of 1.

    Raises
    ------
    ValueError
        If P22 is negative, not finite or not integrable, or returns anything but an array of the shape
        of its argument. What P22 itself raises comes through.

    Notes
    -----
    Where the mean slope is infinite (a tail not below r^-3), sigma and what needs it is nan. The functions
    are called during construction only, which takes some tenths of a second; distributions pickle by their
    tables. sigma, Lambda and G1 follow from the density of slopes as in E. Heitz, Understanding the
    masking-shadowing function in microfacet-based BRDFs, 2014.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
    >>> print(f"{ndf.norm:.6g} {ndf.Lambda([0.96, 0.0, 0.28]):.6g}")  # the first is pi^(3/2)/2
    2.78416 0.00361756
    """

    __slots__ = ("_capsule", "_digest", "_handle", "_prepared", "error", "norm")
    kernels = _Kernels()
    norm: float
    error: float
    _handle: float
    _digest: bytes
    _prepared: bool

    def __init__(
        self,
        P22: Function | tuple[ArrayLike, ArrayLike],
        survival: Function | tuple[ArrayLike, ArrayLike] | None = None,
        alpha: float | None = None,
        *,
        alpha_x: float | None = None,
        alpha_y: float | None = None,
        rotation: float = 0.0,
    ) -> None:
        self._set(1.0 if alpha is None and alpha_x is None else alpha, alpha_x, alpha_y, rotation)
        density = _Density("P22", P22 if callable(P22) else _sampled("P22", _pair("P22", P22)))
        if density.low_power < -2.0 + 1e-6 or density.high_power > -2.0 - 1e-6:
            end = "0" if density.low_power < -2.0 + 1e-6 else "infinity"
            raise ValueError(f"RadialNDF: P22 must be integrable over the plane; r P22 is not towards {end}")
        above = None
        if survival is not None:
            known = survival if callable(survival) else _sampled("survival", _pair("survival", survival))
            above = _Density("survival", known)
        table, norm, error = radial.build(density, density.lower, density.upper, density.at_zero(), above)
        if table is None:
            raise ValueError(f"RadialNDF: P22 must be integrable over the plane, its integral is {norm:g}")
        if above is not None:
            _same(density, above, norm)
        self._keep(table, norm, error)

    def _keep(self, table: tuple[Any, float, bool], norm: float, error: float) -> None:
        digest = hashlib.sha256(radial.dump(table[1])).digest()
        names = ("_capsule", "_handle", "_prepared", "norm", "error", "_digest")
        for name, value in zip(names, (*table, norm, error, digest), strict=True):
            object.__setattr__(self, name, value)

    @property
    def _arguments(self) -> tuple[float, ...]:
        return (*self._values, self._handle)

    @property
    def _identity(self) -> str:
        return self._digest.hex()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._values == other._values and self._digest == other._digest

    def __hash__(self) -> int:
        return hash((self._values, self._digest))

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"<RadialNDF {self._digest.hex()[:8]}: {inside}, error={self.error:.1e}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), self._values, radial.dump(self._handle), self.norm, self.error)


def _pair(name: str, samples: object) -> tuple[ArrayLike, ArrayLike]:
    if isinstance(samples, tuple | list) and len(samples) == 2:
        return samples[0], samples[1]
    raise ValueError(
        f"RadialNDF: {name} must be a callable or samples (r, values), got {type(samples).__name__}"
    )


def _restore(
    cls: type[RadialNDF], values: tuple[float, ...], table: bytes, norm: float, error: float
) -> RadialNDF:
    new = cls.__new__(cls)
    new._freeze(values)
    new._keep(radial.load(table), norm, error)
    return new
