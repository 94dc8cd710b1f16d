"""Values of a BRDF for pairs of directions: the first order in closed form, the others by random walks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from microfacet._bsdf import Conductor, Dielectric
from microfacet._bsdf.kernels import NO_ORDER
from microfacet._optics import grid
from microfacet._optics.index import Complex

__all__ = ["BATCHES", "Predicted", "Progress", "Surface", "predicted"]

Array = NDArray[np.float64]
#: Told what begins, how many steps are done, and how many there are.
Progress = Callable[[str, int, int], None]
#: Of random walks, whose scatter gives the standard error.
BATCHES = 16
_ALBEDO_WALKS = 2**18  # of each direction: an error of a thousandth at most
_DISC = 0.25  # degrees: over a disc of this radius infinite values are averaged
_IN_DISC = 64
_HORIZON = 1e-9  # cosine below which a direction lies along the surface


class Surface(NamedTuple):
    """A distribution of facets, and what they are made of at each wavelength."""

    ndf: Any
    indices: Complex
    passes: bool  # the light that passes is asked for
    multiple: bool


class Predicted(NamedTuple):
    """The arrays of a `BrdfTable`."""

    values: Array
    errors: Array
    single: Array
    albedo: Array
    albedo_error: Array
    albedo_single: Array
    notes: tuple[str, ...]


def predicted(
    surface: Surface, wi: Array, wo: Array, n: int, rng: int, progress: Progress | None
) -> Predicted:
    """For light from `wi` (theta_i, phi_i, 3) to `wo` (theta_i, phi_i, azimuth, polar, 3)."""
    told = progress or (lambda *_: None)
    metal = (surface.indices.imag > 0) | np.isinf(surface.indices.real)
    if surface.passes and metal.any():
        which = surface.indices[metal][0]
        raise ValueError(f"scatter: no light passes a metal, so a BTDF needs k = 0, got {which:g}")
    groups = [np.flatnonzero(metal)] if metal.any() else []
    groups += [np.array([number]) for number in np.flatnonzero(~metal)]
    shape = (len(surface.indices), *wo.shape[:-1])
    single, rest, errors = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    albedo, albedo_error, albedo_single = np.zeros((3, len(surface.indices), *wi.shape[:-1]))
    part = "transmitted" if surface.passes else "reflected"
    for done, group in enumerate(groups):
        told("BRDF", done, len(groups))
        once = _material(surface, group, "single")
        with np.errstate(invalid="ignore"):  # inf where the density is infinite
            single[group] = _over_cosine(once, wi, wo)
        albedo[group] = albedo_single[group] = _channels_first(once, once.albedo(wi, part=part))
        if surface.multiple:
            often = _material(surface, group, "multiple")
            rest[group], errors[group] = _beyond(often, wi, wo, n, rng)
            all_orders = often.albedo(wi, part=part, n=max(n, _ALBEDO_WALKS), rng=rng, with_error=True)
            albedo[group], albedo_error[group] = (_channels_first(often, one) for one in all_orders)
    endless = np.isinf(single)
    notes: tuple[str, ...] = ()
    if endless.any():
        for group in groups:
            single[group] = _averaged(_material(surface, group, "single"), wi, wo, single[group])
        notes = (
            f"{np.count_nonzero(endless)} values in the mirror direction are infinite; in their place stands "
            f"the mean over {_DISC:g} degrees about it",
        )
    return Predicted(single + rest, errors, single, albedo, albedo_error, albedo_single, notes)


def _material(surface: Surface, group: NDArray[np.intp], scattering: str) -> Conductor | Dielectric:
    """Metals share their directions; light is followed from where it comes, so that energy counts."""
    some = surface.indices[group]
    if some[0].imag > 0 or np.isinf(some[0].real):
        return Conductor(surface.ndf, some.real, some.imag, scattering=scattering)
    return Dielectric(surface.ndf, float(some[0].real), scattering=scattering, mode="importance")


def _channels_first(material: Conductor | Dielectric, values: Any) -> Array:
    array = np.asarray(values)
    return np.moveaxis(array, -1, 0) if isinstance(material, Conductor) else array[np.newaxis]


def _over_cosine(material: Conductor | Dielectric, wi: Array, wo: Array, **walks: Any) -> Array:
    """What leaves towards `wo` over its cosine: (wavelengths, ..., azimuth, polar)."""
    light = np.broadcast_to(wi[:, :, np.newaxis, np.newaxis, :], wo.shape)
    cosine = np.abs(wo[..., 2])
    seen = cosine > _HORIZON
    values = _channels_first(material, material.eval(light, wo, **walks))
    return np.where(seen, values / np.where(seen, cosine, 1.0), 0.0)


def _beyond(material: Conductor | Dielectric, wi: Array, wo: Array, n: int, rng: int) -> tuple[Array, Array]:
    """The orders beyond the first: mean and standard error over batches of walks."""
    count = -(-n // BATCHES)
    total, squares = np.zeros(()), np.zeros(())
    for seed in range(rng * BATCHES, (rng + 1) * BATCHES):
        one = _over_cosine(material, wi, wo, n=count, rng=seed, orders=(2, NO_ORDER))
        total, squares = total + one, squares + one * one
    mean = total / BATCHES
    variance = np.maximum(squares / BATCHES - mean**2, 0.0)
    return np.asarray(mean), np.sqrt(variance / (BATCHES - 1))


def _averaged(material: Conductor | Dielectric, wi: Array, wo: Array, values: Array) -> Array:
    """The values, where they are infinite the mean over a small disc of directions."""
    number = np.arange(_IN_DISC) + 0.5
    radial, turn = _DISC * np.sqrt(number / _IN_DISC), number * 180 * (3 - np.sqrt(5))
    for place in np.argwhere(np.isinf(values).any(axis=0)):
        i, j, a, p = place
        about = grid.from_specular(grid.specular(wo[i, j, a, p]), 0.0, radial, turn)
        some = np.broadcast_to(wi[i, j], about.shape)
        found = _channels_first(material, material.eval(some, about)) / np.abs(about[:, 2])
        values[:, i, j, a, p] = np.mean(found, axis=-1)
    return values
