"""All families as materials of Mitsuba 3: `microfacet_conductor` and `microfacet_dielectric`.

Importing this module registers both plugins for the variant that is set, and for each that
`mitsuba.set_variant` sets later. They are compiled from the headers of this package the first time that a
variant is used (some seconds; `cache_directory` keeps them) and compared with Mitsuba's own
`roughconductor` and `roughdielectric` before they are let in.

Needs the extra ``mitsuba`` (``pip install ".[mitsuba]"`` in a checkout) and, on Linux, g++ 11 or newer;
``CXX`` names another compiler.

Examples
--------
>>> import mitsuba as mi
>>> mi.set_variant("scalar_rgb")
>>> import microfacet.mitsuba
>>> bsdf = mi.load_dict({"type": "microfacet_conductor", "distribution": "student_t", "gamma": 2.5})
>>> bool(mi.has_flag(bsdf.flags(), mi.BSDFFlags.GlossyReflection))
True
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

from microfacet._optional import needed
from microfacet.mitsuba._table import table, write_table

if sys.platform == "win32":
    raise ImportError("microfacet.mitsuba compiles its plugins on Linux and macOS only")
with needed("microfacet.mitsuba needs"):
    import mitsuba as mi

    from microfacet.mitsuba import _build, _cache, _llvm

__all__ = ["cache_directory", "register", "table", "write_table"]

_libraries: dict[str, ctypes.CDLL] = {}  # by variant


def register(variant: str | None = None) -> None:
    """Register the plugins for a variant: compile, compare with Mitsuba's own, load.

    An import of `microfacet.mitsuba` and `mitsuba.set_variant` after it call this; calling it again does
    nothing. By itself it serves to compile ahead, for the image of a container say.

    Parameters
    ----------
    variant : str, optional
        A name from `mitsuba.variants()`; the variant that is set by default.

    Raises
    ------
    ValueError
        For a name that is no variant, or without one where none is set.
    ImportError
        Where the plugins cannot be had, with the reason in one sentence: there is no compiler or not one that
        fits Mitsuba's libraries, the sources do not compile, what they give disagrees with Mitsuba's own
        plugins, or Dr.Jit has no LLVM library that it can work with.

    Examples
    --------
    >>> import mitsuba as mi
    >>> import microfacet.mitsuba
    >>> mi.set_variant("scalar_rgb")
    >>> microfacet.mitsuba.register()
    """
    if variant is None and (variant := mi.variant()) is None:
        raise ValueError("there is no variant to register plugins for: call mitsuba.set_variant first")
    if variant not in mi.variants():
        raise ValueError(f"variant must be one of {', '.join(mi.variants())}, got {variant!r}")
    if variant in _libraries:
        return
    if variant.startswith("llvm"):
        usable, reason = _llvm.usable()
        if not usable:
            raise ImportError(f"the plugins for {variant} cannot run: {reason}")
    library = ctypes.CDLL(str(_build.library(variant)))
    library.microfacet_register.restype = ctypes.c_char_p
    refusal = library.microfacet_register()
    if refusal is not None:
        raise ImportError(f"Mitsuba refused the plugins for {variant}: {refusal.decode(errors='replace')}")
    _libraries[variant] = library


def cache_directory() -> Path:
    """The folder that keeps compiled plugins; it can be deleted at any time.

    The environment variable ``MICROFACET_CACHE`` chooses another than the usual one of the user.

    Returns
    -------
    pathlib.Path
        An absolute path; the folder need not exist yet.

    Examples
    --------
    >>> import microfacet.mitsuba
    >>> microfacet.mitsuba.cache_directory().name
    'mitsuba'
    """
    return _cache.directory()


def _variant_changed(_: str | None, variant: str | None) -> None:
    if variant is not None:
        register(variant)


if mi.variant() is not None:
    register()
mi.detail.add_variant_callback(_variant_changed)
