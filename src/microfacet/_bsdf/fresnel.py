"""Fresnel's equations at a smooth interface, for unpolarised light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet import _core
from microfacet._arrays import as_array, lifted

__all__ = ["fresnel_average", "fresnel_conductor", "fresnel_dielectric"]


def fresnel_dielectric(cosine: ArrayLike, eta: ArrayLike, *, out: Any = None, where: Any = True) -> Any:
    r"""Reflectance of a smooth dielectric.

    .. math:: F = \frac{r_s^2 + r_p^2}{2},\quad r_s = \frac{c - \eta c_t}{c + \eta c_t},\quad
              r_p = \frac{\eta c - c_t}{\eta c + c_t},\quad \eta^2 (1 - c_t^2) = 1 - c^2

    Parameters
    ----------
    cosine : array_like
        Cosine c between the direction and the normal, in [-1, 1] or up to 8 ulp beyond, which is 1; its
        sign does not matter.
    eta : array_like
        Index of refraction behind the interface over that in front of it, in (0, inf).
    out, where
        As in every ufunc.

    Returns
    -------
    ndarray or scalar
        In [0, 1]; 1 beyond the critical angle, exactly 0 for eta = 1 but at grazing incidence; nan where an
        argument lies outside its domain.

    References
    ----------
    M. Born and E. Wolf, Principles of Optics, section 1.5.

    Examples
    --------
    >>> import microfacet as mf
    >>> print(f"{mf.fresnel_dielectric(1.0, 1.5):.4f} {mf.fresnel_dielectric(0.1, 1 / 1.5):.4f}")
    0.0400 1.0000
    """
    return _core.fresnel_dielectric(cosine, eta, out=out, where=where)


def fresnel_conductor(
    cosine: ArrayLike, eta: ArrayLike, k: ArrayLike, *, out: Any = None, where: Any = True
) -> Any:
    """Reflectance of a smooth metal with the index of refraction eta - i k.

    Parameters
    ----------
    cosine : array_like
        Cosine between the direction and the normal, in [-1, 1] or up to 8 ulp beyond, which is 1; its
        sign does not matter.
    eta, k : array_like
        Real and imaginary part of the metal's index of refraction over that of the medium in front of it, eta
        in (0, inf], k in [0, inf); eta = inf is a perfect mirror. Arrays of wavelengths broadcast.
    out, where
        As in every ufunc.

    Returns
    -------
    ndarray or scalar
        In [0, 1]; nan where an argument lies outside its domain.

    References
    ----------
    M. Born and E. Wolf, Principles of Optics, section 14.4.1.

    Examples
    --------
    >>> import microfacet as mf
    >>> print(mf.fresnel_conductor(1.0, [0.18, 0.42, 1.37], [3.42, 2.35, 1.77]).round(2))  # gold
    [0.94 0.78 0.37]
    """
    return _core.fresnel_conductor(cosine, eta, k, out=out, where=where)


def fresnel_average(eta: ArrayLike, k: ArrayLike | None = None) -> Any:
    r"""Reflectance under light from all sides, :math:`2 \int_0^1 F(c)\, c\, dc`.

    Parameters
    ----------
    eta : array_like
        As for `fresnel_conductor`, or for `fresnel_dielectric` where `k` is not given.
    k : array_like, optional
        Imaginary part, for a metal.

    Returns
    -------
    ndarray or scalar
        To 1e-9 for eta >= 0.1.

    Examples
    --------
    >>> import microfacet as mf
    >>> print(f"{mf.fresnel_average(1.5):.6f}")
    0.091778
    """
    given = (eta,) if k is None else (eta, k)
    return lifted(_average, *((as_array(constant), "") for constant in given))


def _average(eta: NDArray[Any], k: NDArray[Any] | None = None) -> Any:
    indices = np.asarray(eta, dtype=np.float64)[..., np.newaxis]
    absorbed = np.asarray(0.0 if k is None else k, dtype=np.float64)[..., np.newaxis]
    # At the critical angle there is a square root, or nearly so: pieces end there, in variables without it.
    with np.errstate(invalid="ignore"):  # inf - inf
        critical = np.sqrt(np.clip(1 - (indices - absorbed) * (indices + absorbed), 0.0, 1.0))
    nodes, weights = np.polynomial.legendre.leggauss(128)
    t, weights = (nodes + 1) / 2, weights / 2
    total = 0.0
    for width in (-critical, 1 - critical):
        cosine = critical + width * t**2
        one = (
            fresnel_dielectric(cosine, indices) if k is None else fresnel_conductor(cosine, indices, absorbed)
        )
        total = total + np.sum(2 * one * cosine * np.abs(2 * width * t) * weights, axis=-1)
    return np.minimum(total, 1.0)[()]
