"""Balls of several families and roughnesses in one labelled picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from microfacet._family.looks import letter
from microfacet._optional import needed

__all__ = ["Sheet", "looks", "sheet"]

Array = npt.NDArray[Any]

PAPER, INK = (0.075, 0.08, 0.09), "#d8dadd"


class Sheet(NamedTuple):
    """The labels of a gallery: of its columns, in two lines each, and of its rows."""

    columns: list[tuple[str, str]]
    rows: list[str]


def looks(
    titles: Mapping[str, str], shapes: Mapping[str, Mapping[str, float]], alphas: Sequence[float]
) -> Sheet:
    """What stands above and beside the pictures."""

    def shape(name: str) -> str:
        return ", ".join(f"{letter(key)} = {value:g}" for key, value in shapes[name].items())

    return Sheet([(title, shape(name)) for name, title in titles.items()], [f"α = {x:g}" for x in alphas])


def _places(sheet_: Sheet, cell: int, left: int, top: int, gap: int) -> Iterator[tuple[int, int]]:
    for row in range(len(sheet_.rows)):
        for column in range(len(sheet_.columns)):
            yield left + column * (cell + gap), top + row * (cell + gap)


def sheet(labels: Sheet, pictures: Sequence[Array], display: Callable[[Array], Array]) -> Array:
    """8-bit sRGB (height, width, 3) of premultiplied RGBA pictures, row by row, and their labels."""
    with needed("labels need"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

    cell = pictures[0].shape[0]
    scale = cell / 150.0
    left, top, gap = (round(x * scale) for x in (66.0, 44.0, 4.0))
    width = left + len(labels.columns) * (cell + gap)
    height = top + len(labels.rows) * (cell + gap)
    paper = np.empty((height, width, 3))
    paper[:] = PAPER
    for (x, y), picture in zip(_places(labels, cell, left, top, gap), pictures, strict=True):
        colour, cover = display(picture[..., :3]), np.clip(picture[..., 3:], 0.0, 1.0)
        linear = colour + (1.0 - cover) * _linear(np.array(PAPER))
        paper[y : y + cell, x : x + cell] = _encoded(np.clip(linear, 0.0, 1.0))
    dpi = 100.0
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi, facecolor=PAPER)
    canvas: Any = FigureCanvasAgg(figure)
    figure.figimage(paper, 0, 0, origin="upper")
    points = 72.0 / dpi * scale  # of a pixel where a cell has 150

    def write(x: float, y: float, text: str, size: float, **how: Any) -> None:
        figure.text(x / width, 1.0 - y / height, text, size=size * points, color=INK, va="center", **how)

    for number, (title, shape) in enumerate(labels.columns):
        x = left + number * (cell + gap) + cell / 2
        write(x, (14 if shape else 22) * scale, title, 15.0, ha="center")
        write(x, 33 * scale, shape, 12.0, ha="center", alpha=0.75)
    for number, text in enumerate(labels.rows):
        write(left / 2, top + number * (cell + gap) + cell / 2, text, 12.5, ha="center")
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _encoded(x: Array) -> Array:
    """sRGB from linear values."""
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def _linear(x: Array) -> Array:
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
