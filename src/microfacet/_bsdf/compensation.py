"""What renderers add to single scattering, in place of the walk, so that no energy is lost.

Both lobes need only the albedo E of a white metal, a function of one angle. docs/compensation.md measures
them against the walk.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._arrays import lifted
from microfacet._bsdf.arguments import directions_of, uniforms_of
from microfacet._bsdf.conductor import Conductor
from microfacet._bsdf.fresnel import fresnel_average, fresnel_conductor
from microfacet._calls import constructor
from microfacet._frozen import Distribution
from microfacet._value import Value

__all__ = ["KullaConty", "Turquin"]

Array = NDArray[Any]

_NODES = 48


class _Energy(Value):
    """The albedo E(cos theta) of a white metal of this roughness, and its average."""

    __slots__ = ("_coefficients", "_knots", "average")

    average: float
    _knots: Array
    _coefficients: Array

    def __init__(self, cosine: Array, albedo: Array, average: float) -> None:
        from scipy.interpolate import PchipInterpolator

        # Near the horizon E changes over angles like the roughness: the cube root spreads them.
        spline = PchipInterpolator(np.cbrt(cosine), albedo)
        self._keep(_knots=spline.x, _coefficients=spline.c, average=average)

    def __call__(self, cosine: Array) -> Array:
        from scipy.interpolate import PPoly

        spline = PPoly.construct_fast(self._coefficients, self._knots)
        inside = np.clip(np.cbrt(np.maximum(cosine, 0.0)), self._knots[0], self._knots[-1])
        return np.asarray(spline(inside))

    @classmethod
    @lru_cache(maxsize=64)
    def of(cls, ndf: Distribution) -> _Energy:
        """Integrate it."""
        cosine = ((np.arange(_NODES) + 0.5) / _NODES) ** 3
        cosine[-1] = 1.0
        wi = np.stack((np.sqrt(1 - cosine**2), np.zeros(_NODES), cosine), -1)
        white = Conductor(ndf)
        return cls(cosine, white.albedo(wi), float(white.average_albedo()))

    @classmethod
    def from_table(cls, owner: str, ndf: Distribution, table: Any) -> _Energy:
        """Interpolate it in a table of `microfacet.bake`."""
        if table.attrs.get("kind") != "energy" or table.attrs.get("material") != "conductor":
            raise ValueError(f'{owner}: table must come from bake("energy", ...) of a white conductor')
        if table.attrs.get("density", table.attrs["family"]) != ndf._identity:
            raise ValueError(
                f"{owner}: the table is of {table.attrs['family']}, the material of "
                f"{ndf.family if ndf.family == ndf._identity else 'another density'}"
            )
        at = _parameters(ndf)
        for name, value in at.items():
            entries = table[name].values
            if not entries.min() <= value <= entries.max():
                raise ValueError(
                    f"{owner}: the table has {name} in [{entries.min():g}, {entries.max():g}], got {value:g}"
                )
        several = {name: value for name, value in at.items() if table.sizes[name] > 1}
        single = {name: 0 for name in at if name not in several}
        here = table[["missing", "missing_average"]].isel(single).interp(several)
        return cls(table["cos_theta"].values, 1 - here["missing"].values, 1 - float(here["missing_average"]))


def _parameters(ndf: Distribution) -> dict[str, float]:
    """alpha and the shape parameter by name."""
    values = dict(ndf.parameters)
    if "alpha_x" in values:
        shape = {name: v for name, v in values.items() if name not in ("alpha_x", "alpha_y", "rotation")}
        values = {"alpha": values["alpha_x"], **shape}
    return values


class _Compensated(Value):
    """A metal with single scattering, to which a subclass adds the lost energy."""

    __slots__ = ("_energy", "material")

    material: Conductor
    _energy: _Energy

    @constructor
    def __init__(self, material: Conductor, table: Any = None) -> None:
        owner = type(self).__name__
        if not isinstance(material, Conductor) or material.scattering != "single":
            raise ValueError(f"{owner}: material must be a Conductor of single scattering, got {material!r}")
        ndf = material.ndf
        if hasattr(ndf, "mean_normal") or ("alpha_x" in ndf._names and ndf._values[0] != ndf._values[1]):
            raise ValueError(f"{owner}: the roughness must be isotropic, got {ndf!r}")
        energy = _Energy.of(ndf) if table is None else _Energy.from_table(owner, ndf, table)
        self._keep(material=material, _energy=energy)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.material!r})"

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> Any:
        """f |cos theta_o|, shape (..., *channels), as `Conductor.eval`."""
        return lifted(self._eval, *directions_of(self, "eval", wi=wi, wo=wo))

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Any:
        """Density per steradian of the directions that `sample` draws."""
        return lifted(self._pdf, *directions_of(self, "pdf", wi=wi, wo=wo))

    def sample(self, wi: ArrayLike, xi: ArrayLike) -> tuple[Any, Any, Any]:
        """Directions, weights and densities; xi (..., `sample_dims`), the last of which chooses the lobe."""
        given = (*directions_of(self, "sample", wi=wi), uniforms_of(self, "sample", xi, self.sample_dims))
        wo, weight, pdf = lifted(self._sample, *given, results=("w", "", ""))
        return wo, weight, pdf

    def albedo(self, wi: ArrayLike) -> Any:
        """Part of the light from `wi` that leaves again."""
        return lifted(self._albedo, *directions_of(self, "albedo", wi=wi))

    @property
    def sample_dims(self) -> int:
        """How many uniform numbers a sample takes."""
        return self.material.sample_dims

    def _behind(self, values: Array) -> Array:
        """Append axes for the channels of the metal."""
        return values[(..., *(np.newaxis,) * len(self.material._channels))]

    def _cosines(self, *directions: Array) -> list[Array]:
        """Cosines of the directions, normalised, with axes for the channels."""
        return [self._behind(w[..., 2].astype(np.float64)) for w in self.material._units(*directions)]

    def _eval(self, wi: Array, wo: Array) -> Any:
        raise NotImplementedError

    def _pdf(self, wi: Array, wo: Array) -> Any:
        raise NotImplementedError

    def _sample(self, wi: Array, xi: Array) -> tuple[Any, Any, Any]:
        raise NotImplementedError

    def _albedo(self, wi: Array) -> Any:
        raise NotImplementedError


class KullaConty(_Compensated):
    r"""Single scattering and a diffuse lobe that carries what is missing.

    .. math:: f = f_1 + \frac{\bar F^2 \bar E}{1 - \bar F (1 - \bar E)}\,
              \frac{(1 - E(\omega_i))(1 - E(\omega_o))}{\pi (1 - \bar E)}

    Parameters
    ----------
    material : Conductor
        Of single scattering and isotropic roughness.
    table : xarray.Dataset, optional
        Of ``microfacet.bake("energy", ...)``, between whose entries E is interpolated; without it E is
        integrated for this roughness.

    Raises
    ------
    ValueError
        If the material is another one, or lies outside the table.

    Notes
    -----
    Reciprocal. A white metal reflects all light; of a coloured one the colour is an estimate. The lobe knows
    no direction: see docs/compensation.md for how far it is from the walk.
    Directions may have any length but 0, as for `Conductor`.

    References
    ----------
    C. Kulla and A. Conty, Revisiting physically based shading at Imageworks, SIGGRAPH 2017 course.

    Examples
    --------
    >>> import microfacet as mf
    >>> white = mf.KullaConty(mf.Conductor(mf.GGX(alpha=1.0)))
    >>> print(f"{white.albedo([0.6, 0, 0.8]):.4f} {white.material.albedo([0.6, 0, 0.8]):.4f}")
    1.0000 0.3513
    """

    __slots__ = ()

    def _colour(self) -> Any:
        fresnel, average = fresnel_average(self.material.eta, self.material.k), self._energy.average
        return fresnel**2 * average / (1 - fresnel * (1 - average))

    def _eval(self, wi: Array, wo: Array) -> Any:
        i, o = self._cosines(wi, wo)
        lobe = (1 - self._energy(i)) * (1 - self._energy(o)) / (np.pi * max(1 - self._energy.average, 1e-12))
        lit = np.where((i > 0) & (o > 0), o, 0.0)
        return self.material.eval(wi, wo) + self._colour() * lobe * lit

    def _pdf(self, wi: Array, wo: Array) -> Any:
        i, o = (w[..., 2].astype(np.float64) for w in self.material._units(wi, wo))
        first = self._energy(i)
        diffuse = np.where(i > 0, np.maximum(o, 0.0), 0.0) / np.pi
        return first * self.material.pdf(wi, wo) + (1 - first) * diffuse

    def _sample(self, wi: Array, xi: Array) -> tuple[Any, Any, Any]:
        (given,), numbers = self.material._units(wi.astype(np.float64)), xi.astype(np.float64)
        once, _, _ = self.material.sample(given, numbers[..., :-1])
        radius, turn = np.sqrt(numbers[..., 0]), 2 * np.pi * numbers[..., 1]
        height = np.sqrt(1 - numbers[..., 0])
        diffuse = np.stack((radius * np.cos(turn), radius * np.sin(turn), height), -1)
        single = numbers[..., -1] < self._energy(given[..., 2])
        wo = np.where(single[..., np.newaxis], once, diffuse + 0 * given[..., 2:])  # nan for nan
        density = self._pdf(given, wo)
        behind = self._behind(np.asarray(density))
        with np.errstate(all="ignore"):
            weight = np.where(behind > 0, self._eval(given, wo) / behind, 0 * behind)
        return wo, weight, density

    @property
    def sample_dims(self) -> int:
        """How many uniform numbers a sample takes."""
        return self.material.sample_dims + 1

    def _albedo(self, wi: Array) -> Any:
        (i,) = self._cosines(wi)
        return self.material.albedo(wi) + np.where(i > 0, self._colour() * (1 - self._energy(i)), 0.0)


class Turquin(_Compensated):
    r"""Single scattering, scaled by what is missing for the direction given.

    .. math:: f = f_1 \left(1 + F_0\, \frac{1 - E(\omega_i)}{E(\omega_i)}\right)

    with the reflectance F_0 at normal incidence. All of `Conductor`'s sampling stays as it is.

    Parameters
    ----------
    material : Conductor
        Of single scattering and isotropic roughness.
    table : xarray.Dataset, optional
        As for `KullaConty`.

    Raises
    ------
    ValueError
        If the material is another one, or lies outside the table.

    Notes
    -----
    Not reciprocal. A white metal reflects all light, but into the lobe of the first order, where the walk
    spreads it. Directions may have any length but 0, as for `Conductor`.

    References
    ----------
    E. Turquin, Practical multiple scattering compensation for microfacet models, 2019.

    Examples
    --------
    >>> import microfacet as mf
    >>> white = mf.Turquin(mf.Conductor(mf.GGX(alpha=1.0)))
    >>> print(f"{white.albedo([0.6, 0, 0.8]):.4f}")
    1.0000
    """

    __slots__ = ()

    def _scale(self, wi: Array) -> Any:
        (i,) = self._cosines(wi)
        normal = fresnel_conductor(1.0, self.material.eta, self.material.k)
        first = self._energy(i)
        return 1 + normal * (1 - first) / first

    def _eval(self, wi: Array, wo: Array) -> Any:
        return self.material.eval(wi, wo) * self._scale(wi)

    def _pdf(self, wi: Array, wo: Array) -> Any:
        return self.material.pdf(wi, wo)

    def _sample(self, wi: Array, xi: Array) -> tuple[Any, Any, Any]:
        wo, weight, density = self.material.sample(wi, xi)
        return wo, weight * self._scale(wi), density

    def _albedo(self, wi: Array) -> Any:
        return self.material.albedo(wi) * self._scale(wi)
