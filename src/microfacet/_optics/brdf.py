"""`brdf_table`: the BRDF that a family of microfacets predicts, at given angles and wavelengths."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._optics import abg, grid
from microfacet._optics.compute import BATCHES, Progress, Surface, predicted
from microfacet._optics.index import Complex, Index, index_at, wavelengths_of
from microfacet._value import Value

__all__ = ["BrdfTable", "brdf_table"]

Array = NDArray[np.float64]

_THETA_I = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
_POLAR = {
    "normal": tuple(range(0, 90, 5)),
    "specular": (0, 0.5, 1, 2, 3, 5, 7, 10, *range(15, 95, 5), *range(100, 190, 10)),
}
_AZIMUTH = {
    "normal": tuple(range(0, 360, 15)),
    "specular": tuple(range(0, 370, 10)),
    "half": tuple(range(0, 190, 10)),  # where the other half is its mirror image
}


@dataclass(frozen=True, eq=False)
class BrdfTable(Value):
    """A BRDF at angles and wavelengths. Angles are in degrees, wavelengths in metres, values in 1/sr.

    Attributes
    ----------
    ndf : distribution
        Of the facets.
    index : ndarray of complex
        n + ik of the material under the surface, at each wavelength.
    wavelengths, theta_i, phi_i : ndarray
        Of the light: its direction points away from the surface, to where the light comes from.
    polar, azimuth : ndarray
        Of the scattered light, seen from what `reference` says: "normal", the angle theta_s from the normal
        and the azimuth phi_s from +x, so that specular light has phi_s = phi_i + 180; or "specular", the
        angle from the specular direction and an azimuth about it that is 0 towards the normal. By default
        the second has half a turn where the plane of incidence is a plane of symmetry.
    reference : {"normal", "specular"}
    scatter : {"BRDF", "BTDF"}
        BTDF: light that has passed to the other side, whose theta_s counts from the normal there.
    scattering : {"single", "multiple"}
        One order, or all of them.
    values : ndarray, shape (wavelengths, theta_i, phi_i, azimuth, polar)
        0 for directions on the other side of the surface.
    errors : ndarray
        Standard errors of `values`, of the same shape: those of the orders beyond the first, which are
        estimated by random walks.
    single : ndarray
        The first order alone, in closed form.
    albedo, albedo_error, albedo_single : ndarray, shape (wavelengths, theta_i, phi_i)
        The part of the light that leaves on the side of `scatter` after any number of reflections, its
        standard error, and the part that leaves after one. What all orders lose is absorbed or goes through.
    notes : tuple of str
        What a reader of the numbers should know.
    """

    ndf: Any
    index: Complex
    wavelengths: Array
    theta_i: Array
    phi_i: Array
    polar: Array
    azimuth: Array
    reference: str
    scatter: str
    scattering: str
    values: Array = field(repr=False)
    errors: Array = field(repr=False)
    single: Array = field(repr=False)
    albedo: Array = field(repr=False)
    albedo_error: Array = field(repr=False)
    albedo_single: Array = field(repr=False)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, value in list(vars(self).items()):
            if isinstance(value, np.ndarray):
                own = value.view()
                own.flags.writeable = False
                object.__setattr__(self, name, own)

    def directions(self) -> tuple[Array, Array]:
        """Unit vectors: of the light (theta_i, phi_i, 3), and where it goes (theta_i, phi_i, azimuth, polar,
        3).
        """
        below = self.scatter == "BTDF"
        return grid.directions(
            self.theta_i, self.phi_i, self.azimuth, self.polar, self.reference, below=below
        )

    def abg(self) -> list[abg.AbgFit]:
        """The ABg model fitted to every wavelength and direction of the light; see `AbgFit`."""
        return abg.fit_table(self)

    def save(self, path: str | os.PathLike[str], format: str | None = None) -> list[str]:
        """Write the table; `docs/brdf_tables.md` says what is in each format.

        Parameters
        ----------
        path : path-like
            A file that ends in ``.csv``, ``.nc`` (NetCDF), ``.astm`` (text like that of ASTM E1392), or
            ``.bsdf`` with a `format`. The .bsdf formats hold one wavelength a file: of several, each has a
            file with its wavelength in the name.
        format : {"csv", "netcdf", "astm", "zemax", "lighttools"}, optional
            By default what the ending says.

        Returns
        -------
        list of str
            The files written.
        """
        from microfacet._optics.save import save

        return save(self, path, format)


def brdf_table(
    ndf: Any,
    wavelengths: ArrayLike = 550e-9,
    index: Index = np.inf,
    *,
    theta_i: ArrayLike = _THETA_I,
    phi_i: ArrayLike = 0.0,
    polar: ArrayLike | None = None,
    azimuth: ArrayLike | None = None,
    reference: str = "normal",
    scatter: str = "BRDF",
    scattering: str = "multiple",
    n: int = 4096,
    rng: int = 0,
    progress: Progress | None = None,
) -> BrdfTable:
    r"""Tabulate the BRDF of a surface whose facets follow a distribution.

    The facets are smooth interfaces of a metal, or of a dielectric where k = 0. The BRDF is

    .. math:: f = \frac{F D G_2}{4\cos\theta_i\cos\theta_s} + f_2 + f_3 + \dots

    of which the first order is in closed form and the others are estimated by random walks on Smith's
    uncorrelated facets. Light is unpolarised, and the surface scatters as in geometrical optics.

    Parameters
    ----------
    ndf : distribution
        Of any family, such as ``mf.fit(surface)[0].ndf`` or ``mf.GGX(alpha=0.2)``.
    wavelengths : float or sequence of float
        In metres.
    index : complex, sequence, path or (wavelengths, numbers)
        n + ik of the material at each wavelength, relative to the medium above: one number for all, one for
        each, or a table that is interpolated linearly, as arrays or in a file (`read_refractive_index`). The
        sign of the imaginary part is of no account. The default, inf, is a perfect mirror.
    theta_i, phi_i : float or sequence of float
        Directions of the light in degrees: theta_i in [0, 90), phi_i in [0, 360).
    polar, azimuth : float or sequence of float, optional
        Directions of scattered light in degrees, by default every 5 and 15 degrees from the normal, and
        ascending steps about the specular direction.
    reference : {"normal", "specular"}
        What `polar` and `azimuth` count from; see `BrdfTable`.
    scatter : {"BRDF", "BTDF"}
        Reflected light, or light that passes, of a dielectric.
    scattering : {"multiple", "single"}
        All orders, or the first.
    n : int
        Random walks for each pair of directions.
    rng : int
        Seed of the walks.
    progress : callable, optional
        Called with (what begins, steps done, steps in all).

    Returns
    -------
    BrdfTable

    Raises
    ------
    ValueError
        If an argument lies outside its domain; the message names it.

    References
    ----------
    B. Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007; E. Heitz et al.,
    Multiple-scattering microfacet BSDFs with the Smith model, SIGGRAPH 2016. For directions about the
    specular one: Zemax, BSDF data interchange file format specification, 2008.

    Examples
    --------
    >>> import microfacet as mf
    >>> rough = mf.StudentT(alpha=0.3, gamma=2.5)
    >>> table = mf.brdf_table(rough, [500e-9, 600e-9], [0.97 + 1.87j, 0.25 + 2.90j], theta_i=[0, 60])
    >>> table.values.shape
    (2, 2, 1, 24, 18)
    >>> print(f"{table.albedo[0, 1, 0]:.2f}, of one order {table.albedo_single[0, 1, 0]:.2f}")
    0.48, of one order 0.44
    >>> table.save("gold.csv")
    ['gold.csv']
    """
    for name, given, allowed in (
        ("reference", reference, ("normal", "specular")),
        ("scatter", scatter, ("BRDF", "BTDF")),
        ("scattering", scattering, ("multiple", "single")),
    ):
        if given not in allowed:
            raise ValueError(f"{name} must be {' or '.join(allowed)}, got {given!r:.60}")
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < BATCHES:
        raise ValueError(f"n must be a whole number in [{BATCHES}, inf), got {n!r:.60}")
    if scatter == "BTDF" and reference == "specular":
        raise ValueError("reference must be normal for a BTDF")
    where = wavelengths_of(wavelengths)
    most, open_end = (180.0, False) if reference == "specular" else (90.0, True)
    light = grid.angles(theta_i, "theta_i", 0.0, 90.0, closed=False)
    turns = grid.angles(phi_i, "phi_i", 0.0, 360.0, closed=False)
    polar = grid.angles(
        _POLAR[reference] if polar is None else polar, "polar", 0.0, most, closed=not open_end
    )
    if azimuth is None:
        half = reference == "specular" and grid.symmetric(ndf, turns)
        azimuth = _AZIMUTH["half" if half else reference]
    azimuth = grid.angles(azimuth, "azimuth", 0.0, 360.0)
    wi, wo = grid.directions(light, turns, azimuth, polar, reference, below=scatter == "BTDF")
    numbers = index_at(index, where)
    found = predicted(
        Surface(ndf, numbers, scatter == "BTDF", scattering == "multiple"), wi, wo, n, rng, progress
    )
    return BrdfTable(
        ndf=ndf,
        index=numbers,
        wavelengths=where,
        theta_i=light,
        phi_i=turns,
        polar=polar,
        azimuth=azimuth,
        reference=reference,
        scatter=scatter,
        scattering=scattering,
        **found._asdict(),
    )
