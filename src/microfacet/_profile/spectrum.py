"""The power spectral density of the heights along a line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, signal

from microfacet._profile.traces import Traces
from microfacet._surface.checks import SurfaceError, positive
from microfacet._value import Value

__all__ = ["ProfileSpectrum", "spectrum"]

_SHARE, _FEWEST = 4, 16  # of the longest trace, and points: the segments whose spectra are averaged


@dataclass(frozen=True, eq=False)
class ProfileSpectrum(Value):
    r"""One-sided power spectral density of heights along a line.

    .. math:: \int_0^{1/(2 dx)} C(f)\,df = \overline{z^2}

    Attributes
    ----------
    frequencies : ndarray
        In waves per metre, from 1/segment to half of the sampling frequency.
    psd : ndarray
        Cubic metres.
    segments : int
        How many spectra the mean is of, by Welch's method; each density scatters by about
        1/sqrt(segments) of itself.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> x = np.arange(8000) * 1e-6
    >>> waves = mf.Profile(np.sqrt(2) * 1e-6 * np.sin(2 * np.pi * x / 40e-6), spacing=1e-6).psd()
    >>> peak = waves.frequencies[np.argmax(waves.psd)]
    >>> print(f"{1 / peak:.3g} m, {np.sum(waves.psd) * waves.frequencies[0]:.3g} m^2")
    4e-05 m, 1e-12 m^2
    """

    frequencies: NDArray[np.float64]
    psd: NDArray[np.float64]
    segments: int

    def __post_init__(self) -> None:
        self._keep(**vars(self))  # which makes the arrays read-only


def spectrum(profile: Traces, segment_length: float | None) -> ProfileSpectrum:
    """Mean over segments of the stretches of the traces in which no point is missing.

    P. D. Welch, The use of fast Fourier transform for the estimation of power spectra, IEEE Trans. Audio
    Electroacoustics 15, 1967.
    """
    runs = [run for trace in profile.traces for run in _runs(trace)]
    longest = max(run.size for run in runs)
    if segment_length is None:
        points = min(max(max(trace.size for trace in profile.traces) // _SHARE, _FEWEST), longest)
    else:
        points = round(min(positive(segment_length, "segment_length") / profile.spacing, 1e9))
    if not 8 <= points <= longest:
        raise SurfaceError(
            f"a spectrum needs segments of 8 to {longest} points without a missing one, got {points}"
        )
    total, count = np.zeros(points // 2 + 1), 0
    for run in runs:
        if run.size < points:
            continue
        frequency, density = signal.welch(run - np.mean(run), fs=1 / profile.spacing, nperseg=points)
        segments = 1 + (run.size - points) // (points - points // 2)
        total, count = total + segments * density, count + segments
    return ProfileSpectrum(frequency[1:], total[1:] / count, count)


def _runs(trace: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """The stretches of valid points."""
    labels, _ = ndimage.label(np.isfinite(trace))
    return [trace[where[0]] for where in ndimage.find_objects(labels)]
