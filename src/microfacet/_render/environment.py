"""Rooms of a photographer as light from infinitely far, computed: dark, with few lights.

Small lights show what a distribution does: the core of a reflection is the density's, the glow around it its
tail.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["HORIZON", "directions", "emitter", "irradiance", "room", "studio"]

Array = npt.NDArray[np.float64]
Light = Callable[[Array], Array]

COOL = np.array([0.92, 1.0, 1.12])
HORIZON = 0.07 * COOL

HEIGHT = 512  # rows; twice as many columns
FLOOR = 2.4  # how far below the centre the chequered floor lies, in squares of length 1


def directions(height: int = HEIGHT) -> Array:
    """Unit vectors (height, 2 height, 3), z up, through the centres of a latitude-longitude map's pixels."""
    theta = (np.arange(height) + 0.5)[:, None] / height * np.pi
    phi = (np.arange(2 * height) + 0.5) / height * np.pi
    parts = (np.sin(theta) * np.sin(phi), np.sin(theta) * np.cos(phi), np.cos(theta) + 0.0 * phi)
    return np.stack(parts, axis=-1)


def _unit(azimuth: float, elevation: float) -> Array:
    """The camera looks along +y, x is to its right; degrees."""
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)])


def _step(x: Array, edge: float, width: float) -> Array:
    """From 1 below `edge` to 0 above it, smooth over `width`."""
    t = np.clip((edge - x) / width + 0.5, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _disc(w: Array, azimuth: float, elevation: float, radius: float) -> Array:
    """A round light; its radius in degrees."""
    angle = np.degrees(np.arccos(np.clip(w @ _unit(azimuth, elevation), -1.0, 1.0)))
    return _step(angle, radius, 0.5)


def _panel(w: Array, azimuth: float, elevation: float, size: tuple[float, float]) -> Array:
    """A flat rectangular light at distance 1 that faces the centre, upright; its half sides as tangents."""
    centre = _unit(azimuth, elevation)
    right = np.cross([0.0, 0.0, 1.0], centre)
    right /= np.linalg.norm(right)
    ahead = np.maximum(w @ centre, 1e-6)
    x, y = np.abs(w @ right) / ahead, np.abs(w @ np.cross(centre, right)) / ahead
    return _step(x, size[0], 0.02) * _step(y, size[1], 0.02) * (w @ centre > 1e-3)


def _floor(w: Array) -> Array:
    """A chequered plane that fades with the distance."""
    down = np.maximum(-w[..., 2], 1e-3)
    x, y = FLOOR * w[..., 0] / down, FLOOR * w[..., 1] / down + 0.5
    softness = np.maximum(0.02 * (1.0 + (x * x + y * y)), 1e-3)
    waves = np.clip(np.sin(np.pi * x) * np.sin(np.pi * y) / softness, -1.0, 1.0)
    return np.asarray(0.085 + 0.06 * waves * np.exp(-0.02 * (x * x + y * y)))


def room(w: Array, soft: bool = False) -> Array:
    """RGB along directions (..., 3): small lights for a ball, and a floor that is part of the picture.

    `soft`: larger and dimmer ones over a brighter floor. Rough glass scatters a small lamp into so many paths
    that some are too rare to average out.
    """
    up = w[..., 2]
    wall = 0.02 + 0.07 * np.exp(-4.0 * np.abs(up))
    floor = _floor(w) * (1.8 if soft else 1.0)
    light = np.where(up < 0.0, floor, wall)[..., None] * COOL
    wide, lamp, strip = (3.0, 0.12, 0.4) if soft else (1.0, 1.0, 1.0)
    for shape, scale, colour in (
        (_panel(w, -130.0, 48.0, (0.34, 0.34)), 1.0, (4.2, 4.0, 3.6)),  # behind the camera, to the left
        (_disc(w, 130.0, 22.0, 4.0 * wide**0.75), lamp, (52.0, 45.0, 37.0)),  # to the right
        (_panel(w, 62.0, 14.0, (0.06 * wide, 0.75)), strip, (4.4, 5.0, 5.9)),  # tall, behind the shoulder
        (_panel(w, -58.0, -4.0, (0.04 * wide, 0.5)), strip, (3.0, 3.4, 4.0)),
    ):
        light = light + shape[..., None] * (scale * np.array(colour))
    return np.asarray(light)


def studio(w: Array) -> Array:
    """RGB along directions (..., 3): softboxes for a body on a floor, and HORIZON from the horizon down."""
    fade = np.exp(-5.0 * np.maximum(w[..., 2], 0.0))[..., None]
    light = HORIZON * (0.35 + 0.65 * fade)
    for shape, colour in (
        (_panel(w, -136.0, 42.0, (0.5, 0.5)), (2.9, 2.75, 2.5)),
        (_panel(w, 132.0, 24.0, (0.24, 0.24)), (3.2, 3.3, 3.5)),
        (_disc(w, 160.0, 68.0, 13.0), (4.6, 4.3, 3.8)),
        (_panel(w, 50.0, 30.0, (0.3, 0.5)), (2.1, 2.35, 2.8)),
        (_panel(w, -56.0, 28.0, (0.24, 0.5)), (1.8, 1.65, 1.45)),
    ):
        light = light + shape[..., None] * np.array(colour)
    return np.asarray(light)


def irradiance(light: Light, height: int = 256) -> Array:
    """RGB that falls on a horizontal floor."""
    w = directions(height)
    theta = (np.arange(height) + 0.5)[:, None] / height * np.pi
    solid_angle = np.sin(theta) * (np.pi / height) ** 2
    return np.asarray(np.einsum("ij,ijk->k", solid_angle * np.maximum(w[..., 2], 0.0), light(w)))


def emitter(light: Light, height: int = HEIGHT) -> dict[str, Any]:
    """The surroundings as Mitsuba takes them; a variant has to be set."""
    import mitsuba as mi

    picture = light(directions(height)).astype(np.float32)
    upright = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    return {"type": "envmap", "bitmap": mi.Bitmap(picture), "to_world": upright}
