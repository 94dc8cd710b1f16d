"""Bodies of revolution: a profile of arcs and lines that touch, turned about the z axis.

Their texture coordinates are conformal (Mercator's): u is the azimuth and v the integral of ds/r along the
profile. dp/du and dp/dv are orthogonal and of one length everywhere, so that turning the coordinates turns
the axes along which a surface is rough by the same angle at every point.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = ["Body", "Profile", "arc", "join", "line", "mesh", "revolve", "sphere", "trophy"]

Array = npt.NDArray[np.float64]


class Profile(NamedTuple):
    """Points (n, 2) as (r, z), upwards along the outside, and the normals there."""

    points: Array
    normals: Array


class Body(NamedTuple):
    """Points along the profile and around the axis, (n, m, 3), their normals, and u, v, (n, m, 2)."""

    positions: Array
    normals: Array
    uv: Array


STEP = 0.012  # between points along a curve


def line(begin: tuple[float, float], end: tuple[float, float]) -> Profile:
    """A straight piece; outside lies to the right of its course."""
    along = np.subtract(end, begin)
    t = np.linspace(0.0, 1.0, max(2, int(np.hypot(*along) / (4.0 * STEP))))[:, None]
    normal = np.array([along[1], -along[0]]) / np.hypot(*along)
    return Profile(np.asarray(begin) + t * along, np.broadcast_to(normal, (len(t), 2)))


def arc(centre: tuple[float, float], radius: float, begin: float, end: float) -> Profile:
    """A piece of a circle from one angle (radians) to another: bulging if anticlockwise, else hollow."""
    steps = max(8, int(abs(end - begin) * radius / STEP))
    t = np.linspace(begin, end, steps)
    outwards = np.stack([np.cos(t), np.sin(t)], axis=-1)
    return Profile(np.asarray(centre) + radius * outwards, np.sign(end - begin) * outwards)


def join(*pieces: Profile) -> Profile:
    """One profile of pieces that follow one another."""
    return Profile(*(np.concatenate(parts) for parts in zip(*pieces, strict=True)))


def sphere() -> Profile:
    """The unit sphere about the origin."""
    return arc((0.0, 0.0), 1.0, -np.pi / 2.0, np.pi / 2.0)


def trophy() -> Profile:
    """A ball of radius 1 with a groove, on a foot: bulging, hollow, flat, narrow. It stands on z = 0.

    Neighbouring pieces touch: two circles where the line through their centres meets them.
    """
    bead, cove, groove, lip = 0.13, 0.22, 0.075, 0.05  # radii
    rim, ball = 0.76, (0.0, 1.47)  # where the bead and the ball have their centres
    cove_z = 2.0 * bead + cove
    cove_r = float(np.sqrt((1.0 + cove) ** 2 - (ball[1] - cove_z) ** 2))
    below = float(np.arctan2(cove_z - ball[1], cove_r))  # angle at which the cove meets the ball
    at = np.radians(33.0)  # latitude of the groove, whose centre lies on the ball
    # The triangle of the centres of ball, groove and lip: sides 1, 1 - lip and groove + lip.
    gap = float(np.arccos((1.0 + (1.0 - lip) ** 2 - (groove + lip) ** 2) / (2.0 * (1.0 - lip))))
    turn = float(np.arccos((1.0 + (groove + lip) ** 2 - (1.0 - lip) ** 2) / (2.0 * (groove + lip))))

    def on(angle: float, distance: float) -> tuple[float, float]:
        return distance * float(np.cos(angle)), ball[1] + distance * float(np.sin(angle))

    inwards = at + np.pi  # from the centre of the groove to that of the ball
    return join(
        line((0.0, 0.0), (rim, 0.0)),
        arc((rim, bead), bead, -np.pi / 2.0, np.pi / 2.0),
        line((rim, 2.0 * bead), (cove_r, 2.0 * bead)),
        arc((cove_r, cove_z), cove, 1.5 * np.pi, below + np.pi),
        arc(ball, 1.0, below, at - gap),
        arc(on(at - gap, 1.0 - lip), lip, at - gap, inwards + turn - np.pi),
        arc(on(at, 1.0), groove, inwards + turn, inwards - turn),
        arc(on(at + gap, 1.0 - lip), lip, inwards - turn - np.pi, at + gap),
        arc(ball, 1.0, at + gap, np.pi / 2.0),
    )


def revolve(profile: Profile, rotation: float = 0.0, segments: int = 256) -> Body:
    """Turn the profile about the z axis; dp/du then lies `rotation` anticlockwise of the parallels."""
    phi = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    ring = np.stack([np.cos(phi), np.sin(phi)], axis=-1)

    def turned(curve: Array) -> Array:
        radial = curve[:, None, :1] * ring
        return np.concatenate([radial, np.broadcast_to(curve[:, None, 1:], (*radial.shape[:2], 1))], axis=-1)

    points = profile.points
    r = np.maximum(points[:, 0], 1e-4)  # at the poles v is infinite
    ds = np.hypot(*np.diff(points, axis=0).T)
    v = np.concatenate([[0.0], np.cumsum(2.0 * ds / (r[1:] + r[:-1]))])
    grid = np.stack(np.broadcast_arrays(phi, v[:, None]), axis=-1)
    c, s = np.cos(rotation), np.sin(rotation)
    return Body(turned(points), turned(profile.normals), grid @ np.array([[c, -s], [s, c]]))


def mesh(body: Body, bsdf: Any) -> Any:
    """As a Mitsuba mesh with that material."""
    import mitsuba as mi

    rows, columns = body.positions.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    across = corner + columns + 1
    triangles = [[corner, corner + 1, across], [corner, across, corner + columns]]
    faces = np.concatenate([np.stack(triangle, axis=-1) for triangle in triangles])
    properties = mi.Properties()
    properties["bsdf"] = bsdf
    shape = mi.Mesh("lathe", rows * columns, len(faces), properties, True, True)
    buffers = mi.traverse(shape)
    names = ("vertex_positions", "vertex_normals", "vertex_texcoords")
    for name, values in zip(names, body, strict=True):
        buffers[name] = np.ascontiguousarray(values, dtype=np.float32).reshape(-1)
    buffers["faces"] = faces.astype(np.uint32).reshape(-1)
    buffers.update()
    return shape
