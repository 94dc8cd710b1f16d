"""Pictures of the families, rendered by Mitsuba 3 with our materials in scenes of our own."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from microfacet._render import passes, scenes
from microfacet._render.gallery import looks, sheet
from microfacet._render.look import GLASS, Look, metals
from microfacet._render.picture import FORMATS, display, save
from microfacet._render.scenes import SCENES
from microfacet._render.start import FALLBACK, PREFERRED, start

__all__ = [
    "FALLBACK",
    "FORMATS",
    "GLASS",
    "PREFERRED",
    "SCENES",
    "Look",
    "display",
    "looks",
    "metals",
    "render",
    "save",
    "sheet",
    "start",
]


def render(
    look: Look,
    scene: str = "preview",
    size: tuple[int, int] = (512, 512),
    spp: int = 256,
    seed: int = 0,
    progress: Callable[[int, int], None] = lambda done, total: None,
    backdrop: bool = True,
) -> npt.NDArray[np.float64]:
    """Radiance (height, width, 3), and the share of the object where there is no backdrop; after `start`."""
    try:
        built: Any = scenes.build(scene, look.bsdf(), size, look.rotation, backdrop, look.clear)
    except RuntimeError as error:  # how Mitsuba tells what is wrong with a material
        said = str(error).strip().splitlines()[-1]
        raise ValueError(re.sub(r'^.*of type "\w+": ', "", said)) from None
    return passes.render(built, size, spp, seed, progress)
