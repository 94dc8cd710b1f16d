"""`array_functions`: the library's functions on arrays of NumPy, JAX, PyTorch and CuPy, with derivatives."""

from __future__ import annotations

from typing import Any

from microfacet._export.calls import Cosine, Functions, Material
from microfacet._export.libraries import library_of
from microfacet._export.subject import subject_of

__all__ = ["ArrayFunctions", "array_functions"]


class ArrayFunctions(Functions):
    """Functions of a family or a distribution on the arrays of one library; `array_functions` makes them.

    Directions `m`, `w`, `wi`, `wo` are arrays (..., 3) of length 1 in the local frame (n = +z, away from the
    surface); slopes `p`, `q`, radii `r` are arrays of any shape; uniform numbers `xi` in [0, 1) have the last
    axis that a sampler takes, or a longer one. Parameters are keywords, Python's numbers or arrays that
    broadcast against the leading axes of directions: `alpha` in (1e-101, 1e101), or `alpha_x`, `alpha_y` and
    `rotation` in radians, and those of the family, with the domains that `microfacet.families` states. A
    distribution brings values for all of them; what a call gives takes their place.

    Results have the precision of the arrays, float32 or float64, as the library promotes it; Python's numbers
    take part in it without a say. An element is nan where an argument lies outside its domain or is nan.

    Attributes
    ----------
    cosine : Cosine
        D, sigma, Lambda and G1 of u = cos(theta).
    conductor, dielectric : Material
        `eval`, `pdf` and `sample` of a material of one event.
    """

    def __repr__(self) -> str:
        form = ", anisotropic" if self._subject.anisotropic else ""
        return f"<array_functions of {self._subject.source}{form}, on {self._library.name}>"

    @property
    def cosine(self) -> Cosine:
        """D, sigma, Lambda and G1 of u = cos(theta)."""
        if self._subject.anisotropic:
            raise ValueError("array_functions: functions of a cosine are those of isotropic distributions")
        return Cosine(self._subject, self._library)

    @property
    def conductor(self) -> Material:
        """A metal: parameters `eta` in (0, inf] and `k` in [0, inf), a perfect mirror without them."""
        return Material(self._subject, self._library, "conductor")

    @property
    def dielectric(self) -> Material:
        """A transparent surface: parameter `eta` in (0, inf)."""
        return Material(self._subject, self._library, "dielectric")

    @property
    def visible_dims(self) -> int:
        """How many uniform numbers `sample_visible` takes."""
        return self._uniforms("sample_visible")

    @property
    def mixture_dims(self) -> int:
        """How many uniform numbers `sample_visible` takes with the scheme "mixture"."""
        return self._uniforms("sample_visible_mixture")

    def D(self, m: Any, **parameters: Any) -> Any:
        """Density of normals at `m`, per steradian: P22(-x/z, -y/z)/cos(theta)^4, 0 for z <= 0."""
        return self._call("D", parameters, {"m": m})

    def P22(self, p: Any, q: Any, **parameters: Any) -> Any:
        """Joint density of the slopes `p` (along x) and `q` (along y); integrates to 1 over the plane."""
        return self._call("P22", parameters, {}, {"p": p, "q": q})

    def P2(self, p: Any, **parameters: Any) -> Any:
        """Density of the slope `p` along x; integrates to 1 over the line."""
        return self._call("P2", parameters, {}, {"p": p})

    def slope_cdf(self, p: Any, **parameters: Any) -> Any:
        """Probability that the slope along x is at most `p`, accurate in the lower tail."""
        return self._call("slope_cdf", parameters, {}, {"p": p})

    def survival(self, r: Any, **parameters: Any) -> Any:
        """Probability that a slope is larger than `r`, of isotropic distributions."""
        return self._call("survival", parameters, {}, {"r": r})

    def sigma(self, w: Any, **parameters: Any) -> Any:
        """Projected area of the microfacets towards `w`: int D(m) max(0, w . m) dm."""
        return self._call("sigma", parameters, {"w": w})

    def Lambda(self, w: Any, **parameters: Any) -> Any:
        """Smith's Lambda towards `w`: sigma(w) = w.z (1 + Lambda(w)); inf at w.z = 0."""
        return self._call("Lambda", parameters, {"w": w})

    def G1(self, w: Any, **parameters: Any) -> Any:
        """Smith's masking towards `w`: w.z/sigma(w) for w.z > 0, else 0."""
        return self._call("G1", parameters, {"w": w})

    def G2(self, wi: Any, wo: Any, **parameters: Any) -> Any:
        """Correlated masking and shadowing, 1/(1 + Lambda(wi) + Lambda(wo)); a Beta function if wo.z < 0."""
        return self._call("G2", parameters, {"wi": wi, "wo": wo})

    def D_visible(self, m: Any, w: Any, **parameters: Any) -> Any:
        """Density per steradian of the normals `m` seen from `w`: max(0, w . m) D(m)/sigma(w)."""
        return self._call("D_visible", parameters, {"m": m, "w": w})

    def pdf(self, m: Any, **parameters: Any) -> Any:
        """Density per steradian of the normals that `sample` draws: D(m) cos(theta)."""
        return self._call("pdf", parameters, {"m": m})

    def pdf_visible(self, m: Any, w: Any, **parameters: Any) -> Any:
        """Density per steradian of the normals that `sample_visible` draws, `D_visible`."""
        return self._call("pdf_visible", parameters, {"m": m, "w": w})

    def sample(self, xi: Any, **parameters: Any) -> Any:
        """Normals (..., 3) drawn from D cos(theta) by `xi` (..., 2): slope, then azimuth over 2 pi."""
        return self._call("sample", parameters, {"xi": xi})

    def sample_visible(self, w: Any, xi: Any, *, scheme: str = "continuous", **parameters: Any) -> Any:
        """Normals (..., 3) drawn from `D_visible` of `w`, on the whole sphere.

        Parameters
        ----------
        w : array, shape (..., 3)
            Unit directions.
        xi : array, shape (..., visible_dims), or (..., mixture_dims) with the scheme "mixture"
            Uniform numbers in [0, 1).
        scheme : {"continuous", "mixture"}
            As of the distributions' method: "continuous" is continuous in `xi` where the family has such a
            scheme, "mixture" takes fewer operations.
        **parameters
            Of the distribution.
        """
        if scheme not in ("continuous", "mixture"):
            raise ValueError(
                f'array_functions.sample_visible: scheme must be "continuous" or "mixture", got {scheme!r}'
            )
        quantity = "sample_visible" if scheme == "continuous" else "sample_visible_mixture"
        return self._call(quantity, parameters, {"w": w, "xi": xi})


def array_functions(ndf: Any, xp: Any = "numpy", *, anisotropic: bool | None = None) -> ArrayFunctions:
    """Functions of a family or a distribution on arrays of NumPy, JAX, PyTorch or CuPy.

    They are the library's own, recorded from its C++ headers operation by operation and carried out by the
    other library: on its devices, under its compiler, and differentiated by it.

    Parameters
    ----------
    ndf : str, Family, class or distribution
        A family, whose parameters are then arguments of every function; or a distribution such as
        ``microfacet.StudentT(alpha=0.3, gamma=2.5)``, whose parameters are those of every call that gives no
        others.
    xp : module or str
        ``numpy``, ``jax.numpy``, ``torch`` or ``cupy``, or the name of one of these libraries.
    anisotropic : bool, optional
        Whether parameters are alpha_x, alpha_y and rotation (0 unless given), instead of alpha. Left out,
        that is so for a distribution that is anisotropic.

    Returns
    -------
    ArrayFunctions
        With the methods ``D(m), P22(p, q), P2(p), slope_cdf(p), survival(r), sigma(w), Lambda(w), G1(w),
        G2(wi, wo), D_visible(m, w), sample(xi), pdf(m), sample_visible(w, xi), pdf_visible(m, w)``, and
        ``conductor``, ``dielectric`` (``eval(wi, wo), pdf(wi, wo), sample(wi, xi)``) and ``cosine``.

    Raises
    ------
    ValueError
        If `ndf` is no family or distribution, `xp` is none of the libraries, or the family has no such form;
        from functions, if an argument has the wrong shape or does not hold real numbers.
    TypeError
        From functions, if a parameter is missing or is none.
    ImportError
        If the library is not installed; the message names the extra that brings it.

    Notes ----- JAX: functions work under ``jit``, ``vmap``, ``grad``, ``jvp``. PyTorch: under autograd, on
    the device of the tensors. First derivatives by all arguments are exact: they are recorded with the
    function, and those of samples by the implicit function theorem at the solution that a sampler finds.
    Second derivatives raise an error.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> f = mf.array_functions("student_t")
    >>> m = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]])
    >>> f.D(m, alpha=np.array([0.3, 0.5]), gamma=2.5).round(6)
    array([3.536777, 0.314558])
    >>> mf.array_functions(mf.GGX(alpha=0.5)).cosine.Lambda(0.5).round(6)
    np.float64(0.161438)
    """
    return ArrayFunctions(subject_of(ndf, anisotropic), library_of(xp))
