"""A ball in a dark room with small lights, and a turned body on a chequered floor between softboxes.

All of it is computed here; no model and no picture is loaded.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from microfacet._render import environment, lathe

__all__ = ["SCENES", "build"]

Array = npt.NDArray[np.float64]

CAMERAS: dict[str, dict[str, Any]] = {
    "sphere": {"origin": [0.0, -6.2, 1.3], "target": [0.0, 0.0, 0.0], "fov": 21.0},
    "preview": {"origin": [0.0, -7.6, 3.3], "target": [0.0, 0.0, 1.13], "fov": 23.0},
}
CLOSE = {"fov": 19.0}  # nothing to see beside the ball
SCENES = tuple(CAMERAS)


def build(
    name: str,
    bsdf: Any,
    size: tuple[int, int],
    rotation: float = 0.0,
    backdrop: bool = True,
    clear: bool = False,
) -> Any:
    """A scene that shows `bsdf`, whose axes of roughness are turned by `rotation` (radians).

    Without `backdrop` what lies behind the object is left transparent. `clear`: light passes through it.
    """
    import mitsuba as mi

    content = _room(bsdf, rotation, clear) if name == "sphere" else _studio(bsdf, rotation)
    depth = 20 if clear else 6
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {
                "type": "path",
                "max_depth": depth,
                "rr_depth": depth // 2,
                "hide_emitters": not backdrop,
            },
            "sensor": _camera(CAMERAS[name] if backdrop else CAMERAS[name] | CLOSE, size, backdrop),
            **content,
        }
    )


def _camera(view: dict[str, Any], size: tuple[int, int], backdrop: bool) -> dict[str, Any]:
    """A box filter: pixels share no samples, so that their sums do not depend on the order of threads."""
    import mitsuba as mi

    return {
        "type": "perspective",
        "fov": view["fov"],
        "fov_axis": "smaller",
        "to_world": mi.ScalarTransform4f().look_at(view["origin"], view["target"], [0, 0, 1]),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
            "pixel_format": "rgb" if backdrop else "rgba",
            "component_format": "float32",
        },
        "sampler": {"type": "multijitter"},
    }


def _room(bsdf: Any, rotation: float, clear: bool) -> dict[str, Any]:
    import mitsuba as mi

    turned = lathe.mesh(lathe.revolve(lathe.sphere(), rotation), mi.load_dict(bsdf)) if rotation else None
    return {
        "room": environment.emitter(partial(environment.room, soft=clear)),
        "object": turned or {"type": "sphere", "bsdf": bsdf},
    }


def _studio(bsdf: Any, rotation: float) -> dict[str, Any]:
    import mitsuba as mi

    # Far away the floor is as bright as the horizon: they meet without an edge.
    far = environment.HORIZON * np.pi / environment.irradiance(environment.studio)
    tiles = {
        "type": "bitmap",
        "bitmap": mi.Bitmap(_tiles(far)),
        "raw": True,
        "wrap_mode": "clamp",
        "to_uv": mi.ScalarTransform4f()
        .translate([0.5, 0.5, 0])
        .scale(FLOOR / TILED)
        .translate([-0.5, -0.5, 0]),
    }
    return {
        "room": environment.emitter(environment.studio),
        "object": lathe.mesh(lathe.revolve(lathe.trophy(), rotation), mi.load_dict(bsdf)),
        "floor": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().translate([0, 0, -1e-3]).scale(FLOOR),
            "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": tiles}},
        },
    }


FLOOR = 1000.0  # half side of the floor
TILED = 8.0  # and of the picture in its middle


def _tiles(far: Array, pixels: int = 1024) -> Any:
    """Squares of half a unit, light and dark, that fade into `far`: reflectances (pixels, pixels, 3)."""
    x = ((np.arange(pixels) + 0.5) / pixels * 2.0 - 1.0) * TILED
    y = x[:, None]
    softness = 2.0 * np.pi * 2.0 * TILED / pixels
    waves = np.clip(np.sin(2.0 * np.pi * x) * np.sin(2.0 * np.pi * y) / softness, -1.0, 1.0)
    fade = np.exp(-(((x * x + y * y) / 4.4**2) ** 2))[..., None]
    near = (0.22 + 0.17 * waves)[..., None] * np.array([1.02, 1.0, 0.97])
    return (fade * near + (1.0 - fade) * far).astype(np.float32)
