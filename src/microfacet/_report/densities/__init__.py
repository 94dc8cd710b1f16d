"""The page of densities of one's own: what they are, and every figure that families have."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from microfacet import plot
from microfacet._files import replacing
from microfacet._report import Progress, figure
from microfacet._report.families import figures, materials, sampling
from microfacet._report.families.parameters import Example
from microfacet._report.figure import FigureBlock
from microfacet._report.page import set_page

__all__ = ["DensitySection", "write"]

_FIGURES = 11


@dataclass(frozen=True)
class DensitySection:
    """One density: the record of its family, facts about it, its figures."""

    family: Any
    facts: tuple[tuple[str, str], ...]
    figures: tuple[FigureBlock, ...]


def write(path: str | Path, families: Sequence[Any], alpha: float | None, progress: Progress) -> Path:
    """Draw and set the page, and put it in place of `path` once it is complete.

    Parameters
    ----------
    path : path
        The HTML file.
    families : sequence of UserFamily
        Of one density each.
    alpha : float, optional
        Roughness of the curves, in place of that which a density brings.
    progress : callable
        Called with (what begins, steps done, steps in all).

    Returns
    -------
    Path
        Of the page, absolute.
    """
    target = Path(path).absolute()
    if not target.parent.is_dir():
        raise ValueError(f"output must lie in an existing folder, got {str(path)!r}")
    sections = []
    with figure.style():
        for number, family in enumerate(families):
            blocks: list[FigureBlock] = []
            for block in _drawn(family, _example(family, alpha)):
                progress(
                    f"{family.title}: figures", number * _FIGURES + len(blocks), _FIGURES * len(families)
                )
                blocks.append(block)
            sections.append(DensitySection(family, _facts(family), tuple(blocks)))
    page = set_page("densities.html.j2", sections=sections)
    with replacing(target) as stream:
        stream.write(page.encode())
    return target


def _drawn(family: Any, example: Example) -> Any:
    """The figures of a density; without a mean slope it has neither sigma nor visible normals."""
    if not np.isfinite(family.ndf.sigma(np.array([0.6, 0.0, 0.8]))):
        return itertools.islice(figures.family_figures(family, example), 2)
    return itertools.chain(
        figures.family_figures(family, example),
        sampling.sampling_figures(family, example),
        materials.material_figures(family, example),
    )


def _example(family: Any, alpha: float | None) -> Example:
    """Isotropic, as the figures are: of two axes the mean."""
    x, y, _ = family.ndf._values
    middle = float(np.sqrt(x * y)) if alpha is None else alpha
    curves = family.cls(alpha=middle)
    roughness = tuple(family.cls(alpha=middle * factor) for factor in (0.5, 1.0, 2.0))
    return Example(curves, roughness, (), curves, curves)


def _facts(family: Any) -> tuple[tuple[str, str], ...]:
    ndf = family.ndf
    roughness = ", ".join(f"{n} {v:.6g}" for n, v in plot.short_parameters(ndf.parameters).items())
    mean = float(ndf.with_roughness(1.0).sigma(np.array([1.0, 0.0, 0.0])) * np.pi)
    known = np.isfinite(mean)
    return (
        ("Roughness", roughness),
        ("Integral of P22 as it was given", f"{ndf.norm:.6g}"),
        ("Mean slope at alpha = 1", f"{mean:.6g}" if known else "infinite: there is no projected area"),
        ("Largest relative error of the tables", f"{ndf.error:.1e}" if known else "-"),
        ("Tables", ndf._identity[:8]),
    )
