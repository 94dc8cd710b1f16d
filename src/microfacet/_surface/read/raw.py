"""A map as its file states it, before the caller's options fill in what the file leaves open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from microfacet._surface.checks import SurfaceError

__all__ = ["Channel", "NoMap", "RawMap", "profile_error", "slopes_error"]


@dataclass(frozen=True)
class RawMap:
    """Heights with the lowest row first, and what the file says about them.

    Attributes
    ----------
    heights : ndarray, shape (ny, nx)
        In `unit`, or in grey levels.
    kind : str
        What the file is, for display.
    size : (float, float), optional
        The pixel size in `size_unit`.
    one_unit : bool
        Whether a size without a unit of its own is in that of the heights.
    unit, size_unit : str, optional
        As stated in the file; None where it states none.
    usual : str, optional
        The unit of lengths where neither the file nor the caller states one.
    convention : bool
        Whether `usual` is the convention of the format; else a warning says that it was taken.
    channel : str, optional
        The name of the map in a file of several.
    mask : ndarray of bool, optional
        True where a height is valid.
    image : bool
        Whether the heights may be given as metres per grey level.
    bits : int
        Bits of the levels of an image; 0 for floating-point numbers and for anything else.
    firm : bool
        Whether a stated pixel size stands in a heading that people can change: no option contradicts it.
    microscope : bool
        Whether an instrument wrote the file, whose pixels are small.
    no_size : str, optional
        The sentence that asks for a pixel size.
    steps, warnings : tuple of str
        What was done, and what is doubtful.
    """

    heights: NDArray[Any]
    kind: str
    size: tuple[float, float] | None = None
    unit: str | None = None
    size_unit: str | None = None
    usual: str | None = None
    convention: bool = True
    one_unit: bool = True
    channel: str | None = None
    mask: NDArray[Any] | None = None
    image: bool = False
    bits: int = 0
    firm: bool = False
    microscope: bool = False
    no_size: str | None = None
    steps: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Channel:
    """What a file says of one of its maps without its heights being read."""

    name: str
    index: int
    pixels: tuple[int, ...]
    unit: str | None = None
    is_height: bool = True

    @property
    def kind(self) -> str:
        """What the channel holds, for display."""
        return "heights" if self.is_height else f"no heights, {self.unit or 'by its name'}"


class NoMap(SurfaceError):
    """A file that holds something else that can be read: `kind` says what."""

    def __init__(self, kind: str, sentence: str) -> None:
        super().__init__(sentence)
        self.kind = kind


def slopes_error() -> NoMap:
    """The sentence for a file that holds slopes."""
    return NoMap(
        "slopes", "this is a table of slopes, not a map: read it with mf.read_slopes (--slopes table)"
    )


def profile_error(what: str) -> NoMap:
    """The sentence for a file that holds heights along a line."""
    return NoMap(
        "profile",
        f"this is a profile ({what}): read it with mf.read_profile, or fit it with microfacet fit --profile",
    )
