"""Trace light over explicit Gaussian surfaces, compare with the random walk: writes docs/traced_surface.md.

    python tools/trace_surface.py [--rays 4000000] [--output docs/traced_surface.md]

A height field whose slopes are Beckmann's is triangulated, and white mirrors on it are traced with Mitsuba's
ray intersection until light leaves. Nothing of Smith's model goes into it, so the differences are what his
assumptions (heights of facets that do not know of each other) cost.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

import microfacet as mf

Array = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[1]
PIXELS = 1536
CORRELATION = 16  # pixels: facets are small beside the undulations that they make up
MARGIN = 0.25  # of the map on each side, in which no light is shot
MOST = 64  # facets
OFFSET = 0.01  # pixels off a facet, well above the rounding of coordinates in single precision
CELLS = (6, 8)  # of cos(theta)^2 and azimuth, of equal projected area
ORDERS = 4


@dataclass(frozen=True)
class Lobe:
    """Shares of the light by order (the last for all higher ones) and by direction, and of how many rays."""

    orders: Array
    cells: Array
    mean_order: float
    rays: int


class Field:
    """A triangulated height field on a unit grid."""

    def __init__(self, alpha: float, seed: int) -> None:
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_rgb")
        self.drjit, self.mitsuba = drjit, mitsuba
        surface = mf.synthesize(
            mf.Beckmann(alpha=alpha), (PIXELS, PIXELS), 1.0, correlation_length=CORRELATION, seed=seed
        )
        self.heights = surface.heights
        slopes = surface.slopes(1)
        self.alpha = float(np.sqrt(np.mean(slopes**2) * 2))
        mesh = mitsuba.Mesh("surface", PIXELS * PIXELS, 2 * (PIXELS - 1) ** 2)
        parameters = mitsuba.traverse(mesh)
        y, x = np.mgrid[0:PIXELS, 0:PIXELS].astype(np.float32)
        points = np.stack((x, y, self.heights.astype(np.float32)), axis=-1)
        i, j = np.mgrid[0 : PIXELS - 1, 0 : PIXELS - 1]
        corner = (i * PIXELS + j).ravel()
        faces = np.concatenate(
            (
                np.stack((corner, corner + 1, corner + PIXELS), axis=-1),
                np.stack((corner + 1, corner + PIXELS + 1, corner + PIXELS), axis=-1),
            )
        )
        parameters["vertex_positions"] = mitsuba.Float(points.ravel())
        parameters["faces"] = mitsuba.UInt32(faces.astype(np.uint32).ravel())
        parameters.update()
        self.scene = mitsuba.load_dict({"type": "scene", "mesh": mesh})

    def trace(self, wi: Array, rays: int, seed: int) -> tuple[Array, NDArray[np.int64]]:
        """Directions in which light from `wi` leaves, and how many facets it met."""
        rng = np.random.default_rng(seed)
        target = PIXELS * (MARGIN + (1 - 2 * MARGIN) * rng.random((rays, 2)))
        height = float(self.heights.max()) + 1.0
        origin = np.column_stack((target + wi[:2] / wi[2] * height, np.full(rays, height)))
        direction = np.broadcast_to(-wi, origin.shape).copy()
        met = np.zeros(rays, dtype=np.int64)
        alive = np.arange(rays)
        for _ in range(MOST):
            hit, normal, at = self._meet(origin[alive], direction[alive])
            alive = alive[hit]
            if alive.size == 0:
                break
            d = direction[alive]
            cosine = np.sum(d * normal, axis=1, keepdims=True)
            direction[alive] = d - 2 * cosine * normal
            origin[alive] = at + OFFSET * normal
            met[alive] += 1
        return direction, met

    def _meet(self, origin: Array, direction: Array) -> tuple[NDArray[np.bool_], Array, Array]:
        mi = self.mitsuba
        ray = mi.Ray3f(mi.Point3f(*origin.T.astype(np.float32)), mi.Vector3f(*direction.T.astype(np.float32)))
        found = self.scene.ray_intersect_preliminary(ray)
        hit = np.array(found.is_valid())
        at = origin + np.array(found.t, dtype=np.float64)[:, None] * direction
        # The normal of the triangle, in double precision.
        face = np.array(found.prim_index).astype(np.int64)[hit]
        return hit, self._normals(face), at[hit]

    def _normals(self, face: NDArray[np.int64]) -> Array:
        cells = (PIXELS - 1) ** 2
        upper, cell = face >= cells, face % cells
        i, j = cell // (PIXELS - 1), cell % (PIXELS - 1)
        h = self.heights
        p = np.where(upper, h[i + 1, j + 1] - h[i + 1, j], h[i, j + 1] - h[i, j])
        q = np.where(upper, h[i + 1, j + 1] - h[i, j + 1], h[i + 1, j] - h[i, j])
        n = np.stack((-p, -q, np.ones_like(p)), axis=-1)
        return np.asarray(n / np.linalg.norm(n, axis=1, keepdims=True))


def lobe(wo: Array, order: NDArray[np.int64]) -> Lobe:
    """Shares of what leaves upwards."""
    up = (wo[:, 2] > 0) & (order > 0)
    w, k = wo[up], order[up]
    orders = np.array([np.mean(k == n) for n in range(1, ORDERS)] + [np.mean(k >= ORDERS)])
    phi = np.abs(np.arctan2(w[:, 1], w[:, 0]))  # symmetric about the plane of incidence
    cells, _, _ = np.histogram2d(w[:, 2] ** 2, phi, bins=CELLS, range=((0, 1), (0, np.pi)))
    return Lobe(orders, cells / len(w), float(k.mean()), len(w))


def walked(alpha: float, wi: Array, rays: int) -> Lobe:
    """The same by the random walk."""
    mirror = mf.Conductor(mf.Beckmann(alpha=alpha), scattering="multiple")
    wo, _, order = mirror.walk(np.broadcast_to(wi, (rays, 3)), rng=7)
    return lobe(wo, order)


def compare(fields: list[Field], degrees: float, rays: int) -> tuple[float, Lobe, Lobe]:
    """The alpha of the maps, and both lobes."""
    theta = np.radians(degrees)
    wi = np.array([np.sin(theta), 0.0, np.cos(theta)])
    traced = [field.trace(wi, rays // len(fields), seed) for seed, field in enumerate(fields)]
    directions, orders = (np.concatenate(parts) for parts in zip(*traced, strict=True))
    alpha = float(np.mean([field.alpha for field in fields]))
    return alpha, lobe(directions, orders), walked(alpha, wi, rays)


INTRODUCTION = """\
# The random walk beside traced surfaces

Written by `tools/trace_surface.py` (`make docs-traced`); do not edit.

White mirrors on explicit Gaussian surfaces (`microfacet.synthesize` of Beckmann, {pixels} x {pixels} pixels,
correlation length {correlation} pixels, four maps each), traced with Mitsuba 3 until light leaves, against
`Conductor(..., scattering="multiple").walk` at the alpha that the facets of the maps have. {rays:,} rays
each. *Orders* are the shares of light that met 1, 2, 3 and more facets. *Lobe* is half the sum of the
absolute differences between the shares of {cells} cells of equal projected area (0 for the same lobe, 1 for
lobes that do not meet), beside what two samples of this size from one lobe would give.

| alpha | incidence | orders, traced | orders, walk | mean order | lobe | by chance |
|---|---|---|---|---|---|---|
"""
CONCLUSION = """
The walk is exact for Smith's surface, whose facets lie at heights that know nothing of each other. On a real
Gaussian surface neighbours lie at similar heights, and what the table shows beyond chance is what that costs.
"""


def row(alpha: float, degrees: float, traced: Lobe, walk: Lobe) -> str:
    """One line of the table."""
    distance = 0.5 * float(np.abs(traced.cells - walk.cells).sum())
    share = 0.5 * (traced.cells + walk.cells)
    chance = float(np.sqrt(share * (1 - share) / traced.rays / np.pi).sum())
    shares = [" ".join(f"{100 * x:.2f}" for x in one.orders) for one in (traced, walk)]
    return (
        f"| {alpha:.3f} | {degrees:g}° | {shares[0]} % | {shares[1]} % "
        f"| {traced.mean_order:.3f}, {walk.mean_order:.3f} | {distance:.4f} | {chance:.4f} |\n"
    )


@click.command()
@click.option("--rays", type=click.IntRange(1000), default=2_000_000, show_default=True)
@click.option("--output", type=click.Path(dir_okay=False, path_type=Path))
def main(rays: int, output: Path | None) -> None:
    """Trace, compare, and write the page."""
    cells = CELLS[0] * CELLS[1]
    text = INTRODUCTION.format(pixels=PIXELS, correlation=CORRELATION, rays=rays, cells=cells)
    for alpha in (0.3, 0.6, 1.0):
        fields = [Field(alpha, seed) for seed in range(4)]
        for degrees in (0.0, 45.0, 75.0):
            measured, traced, walk = compare(fields, degrees, rays)
            line = row(measured, degrees, traced, walk)
            click.echo(line, nl=False)
            text += line
    target = output or ROOT / "docs" / "traced_surface.md"
    target.write_text(text + CONCLUSION, encoding="utf-8")
    click.echo(str(target))


if __name__ == "__main__":
    main()
