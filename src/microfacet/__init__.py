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
from microfacet._installation import get_cmake_dir, get_include
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
    from microfacet._fit import (
        Comparison,
        Difference,
        FitResult,
        FitResults,
        Goodness,
        Halves,
        ScaleFit,
        TableFit,
        Verdict,
        compare,
        fit,
        fit_scales,
        fit_table,
    )
    from microfacet._optics import (
        AbgFit,
        BrdfTable,
        SpatialBandwidth,
        brdf_table,
        read_refractive_index,
        spatial_bandwidth,
    )
    from microfacet._profile import Profile, ProfileRoughness, ProfileSpectrum, read_profile
    from microfacet._surface import (
        Autocorrelation,
        KCorrelation,
        MaterialRatio,
        Roughness,
        SlopeSample,
        Spectrum,
        Surface,
        SurfaceError,
        autocorrelation,
        material_ratio,
        read_normal_map,
        read_slopes,
        read_surface,
        roughness,
        sample_terrain,
        spectrum,
        synthesize,
    )
    from microfacet._user_family import UserFamily

__all__ = [
    "GGX",
    "GTR",
    "K0",
    "AbgFit",
    "Autocorrelation",
    "Beckmann",
    "BesselK",
    "BrdfTable",
    "Comparison",
    "Conductor",
    "Dielectric",
    "Difference",
    "Diffuse",
    "Dirac",
    "DoubleGGX",
    "Ei",
    "Erfc",
    "Exponential",
    "Family",
    "FitResult",
    "FitResults",
    "GeneralisedExponential",
    "Goodness",
    "Halves",
    "KCorrelation",
    "KullaConty",
    "LookupTexture",
    "MaterialRatio",
    "Parameter",
    "Profile",
    "ProfileRoughness",
    "ProfileSpectrum",
    "RadialNDF",
    "Roughness",
    "ScaleFit",
    "SlopeSample",
    "SlopeTable",
    "SpatialBandwidth",
    "Spectrum",
    "StudentT",
    "Surface",
    "SurfaceError",
    "TableFit",
    "Turquin",
    "UserFamily",
    "Verdict",
    "__version__",
    "array_functions",
    "autocorrelation",
    "bake",
    "beckmann",
    "bessel_k",
    "brdf_table",
    "compare",
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
    "material_ratio",
    "read_density",
    "read_normal_map",
    "read_profile",
    "read_refractive_index",
    "read_slopes",
    "read_surface",
    "roughness",
    "sample_terrain",
    "spatial_bandwidth",
    "spectrum",
    "student_t",
    "synthesize",
    "testing",
]

__version__: str

# Loaded at first use: most need SciPy, which an `import microfacet` for the ufuncs should not wait for.
_LAZY = {
    name: module
    for module, names in {
        "microfacet._bake": "LookupTexture bake lookup_texture",
        "microfacet._bsdf": (
            "Conductor Dielectric Diffuse KullaConty Turquin fresnel_average fresnel_conductor "
            "fresnel_dielectric"
        ),
        "microfacet._density_files": "read_density",
        "microfacet._export": "export",
        "microfacet._export.arrays": "array_functions",
        "microfacet._fit": (
            "Comparison Difference FitResult FitResults Goodness Halves ScaleFit TableFit Verdict "
            "compare fit fit_scales fit_table"
        ),
        "microfacet._optics": (
            "AbgFit BrdfTable SpatialBandwidth brdf_table read_refractive_index spatial_bandwidth"
        ),
        "microfacet._profile": "Profile ProfileRoughness ProfileSpectrum read_profile",
        "microfacet._surface": (
            "Autocorrelation KCorrelation MaterialRatio Roughness SlopeSample Spectrum Surface "
            "SurfaceError autocorrelation material_ratio read_normal_map read_slopes read_surface "
            "roughness sample_terrain spectrum synthesize"
        ),
        "microfacet._user_family": "UserFamily",
    }.items()
    for name in names.split()
}


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
