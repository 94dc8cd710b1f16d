"""The other ways to make a density of one's own: from samples, tables, histograms and fits."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._densities import documents, estimate
from microfacet._densities.curve import Curve, column

__all__ = ["Constructors"]

Array = NDArray[np.float64]

#: Of a roughness given by name: alpha, alpha_x, alpha_y, rotation.
Roughness = float | None


class Constructors:
    """What `RadialNDF` inherits; a subclass is made from P22 and the parameters of a roughness."""

    __slots__ = ()

    @classmethod
    def _of(cls, P22: Any, roughness: dict[str, Any]) -> Self:
        make: Any = cls
        found: Self = make(P22, **{name: value for name, value in roughness.items() if value is not None})
        return found

    @classmethod
    def from_samples(cls, samples: ArrayLike, *, alpha: float | None = None) -> Self:
        """The density of measured slopes, estimated from them.

        Parameters
        ----------
        samples : array_like, shape (N, 2) or (N, 3)
            Slopes ``(p, q)`` (a `SlopeSample` too), or normals with z > 0; 200 at least. The mean slope is
            estimated by the median.
        alpha : float, optional
            The roughness that the density is given. By default that of the samples, which is their median
            length.

        Returns
        -------
        RadialNDF
            Its density at alpha = 1 is that of the samples over their median length: a smooth function, as
            smooth as the samples say. It is finite at slope 0, and beyond the largest sample a power law.

        Raises
        ------
        ValueError
            If the samples are not finite, have another shape, are too few, or most of them are equal.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> normals = mf.GGX(alpha=0.3).sample(np.random.default_rng(1).random((20_000, 2)))
        >>> found = mf.RadialNDF.from_samples(normals)
        >>> print(f"{found.alpha_x:.2f} {found.sigma([0.8, 0.0, 0.6]):.2f}")
        0.30 0.62
        """
        radii = _lengths(samples)
        median = float(np.median(radii))
        if not median > 0.0:
            raise ValueError(
                "RadialNDF: most of the slopes have one length, which leaves no density to estimate "
                "(quantised heights? take a larger lag)"
            )
        density = estimate.from_radii(radii / median)
        return cls._of(density, {"alpha": median if alpha is None else alpha})

    @classmethod
    def from_histogram(
        cls,
        edges: ArrayLike,
        counts: ArrayLike,
        alpha: Roughness = None,
        *,
        alpha_x: Roughness = None,
        alpha_y: Roughness = None,
        rotation: float = 0.0,
    ) -> Self:
        """The density of slopes whose lengths r = sqrt(p^2 + q^2) were counted in bins.

        Parameters
        ----------
        edges : array_like, shape (n + 1,)
            Of the bins at alpha = 1, increasing from 0 or more; the last may be infinite.
        counts : array_like, shape (n,)
            Not negative, 200 together at least: how many slopes there were, since that says how smooth the
            density has to be.
        alpha, alpha_x, alpha_y, rotation
            As of `RadialNDF`.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> edges = np.linspace(0.0, 4.0, 41)
        >>> counts = np.round(-1e5 * np.diff(np.exp(-(edges**2))))
        >>> mf.RadialNDF.from_histogram(edges, counts, alpha=0.3).Lambda([0.96, 0.0, 0.28]).round(3)
        np.float64(0.028)
        """
        borders, numbers = _histogram(edges, counts)
        density = estimate.from_counts(borders, numbers)
        axes = {"alpha": alpha, "alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": rotation}
        return cls._of(density, axes)

    @classmethod
    def from_D(
        cls,
        theta: ArrayLike | None,
        D: ArrayLike,
        alpha: Roughness = None,
        *,
        u: ArrayLike | None = None,
        beyond: str = "power",
        alpha_x: Roughness = None,
        alpha_y: Roughness = None,
        rotation: float = 0.0,
    ) -> Self:
        """The density of which D was tabulated against the angle, in any unit.

        Parameters
        ----------
        theta : array_like
            Angles from the macronormal in radians, increasing in [0, pi/2]; None where `u` is given.
        D : array_like
            Density per steradian there, not negative: P22 = D cos(theta)^4. It need not be normalised; `norm`
            is the factor.
        alpha, alpha_x, alpha_y, rotation
            As of `RadialNDF`: the table is that at alpha = 1.
        u : array_like, optional
            Cosines in place of angles, in any order of them that is monotone.
        beyond : {"power", "zero"}
            Beyond the last angle the power law of the slope goes on, or there are no normals.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> theta = np.radians(np.arange(0.0, 90.0, 1.0))
        >>> table = 7.0 * mf.GGX(alpha=0.4).D(np.sin(theta), 0.0, np.cos(theta))
        >>> found = mf.RadialNDF.from_D(theta, table)
        >>> print(f"{found.norm:.2f} {found.G1([0.96, 0.0, 0.28]):.3f} {mf.ggx.G1(0.28, 0.4):.3f}")
        7.00 0.741 0.741
        """
        r, values = documents.slopes_of_angles(theta, u, D)
        axes = {"alpha": alpha, "alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": rotation}
        return cls._of(Curve("P22", r, values, beyond=beyond), axes)

    @classmethod
    def from_fit(cls, result: Any, *, measured: bool = True) -> Self:
        """The density that a fit found, with its roughness and axes.

        Parameters
        ----------
        result : FitResult
            Of `fit`.
        measured : bool
            Take the radial density of the slopes themselves, from the quantiles that the result holds,
            in the fitted roughness and axes; otherwise that of the fitted family.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> result = mf.fit(mf.sample_terrain(), "student_t", lag=8)[0]
        >>> own = mf.RadialNDF.from_fit(result)
        >>> bool(abs(own.G1([0.8, 0.0, 0.6]) - result.ndf.G1([0.8, 0.0, 0.6])) < 0.01)
        True
        """
        goodness = getattr(result, "goodness", None)
        if goodness is None or getattr(result, "ndf", None) is None:
            raise ValueError(f"RadialNDF: result must be one that fit returned, got {type(result).__name__}")
        ndf = result.ndf
        stretched = "alpha_x" in ndf.parameters
        axes = (
            {k: ndf.parameters[k] for k in ("alpha_x", "alpha_y", "rotation")}
            if stretched
            else {"alpha": 1.0}
        )
        if measured:
            edges = np.concatenate(([0.0], goodness.observed, [np.inf]))
            shares = np.diff(np.concatenate(([0.0], goodness.probabilities, [1.0])))
            return cls._of(estimate.from_counts(edges, shares * result.n), axes)
        unit = dict.fromkeys(("alpha_x", "alpha_y"), 1.0) | {"rotation": 0.0} if stretched else {}
        standard = type(ndf)(**(ndf.parameters | unit))
        return cls._of(lambda r: standard.P22(r, 0.0), axes)

    def with_roughness(
        self,
        alpha: Roughness = None,
        *,
        alpha_x: Roughness = None,
        alpha_y: Roughness = None,
        rotation: float = 0.0,
    ) -> Self:
        """The same density at another roughness, without building its tables again.

        Examples
        --------
        >>> import numpy as np
        >>> import microfacet as mf
        >>> ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)))
        >>> ndf.with_roughness(0.3) == mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
        True
        """
        new = type(self).__new__(type(self))
        given: Any = new
        given._set(alpha, alpha_x, alpha_y, rotation)
        for slot in (name for cls in type(self).__mro__ for name in vars(cls).get("__slots__", ())):
            if slot not in ("_values", "_calls"):
                object.__setattr__(new, slot, getattr(self, slot))
        return new

    def save(self, path: str | Path) -> None:
        """Write the density and its roughness to FILE.json or FILE.npz, which `read_density` reads.

        The file holds P22 at slopes from which a cubic gives it back, to about 1e-9.

        Examples
        --------
        >>> import os, tempfile
        >>> import numpy as np
        >>> import microfacet as mf
        >>> ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     ndf.save(os.path.join(folder, "own.json"))
        ...     again = mf.read_density(os.path.join(folder, "own.json"))
        >>> again.alpha_x, bool(abs(again.D([0.0, 0.0, 1.0]) / ndf.D([0.0, 0.0, 1.0]) - 1) < 1e-8)
        (0.3, True)
        """
        documents.write(path, documents.document_of(self))


def _lengths(samples: ArrayLike) -> Array:
    """Lengths of slopes about their median."""
    try:
        array = np.asarray(samples)
    except ValueError:
        array = np.empty(0, dtype=object)
    if array.ndim != 2 or array.shape[1] not in (2, 3) or array.dtype.kind not in "iuf":
        raise ValueError(
            "RadialNDF: samples must be slopes (N, 2) or normals (N, 3), "
            f"got {array.dtype} of shape {array.shape}"
        )
    if not np.all(np.isfinite(array)):
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise ValueError(f"RadialNDF: samples must be finite, got {tuple(array[row].tolist())} in row {row}")
    array = array.astype(np.float64)
    if array.shape[1] == 3:
        if not np.all(array[:, 2] > 0.0):
            raise ValueError(f"RadialNDF: normals must have z > 0, got {array[:, 2].min():g}")
        array = -array[:, :2] / array[:, 2:]
    if len(array) < estimate.FEWEST_COUNTS:
        raise ValueError(
            f"RadialNDF: {estimate.FEWEST_COUNTS} slopes at least are needed to say anything of a density, "
            f"got {len(array)}"
        )
    return np.asarray(np.hypot(*(array - np.median(array, axis=0)).T))


def _histogram(edges: ArrayLike, counts: ArrayLike) -> tuple[Array, Array]:
    borders = np.asarray(edges)
    if borders.ndim != 1 or borders.dtype.kind not in "iuf":
        raise ValueError(f"RadialNDF: edges must be a 1-D array of real numbers, got {borders.dtype}")
    borders = borders.astype(np.float64)
    numbers = column("counts", counts)
    if len(borders) != len(numbers) + 1:
        raise ValueError(
            f"RadialNDF: a histogram has one edge more than counts, got {len(borders)} and {len(numbers)}"
        )
    if not (np.all(np.diff(borders) > 0.0) and borders[0] >= 0.0 and math.isfinite(borders[-2])):
        raise ValueError("RadialNDF: edges must increase from 0 or more, and only the last may be infinite")
    if np.any(numbers < 0.0):
        raise ValueError(f"RadialNDF: counts must not be negative, got {numbers.min():g}")
    return borders, numbers
