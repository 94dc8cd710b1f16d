"""From what a file states and the caller adds to a `Surface`, or to one sentence: what is missing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from microfacet._surface.checks import METRES_PER_UNIT, SurfaceError, pixel_sizes, positive, short
from microfacet._surface.read.marks import suspicious_mark
from microfacet._surface.read.raw import RawMap
from microfacet._surface.read.units import agreed_unit
from microfacet._surface.surface import Surface
from microfacet._text import printable

__all__ = ["Options", "complete", "known_size", "known_unit"]

Size = tuple[float, float]

# Two statements of a size that differ by less are one, rounded.
_SAME = 0.01
# Pixels of the instruments whose files the library reads; what lies outside is a unit gone wrong.
_SMALLEST, _LARGEST = 1e-12, 5e-3


@dataclass(frozen=True)
class Options:
    """What the caller says about a file."""

    size: Size | None = None
    unit: str | None = None
    scale: float | None = None

    @classmethod
    def checked(cls, pixel_size: Any, unit: str | None, height_scale: float | None) -> Options:
        """The arguments of `read_surface`."""
        if unit is not None and unit not in METRES_PER_UNIT:
            raise SurfaceError(f"unit must be one of {', '.join(METRES_PER_UNIT)}, got {short(unit)}")
        if height_scale is not None and unit is not None:
            raise SurfaceError("height_scale is in metres per grey level and goes without a unit")
        return cls(
            None if pixel_size is None else pixel_sizes(pixel_size),
            unit,
            None if height_scale is None else positive(height_scale, "height_scale"),
        )


def complete(file: Path, raw: RawMap, options: Options) -> Surface:
    """The surface; `SurfaceError` where something is missing, contradicts or cannot be."""
    if options.scale is not None and not raw.image:
        raise SurfaceError("height_scale is for images, in metres per grey level")
    unit, factor = known_unit(raw, options)
    steps, warnings = list(raw.steps), list(raw.warnings)
    if options.scale is not None:
        steps.append(f"heights of {options.scale:g} m per grey level, as given by the caller")
    elif raw.unit is None and options.unit is None and not raw.convention:
        warnings.append(
            f"the file states no unit, so its heights are taken for {unit} (unit= says otherwise)"
        )
    size = _size(raw, options, unit, steps, warnings)
    if raw.bits == 8:
        step = factor / (2 * max(size))
        warnings.append(
            f"the image has 8 bits: heights come in steps of {factor:g} m, which are slopes of {step:.2g} at "
            "a lag of 1 pixel"
        )
    source = printable(file.name, 255)
    surface = Surface(raw.heights, size, raw.mask, unit, source, tuple(steps))  # type: ignore[arg-type]
    warnings += suspicious_mark(surface.heights, surface.mask)
    if factor == 1.0 and not warnings:
        return surface
    heights = surface.heights if factor == 1.0 else surface.heights * factor
    return replace(surface, heights=heights, warnings=tuple(warnings))


def known_unit(raw: RawMap, options: Options) -> tuple[str, float]:
    """The unit of the heights, for display, and metres in one."""
    if options.scale is not None:
        return "m", options.scale
    if raw.bits and raw.usual is None and raw.unit is None:
        raise SurfaceError(
            "grey levels are no lengths, give height_scale (--scale), the metres per grey level"
        )
    unit = agreed_unit(raw.unit, options.unit) or raw.usual
    if unit is None:
        if raw.image:
            raise SurfaceError(
                "the image does not state its unit of length, give unit= (--unit) or height_scale="
            )
        raise SurfaceError("the file does not state its unit of length, give unit=, for example unit='um'")
    return unit, METRES_PER_UNIT[unit]


def known_size(raw: RawMap, unit: str | None) -> Size | None:
    """The pixel size in metres as the file states it, in its own unit or that of the heights."""
    unit = raw.size_unit or (unit if raw.one_unit or raw.unit is None else None)
    if raw.size is None or unit is None:
        return None
    if unit not in METRES_PER_UNIT:
        raise SurfaceError(
            f"the file states the pixel size in {short(unit[:20])}, which is not a known length"
        )
    factor = METRES_PER_UNIT[unit]
    # Grids may run down or left in their own coordinates; a size of zero is refused where sizes are checked.
    return abs(raw.size[0]) * factor, abs(raw.size[1]) * factor


def _size(raw: RawMap, options: Options, unit: str, steps: list[str], warnings: list[str]) -> Size:
    stated, given = known_size(raw, unit), options.size
    if given is None:
        if stated is None:
            raise SurfaceError(
                raw.no_size
                or "the file does not state its pixel size, give pixel_size (--pixel-size) in metres"
            )
        if raw.microscope:
            _refuse_what_no_instrument_has(pixel_sizes(stated))
        return pixel_sizes(stated)
    steps.append("pixel size given by the caller")
    if stated is not None and any(
        abs(one - other) > _SAME * other for one, other in zip(stated, given, strict=True)
    ):
        said = f"the file states a pixel of {stated[0]:.6g} x {stated[1]:.6g} m"
        if raw.firm:
            raise SurfaceError(f"{said}, not {given[0]:.6g} x {given[1]:.6g} m as given: correct one of them")
        warnings.append(f"{said}, which the caller replaced by {given[0]:.6g} x {given[1]:.6g} m")
    return given


def _refuse_what_no_instrument_has(size: Size) -> None:
    if min(size) < _SMALLEST or max(size) > _LARGEST:
        raise SurfaceError(
            f"the file states a pixel of {size[0]:.4g} x {size[1]:.4g} m, which no microscope or profiler "
            "has: give pixel_size (--pixel-size) in metres to correct it, or to confirm it"
        )


def all_equal(surface: Surface) -> bool:
    """Whether all valid heights are one number."""
    valid: dict[str, Any] = {"where": surface.mask}
    lowest = np.min(surface.heights, initial=np.inf, **valid)
    return bool(lowest == np.max(surface.heights, initial=-np.inf, **valid))
