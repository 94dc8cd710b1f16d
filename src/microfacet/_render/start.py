"""Mitsuba, with a variant that runs here and our materials."""

from __future__ import annotations

from collections.abc import Callable

from microfacet._optional import needed

__all__ = ["FALLBACK", "PREFERRED", "start"]

PREFERRED, FALLBACK = "llvm_ad_rgb", "scalar_rgb"


def start(variant: str, warn: Callable[[str], None]) -> str:
    """Set `variant`, or FALLBACK with a warning where LLVM does not work; which one it is.

    A library that Dr.Jit cannot work with ends the process that uses it, so it is tried in another first.
    """
    with needed("rendering needs"):
        import mitsuba as mi

    if variant not in mi.variants():
        raise ValueError(f"variant must be one of {', '.join(mi.variants())}, got {variant!r}")
    import microfacet.mitsuba  # noqa: F401  # from here on set_variant registers the materials
    from microfacet.mitsuba import _llvm

    if variant.startswith("llvm"):
        works, reason = _llvm.usable()
        if not works:
            warn(f"{FALLBACK} in place of {variant}, which takes many times as long: {reason}")
            variant = FALLBACK
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    return variant
