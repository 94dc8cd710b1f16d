"""Microfacet normal distribution functions: Beckmann, GGX, GTR, Student-T, K0, Bessel K and more.

Elementwise functions are ufuncs in one namespace per family, ``microfacet.student_t.sigma(u, alpha, gamma)``.
Frozen distributions work on directions, ``microfacet.StudentT(alpha=0.3, gamma=2.5).D(m)``. `families()` says
what there is.

Examples
--------
>>> import microfacet as mf
>>> print(f"{mf.k0.Lambda(0.5, 0.3):.6g}")
0.00276708
>>> ndf = mf.StudentT(alpha_x=0.1, alpha_y=0.4, rotation=0.2, gamma=2.5)
>>> print(f"{ndf.sigma([0.0, 0.6, 0.8]):.6g}")
0.803695
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from microfacet._family import (
    Family,
    Parameter,
    beckmann,
    bessel_k,
    dirac,
    double_ggx,
    ei,
    erfc,
    exponential,
    families,
    generalised_exponential,
    ggx,
    gtr,
    k0,
    student_t,
)
from microfacet._family.beckmann import Beckmann
from microfacet._family.bessel_k import BesselK
from microfacet._family.dirac import Dirac
from microfacet._family.double_ggx import DoubleGGX
from microfacet._family.ei import Ei
from microfacet._family.erfc import Erfc
from microfacet._family.exponential import Exponential
from microfacet._family.generalised_exponential import GeneralisedExponential
from microfacet._family.ggx import GGX
from microfacet._family.gtr import GTR
from microfacet._family.k0 import K0
from microfacet._family.student_t import StudentT
from microfacet._radial import RadialNDF
from microfacet._slope_table import SlopeTable

if TYPE_CHECKING:
    from microfacet import testing
    from microfacet._bake import LookupTexture, bake, lookup_texture
    from microfacet._bsdf import (
        Conductor,
        Dielectric,
        Diffuse,
        KullaConty,
        Turquin,
        fresnel_average,
        fresnel_conductor,
        fresnel_dielectric,
    )
    from microfacet._density_files import read_density
    from microfacet._export import export
    from microfacet._export.arrays import array_functions
    from microfacet._fit import FitResult, Goodness, ScaleFit, TableFit, fit, fit_scales, fit_table
    from microfacet._surface import (
        Roughness,
        SlopeSample,
        Surface,
        SurfaceError,
        read_normal_map,
        read_slopes,
        read_surface,
        roughness,
        sample_terrain,
        synthesize,
    )
    from microfacet._user_family import UserFamily

__all__ = [
    "GGX",
    "GTR",
    "K0",
    "Beckmann",
    "BesselK",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "Dirac",
    "DoubleGGX",
    "Ei",
    "Erfc",
    "Exponential",
    "Family",
    "FitResult",
    "GeneralisedExponential",
    "Goodness",
    "KullaConty",
    "LookupTexture",
    "Parameter",
    "RadialNDF",
    "Roughness",
    "ScaleFit",
    "SlopeSample",
    "SlopeTable",
    "StudentT",
    "Surface",
    "SurfaceError",
    "TableFit",
    "Turquin",
    "UserFamily",
    "__version__",
    "array_functions",
    "bake",
    "beckmann",
    "bessel_k",
    "dirac",
    "double_ggx",
    "ei",
    "erfc",
    "exponential",
    "export",
    "families",
    "fit",
    "fit_scales",
    "fit_table",
    "fresnel_average",
    "fresnel_conductor",
    "fresnel_dielectric",
    "generalised_exponential",
    "get_cmake_dir",
    "get_include",
    "ggx",
    "gtr",
    "k0",
    "lookup_texture",
    "read_density",
    "read_normal_map",
    "read_slopes",
    "read_surface",
    "roughness",
    "sample_terrain",
    "student_t",
    "synthesize",
    "testing",
]

__version__: str

# Loaded at first use: most need SciPy, which an `import microfacet` for the ufuncs should not wait for.
_LAZY = {
    "Conductor": "microfacet._bsdf",
    "Dielectric": "microfacet._bsdf",
    "Diffuse": "microfacet._bsdf",
    "KullaConty": "microfacet._bsdf",
    "Turquin": "microfacet._bsdf",
    "fresnel_average": "microfacet._bsdf",
    "fresnel_conductor": "microfacet._bsdf",
    "fresnel_dielectric": "microfacet._bsdf",
    "LookupTexture": "microfacet._bake",
    "read_density": "microfacet._density_files",
    "array_functions": "microfacet._export.arrays",
    "bake": "microfacet._bake",
    "export": "microfacet._export",
    "lookup_texture": "microfacet._bake",
    "FitResult": "microfacet._fit",
    "Goodness": "microfacet._fit",
    "ScaleFit": "microfacet._fit",
    "TableFit": "microfacet._fit",
    "fit": "microfacet._fit",
    "fit_scales": "microfacet._fit",
    "fit_table": "microfacet._fit",
    "Roughness": "microfacet._surface",
    "SlopeSample": "microfacet._surface",
    "Surface": "microfacet._surface",
    "SurfaceError": "microfacet._surface",
    "read_normal_map": "microfacet._surface",
    "read_slopes": "microfacet._surface",
    "read_surface": "microfacet._surface",
    "roughness": "microfacet._surface",
    "sample_terrain": "microfacet._surface",
    "synthesize": "microfacet._surface",
    "UserFamily": "microfacet._user_family",
}


def get_include() -> str:
    """The folder of the C++ headers, for a compiler's ``-I``.

    Returns
    -------
    str
        The folder that has ``microfacet/smith/ndf.hpp`` and all else that is included as ``microfacet/...``.

    Examples
    --------
    >>> import pathlib
    >>> import microfacet as mf
    >>> pathlib.Path(mf.get_include(), "microfacet", "smith", "ndf.hpp").exists()
    True
    """
    here = Path(__file__).parent
    installed = here / "include"
    return str(installed if installed.is_dir() else here.parent.parent / "include")


def get_cmake_dir() -> str:
    """The folder of the CMake package, for ``find_package(microfacet)`` with ``-Dmicrofacet_DIR=...``.

    Returns
    -------
    str
        The folder that has ``microfacet-config.cmake``.

    Raises
    ------
    FileNotFoundError
        If microfacet runs from a source tree: installing it makes the CMake package.

    Examples
    --------
    >>> import pathlib
    >>> import microfacet as mf
    >>> pathlib.Path(mf.get_cmake_dir(), "microfacet-config.cmake").exists()
    True
    """
    folder = Path(__file__).parent / "share" / "cmake" / "microfacet"
    if not folder.is_dir():
        raise FileNotFoundError(
            f"there is no CMake package at {folder}: only an installed microfacet has one"
        )
    return str(folder)


def _version() -> str:
    # Half of the time of an import goes into this module.
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("microfacet")
    except PackageNotFoundError:  # run from a source tree that is not installed
        return "0+unknown"


def __getattr__(name: str) -> Any:
    if name == "__version__":
        globals()[name] = _version()
        return globals()[name]
    if name == "testing":
        return import_module("microfacet.testing")
    if name in _LAZY:
        value = globals()[name] = getattr(import_module(_LAZY[name]), name)
        return value
    raise AttributeError(f"module 'microfacet' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
