"""A density of slopes on a grid, with everything that follows from it."""

from __future__ import annotations

import hashlib
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._core import slopes as kernels
from microfacet._frozen import Distribution
from microfacet._slope_table.grid import Grid, checked_grid, histogram, of_distribution

__all__ = ["SlopeTable"]

Array = NDArray[np.float64]


class SlopeTable(Distribution):
    """Slopes with any density on a grid, such as a histogram of measured ones, and all that follows from it.

    The density is constant in each cell and 0 outside the grid. It may be anisotropic in any way, have holes
    and several lobes, and a mean slope that is not 0, as detail on a tilted facet has.

    Parameters
    ----------
    p_edges, q_edges : array_like, shape (n + 1,) and (m + 1,)
        Edges of the cells in the slope along +x and in that along +y, increasing, evenly spaced, of at most
        512 cells each.
    masses : array_like, shape (n, m)
        Probabilities of the cells, up to a factor: what ``numpy.histogram2d(p, q)`` counts.

    Attributes
    ----------
    p_edges, q_edges, masses : ndarray
        As given, with masses that sum to 1. They are read-only.
    mean : (float, float)
        The mean slope.
    mean_normal : ndarray, shape (3,)
        The unit normal of the mean plane.
    error : float
        Largest relative difference found between sigma as it is computed and a sum over all cells, of
        directions that see at least 1e-6: the rounding of the sums, for nothing is interpolated.

    Raises
    ------
    ValueError
        If an argument is not as above; the message names it.

    Notes
    -----
    Every quantity is exact for this density, but for rounding. What a direction sees of a row of cells is a
    difference of prefix sums and two cells that its horizon crosses, so that `sigma` and `sample_visible`
    cost one step for each row crossed, and none for the rest. Arrays of float32 are computed in double.

    Where the mean slope (p, q) is not 0, the area that the mean plane shows, ``w.z - w.x p - w.y q``, stands
    where cos(theta) stands in Smith's Lambda, G1 and G2: "above" means above the mean plane. Materials
    scatter about it, too: their light is that which falls on it, their albedo of all orders is 1 for a white
    surface, and light may leave below the horizon of the frame.

    `sample` and `sample_visible` take two uniform numbers: the first one chooses the row of cells and the
    place across it, the second one the cell in it and the place along it.

    References
    ----------
    E. Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs, 2014; J. Dupuy et al.,
    Linear efficient antialiased displacement and reflectance mapping, 2013.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> slopes = np.random.default_rng(1).normal([0.1, 0.0], [0.2, 0.4], size=(100_000, 2))
    >>> counts, p_edges, q_edges = np.histogram2d(*slopes.T, bins=64)
    >>> measured = mf.SlopeTable(p_edges, q_edges, counts)
    >>> print(f"{measured.mean[0]:.2f} {measured.sigma([0.96, 0.0, 0.28]):.3f}")
    0.10 0.201
    """

    __slots__ = ("_capsule", "_digest", "error", "masses", "mean", "mean_normal", "p_edges", "q_edges")
    kernels = kernels
    _names = ()
    p_edges: Array
    q_edges: Array
    masses: Array
    mean: tuple[float, float]
    mean_normal: Array
    error: float
    _digest: bytes

    def __init__(self, p_edges: ArrayLike, q_edges: ArrayLike, masses: ArrayLike) -> None:
        self._keep(checked_grid(type(self).__name__, p_edges, q_edges, masses))

    @classmethod
    def from_slopes(cls, slopes: Any, *, bins: Any = None, extent: Any = None) -> Self:
        """A histogram of slopes.

        Parameters
        ----------
        slopes : array_like, shape (N, 2), or Surface, or SlopeSample
            At least 100 slopes (p, q) along +x and +y; of a Surface those of neighbouring pixels.
        bins : int or (int, int), optional
            Cells along both axes, or along p and q, 512 at most; by default Scott's rule,
            ``3.5 s N^(-1/4)`` for a cell with the standard deviation s.
        extent : ((float, float), (float, float)), optional
            From where to where p and q go, by default as far as the slopes. Slopes outside do not count.

        Raises
        ------
        ValueError
            If there are too few slopes, or some are not finite.

        Examples
        --------
        >>> import microfacet as mf
        >>> terrain = mf.SlopeTable.from_slopes(mf.sample_terrain(), bins=128)
        >>> terrain.masses.shape
        (128, 128)
        """
        return cls._of(histogram(f"{cls.__name__}.from_slopes", slopes, bins, extent))

    @classmethod
    def from_distribution(
        cls, ndf: Distribution, *, mean: ArrayLike = (0.0, 0.0), bins: Any = 256, extent: Any = None
    ) -> Self:
        """Another distribution on a grid, with its slopes moved by `mean`.

        Parameters
        ----------
        ndf : distribution
            Of any family, or your own.
        mean : (float, float)
            Added to its slopes.
        bins : int or (int, int)
            Cells along both axes, or along p and q, 512 at most.
        extent : ((float, float), (float, float)), optional
            From where to where p and q go, by default as far as one slope in ten thousand exceeds. The rest
            of the density is left out.

        Examples
        --------
        >>> import microfacet as mf
        >>> tilted = mf.SlopeTable.from_distribution(mf.Beckmann(alpha=0.3), mean=(0.2, 0.0))
        >>> print(f"{tilted.mean[0]:.6f}")
        0.200000
        """
        owner = f"{cls.__name__}.from_distribution"
        if not isinstance(ndf, Distribution):
            raise ValueError(f"{owner}: ndf must be a distribution, got {ndf!r:.80}")
        return cls._of(of_distribution(owner, ndf, mean, bins, extent))

    @classmethod
    def _of(cls, grid: Grid) -> Self:
        new = cls.__new__(cls)
        new._keep(grid)
        return new

    def _keep(self, grid: Grid) -> None:
        p, q, masses = grid
        capsule, handle, mean_p, mean_q, error = kernels.build(
            p[0], (p[-1] - p[0]) / (len(p) - 1), q[0], (q[-1] - q[0]) / (len(q) - 1), masses.T
        )
        self._freeze((handle,))
        normal = np.array([-mean_p, -mean_q, 1.0]) / np.sqrt(1.0 + mean_p**2 + mean_q**2)
        normal.flags.writeable = False
        digest = hashlib.sha256(b"".join(part.tobytes() for part in grid)).digest()
        state = {
            "p_edges": p,
            "q_edges": q,
            "masses": masses,
            "mean": (mean_p, mean_q),
            "mean_normal": normal,
            "error": error,
            "_capsule": capsule,
            "_digest": digest,
        }
        for name, value in state.items():
            object.__setattr__(self, name, value)

    def moved(self, p: float, q: float) -> Self:
        """The same density with `p` and `q` added to its slopes.

        Examples
        --------
        >>> import microfacet as mf
        >>> table = mf.SlopeTable([-0.5, 0.0, 0.5], [-0.5, 0.5], [[1.0], [3.0]])
        >>> table.mean, table.moved(*(-slope for slope in table.mean)).mean
        ((0.125, 0.0), (0.0, 0.0))
        """
        owner = f"{type(self).__name__}.moved"
        return self._of(checked_grid(owner, self.p_edges + p, self.q_edges + q, self.masses))

    @property
    def parameters(self) -> dict[str, float]:
        """None: a table has no parameters."""
        return {}

    def _kernel(self, quantity: str) -> tuple[Any, tuple[float, ...]]:
        return getattr(self.kernels, quantity), self._values

    def __eq__(self, other: object) -> bool:
        return self._digest == other._digest if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        return hash((type(self), self._digest))

    def __repr__(self) -> str:
        p, q, (n, m) = self.p_edges, self.q_edges, self.masses.shape
        return (
            f"<SlopeTable {self._digest.hex()[:8]}: {n} x {m} cells, p in [{p[0]:.4g}, {p[-1]:.4g}], "
            f"q in [{q[0]:.4g}, {q[-1]:.4g}], mean slope ({self.mean[0]:.4g}, {self.mean[1]:.4g}), "
            f"error {self.error:.1g}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), self.p_edges, self.q_edges, self.masses)


def _restore(cls: type[SlopeTable], p: Array, q: Array, masses: Array) -> SlopeTable:
    arrays = [np.array(array) for array in (p, q, masses)]
    for array in arrays:
        array.flags.writeable = False
    return cls._of(Grid(*arrays))
