"""Small pictures of a sphere, and what is measured on them; to be imported where a variant is set."""

from __future__ import annotations

import json
import sys
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

SIZE = 32
SKY = np.array([[0.2, 0.4, 3.0, 0.4], [1.0, 0.1, 0.5, 2.0], [0.1, 0.8, 0.2, 0.3]], np.float32)


def scene(bsdf: dict[str, Any], light: str, depth: int = 8) -> Any:
    """A sphere that fills the picture, in a furnace or under a sky of a few patches."""
    emitter: dict[str, Any] = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
    if light == "sky":
        patches = np.kron(SKY, np.ones((2, 2), np.float32))
        sky = mi.Bitmap(np.repeat(patches[:, :, None], 3, axis=2) * np.array([1.0, 0.7, 0.4], np.float32))
        emitter = {"type": "envmap", "bitmap": sky}
    to_world = mi.ScalarTransform4f().look_at([0, -4, 1], [0, 0, 0], [0, 0, 1])
    film = {
        "type": "hdrfilm", "width": SIZE, "height": SIZE, "pixel_format": "rgb",
        "component_format": "float32", "filter": {"type": "box"},
    }  # fmt: skip
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth, "rr_depth": 1000},
        "sensor": {"type": "perspective", "fov": 20, "to_world": to_world, "film": film},
        "emitter": emitter,
        "shape": {"type": "sphere", "bsdf": bsdf},
    })  # fmt: skip


def pictures(bsdf: dict[str, Any], light: str, seeds: int, samples: int, depth: int = 8) -> Any:
    """(seeds, SIZE, SIZE): pictures from independent numbers, their channels averaged."""
    made = scene(bsdf, light, depth)
    found = [np.array(mi.render(made, spp=samples, seed=seed)).mean(axis=-1) for seed in range(seeds)]
    return np.array(found, np.float64)


def blocks(images: Any, size: int = 4) -> Any:
    """Means over blocks of pixels."""
    n = SIZE // size
    return images.reshape(-1, n, size, n, size).mean(axis=(2, 4))


def compare(pairs: list[list[dict[str, Any]]], seeds: int, samples: int) -> list[dict[str, float]]:
    """Of every pair of BSDFs: how many standard errors their pictures lie apart."""
    found = []
    for first, second in pairs:
        a, b = blocks(pictures(first, "sky", seeds, samples)), blocks(pictures(second, "sky", seeds, samples))
        error = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / seeds)
        z = (a.mean(axis=0) - b.mean(axis=0)) / np.maximum(error, 1e-9)
        relative = float(np.median(error / a.mean(axis=0)))
        spread = float(np.sqrt(np.mean(z**2)))
        found.append({"largest": float(np.abs(z).max()), "spread": spread, "precision": relative})
    return found


def furnaces(bsdfs: list[dict[str, Any]], seeds: int, samples: int, depth: int) -> list[dict[str, float]]:
    """The mean light of the sphere's middle, its standard error, and how far its blocks lie from 1."""
    found, middle = [], slice(SIZE // 4, 3 * SIZE // 4)
    for bsdf in bsdfs:
        images = pictures(bsdf, "furnace", seeds, samples, depth)
        light, parts = images[:, middle, middle].mean(axis=(1, 2)), blocks(images)[:, 2:-2, 2:-2]
        z = (parts.mean(axis=0) - 1.0) / np.maximum(parts.std(axis=0, ddof=1) / np.sqrt(seeds), 1e-6)
        found.append({"mean": _mean(light), "error": _error(light), "farthest": float(np.abs(z).max())})
    return found


def expectations(bsdf: dict[str, Any], wi: Any, wo: Any, n: int) -> tuple[Any, Any]:
    """Means and standard errors of eval of pairs of directions, each asked n times at other points."""
    made, rng = mi.load_dict(bsdf), np.random.default_rng(1)
    si = dr.zeros(mi.SurfaceInteraction3f, n * len(wi))
    place = rng.random((2, n * len(wi))).astype(np.float32)
    si.p = mi.Point3f(mi.Float(place[0]), mi.Float(place[1]), 0.0)
    many = [np.repeat(np.asarray(w, np.float32), n, axis=0).T.copy() for w in (wi, wo)]
    si.wi = mi.Vector3f(*map(mi.Float, many[0]))
    value = np.array(made.eval(mi.BSDFContext(), si, mi.Vector3f(*map(mi.Float, many[1]))))[0].reshape(-1, n)
    return value.mean(axis=1), value.std(axis=1, ddof=1) / np.sqrt(n)


def gradients(bsdf: dict[str, Any], names: list[str], step: float, samples: int) -> dict[str, list[float]]:
    """d(mean of the picture, weighted)/d(parameter), by prb and by pictures of the same numbers."""
    made = scene(bsdf, "sky", 3)
    weights = mi.TensorXf(np.random.default_rng(2).random((SIZE, SIZE, 3)).astype(np.float32) / SIZE**2)
    found = {}
    for name in names:
        parameters = mi.traverse(made)
        key = next(k for k in list(parameters.properties) if k.endswith(f"bsdf.{name}"))
        start = mi.Float(parameters[key])

        def light(value: Any, seed: int, key: str = key, parameters: Any = parameters) -> float:
            parameters[key] = mi.Float(value)
            parameters.update()
            picture = mi.render(made, spp=samples, seed=seed)
            return float(dr.sum(picture.array * weights.array)[0])

        differences = [
            (light(start * (1 + step), seed) - light(start * (1 - step), seed)) / (2 * step * start[0])
            for seed in range(8)
        ]
        derivatives = []
        for seed in range(8):
            parameters[key] = mi.Float(start)
            dr.enable_grad(parameters[key])
            parameters.update()
            picture = mi.render(made, parameters, integrator=PRB(), spp=samples, seed=100 + seed)
            dr.backward(dr.sum(picture.array * weights.array))
            derivatives.append(float(dr.grad(parameters[key])[0]))
            dr.disable_grad(parameters[key])
        found[name] = [*(f(x) for x in (differences, derivatives) for f in (_mean, _error))]
    return found


def PRB() -> Any:
    """The differentiable path tracer."""
    return mi.load_dict({"type": "prb", "max_depth": 3})


def _mean(values: Any) -> float:
    return float(np.mean(values))


def _error(values: Any) -> float:
    return float(np.std(values, ddof=1) / np.sqrt(len(values)))


def report(function: str, arguments: str) -> None:
    """The result of a function of this module, as JSON."""
    result = getattr(sys.modules[__name__], function)(*json.loads(arguments))
    print(json.dumps(result, default=lambda array: array.tolist()))
