"""Which lateral scales of a surface matter to light of a wavelength."""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ["SpatialBandwidth", "spatial_bandwidth"]


class SpatialBandwidth(NamedTuple):
    """Lengths in metres; see `spatial_bandwidth`.

    `shortest` and `longest` are the periods of gratings that scatter light of `wavelength` anywhere above the
    surface, and by no less than `scatter_angle` degrees from the specular direction. `phase_variance` is
    Rayleigh's measure of roughness, `specular_fraction` the part of the reflected light that it leaves in the
    specular direction; both are None where Sq is not given.
    """

    wavelength: float
    theta_i: float
    scatter_angle: float
    shortest: float
    longest: float
    phase_variance: float | None
    specular_fraction: float | None

    def remarks(self, baseline: float | None = None) -> list[str]:
        """What follows for filters, and for slopes taken over a `baseline` (twice the lag), in sentences."""
        light = f"{1e9 * self.wavelength:.4g} nm"
        angle = f"{self.scatter_angle:g} degree{'s' * (self.scatter_angle != 1)}"
        said = [
            f"light of {light} at {self.theta_i:g} degrees is scattered by periods from "
            f"{self.shortest:.3g} m; those longer than {self.longest:.3g} m scatter it by less than {angle}: "
            f"an S-filter of {self.shortest:.3g} m takes away what light cannot see"
        ]
        if baseline is not None and baseline < self.shortest:
            said.append(
                f"slopes are taken over {baseline:.3g} m, which is finer than light of {light} resolves: "
                f"take a lag of {self.shortest / 2:.3g} m or more, or an S-filter"
            )
        elif baseline is not None and baseline > 10 * self.shortest:
            said.append(
                f"slopes are taken over {baseline:.3g} m, {baseline / self.shortest:.0f} times the shortest "
                f"period that light of {light} sees: roughness between the two is not in this prediction"
            )
        if self.specular_fraction is not None and self.specular_fraction > 0.01:
            said.append(
                f"{self.specular_fraction:.1%} of the reflected light stays specular by diffraction "
                f"(exp(-g), g = {self.phase_variance:.3g}): facets as small mirrors describe rougher "
                "surfaces, for this one use its power spectral density"
            )
        return said


def spatial_bandwidth(
    wavelength: float, theta_i: float = 0.0, *, scatter_angle: float = 1.0, Sq: float | None = None
) -> SpatialBandwidth:
    r"""The band of lateral periods that scatters light of a wavelength, to choose S-filter and L-filter by.

    Roughness of period d scatters like a grating, in its plane of incidence by

    .. math:: \sin\theta_s = \sin\theta_i \pm \lambda/d

    so that periods below :math:`\lambda/(1 + \sin\theta_i)` scatter no light that leaves the surface: an
    S-filter of that cut-off takes away what light does not see. Long periods deflect light by little: with
    the smallest angle from the specular direction that is of interest,
    :math:`d = \lambda/(\sin\theta_i - \sin(\theta_i - \delta))` is where an L-filter may cut off. How rough
    the surface is for light says the phase variance :math:`g = (4\pi S_q\cos\theta_i/\lambda)^2`, with Sq of
    that band: the part exp(-g) of the reflected light stays specular by diffraction. Facets that reflect like
    small mirrors are the limit of large g.

    Parameters
    ----------
    wavelength : float
        In metres.
    theta_i : float
        Angle of incidence in degrees, in [0, 90).
    scatter_angle : float
        delta: the smallest angle from the specular direction that matters, in degrees, in (0, 90].
    Sq : float, optional
        Root mean square height in metres, within the band.

    Returns
    -------
    SpatialBandwidth
        Its `remarks` say in sentences what follows.

    Raises
    ------
    ValueError
        If an argument lies outside its domain.

    References
    ----------
    J. C. Stover, Optical Scattering: Measurement and Analysis, SPIE Press 2012, chapters 1 to 4 (grating
    equation, relevant band of frequencies); P. Beckmann & A. Spizzichino, The Scattering of Electromagnetic
    Waves from Rough Surfaces, 1963 (exp(-g)); H. E. Bennett & J. O. Porteus, Relation between surface
    roughness and specular reflectance at normal incidence, JOSA 51, 1961. ISO 10110-8 has drawings state the
    band with every roughness.

    Examples
    --------
    >>> import microfacet as mf
    >>> band = mf.spatial_bandwidth(550e-9, 30.0, Sq=20e-9)
    >>> f"{band.shortest:.3g} m to {band.longest:.3g} m, {band.specular_fraction:.0%} specular"
    '3.67e-07 m to 3.62e-05 m, 86% specular'
    """
    if not 0 < wavelength < math.inf:
        raise ValueError(f"wavelength must be a positive number of metres, got {wavelength:g}")
    if not 0 <= theta_i < 90:
        raise ValueError(f"theta_i must lie in [0, 90) degrees, got {theta_i:g}")
    if not 0 < scatter_angle <= 90:
        raise ValueError(f"scatter_angle must lie in (0, 90] degrees, got {scatter_angle:g}")
    if Sq is not None and not 0 <= Sq < math.inf:
        raise ValueError(f"Sq must lie in [0, inf) metres, got {Sq:g}")
    theta = math.radians(theta_i)
    nearest = math.radians(theta_i - scatter_angle)
    variance = None if Sq is None else (4 * math.pi * Sq * math.cos(theta) / wavelength) ** 2
    return SpatialBandwidth(
        float(wavelength),
        float(theta_i),
        float(scatter_angle),
        wavelength / (1 + math.sin(theta)),
        wavelength / (math.sin(theta) - math.sin(nearest)),
        variance,
        None if variance is None else math.exp(-variance),
    )
