"""Spheres of a metal that absorbs nothing, under light of 1 from everywhere: they should not be seen.

python examples/python/furnace_sphere.py [PICTURE.png] [SAMPLES PER PIXEL]

With scattering of one order they are dark: light that a facet sends to another facet is lost. With all
orders it comes out again, and only noise is left of the spheres. Directions wo are drawn from the density
that `pdf` of the material states, by its two parts, and `eval` is asked about them.
"""

import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

import microfacet as mf

PIXELS = 64
DISTRIBUTIONS = {
    "Beckmann": mf.Beckmann(alpha=0.8),
    "GGX": mf.GGX(alpha=0.8),
    "K0": mf.K0(alpha=0.8),
}


def views():
    """The pixels that see the sphere, and there the direction to the camera in the frame of the surface."""
    x = (np.arange(PIXELS) + 0.5) / PIXELS * 2.2 - 1.1
    r2 = x**2 + x[:, None] ** 2
    seen = r2 < 1.0
    r = np.sqrt(r2[seen])
    return seen, np.stack([r, np.zeros_like(r), np.sqrt(1.0 - r**2)], axis=-1)


def proposals(ndf, wi, rng):
    """Directions of the density of Conductor.pdf with multiple scattering: 3/4 a lobe, 1/4 a cosine."""
    wo = mf.Conductor(ndf).sample(wi, rng.random((len(wi), ndf.visible_dims)))[0]
    s, phi = np.sqrt(rng.random(len(wi))), 2.0 * np.pi * rng.random(len(wi))
    cosine = np.stack([s * np.cos(phi), s * np.sin(phi), np.sqrt(1.0 - s**2)], axis=-1)
    return np.where(rng.random((len(wi), 1)) < 0.75, wo, cosine)


def render(ndf, scattering, samples, rng):
    """What the camera sees."""
    metal = mf.Conductor(ndf, scattering=scattering)
    density = mf.Conductor(ndf, scattering="multiple")
    seen, wi = views()
    light = np.zeros(len(wi))
    for _ in range(samples):
        wo = proposals(ndf, wi, rng)
        options = {"rng": rng} if scattering == "multiple" else {}
        light += metal.eval(wi, wo, **options) / density.pdf(wi, wo)
    picture = np.ones((PIXELS, PIXELS))
    picture[seen] = light / samples
    return picture, light.mean() / samples


picture = sys.argv[1] if len(sys.argv) > 1 else "furnace_sphere.png"
samples = int(sys.argv[2]) if len(sys.argv) > 2 else 100
rng = np.random.default_rng(1)
figure, rows = plt.subplots(2, len(DISTRIBUTIONS), figsize=(6.6, 4.7), layout="constrained")
for row, scattering in zip(rows, ("single", "multiple"), strict=True):
    for ax, (name, ndf) in zip(row, DISTRIBUTIONS.items(), strict=True):
        values, mean = render(ndf, scattering, samples, rng)
        ax.imshow(values, cmap="gray", vmin=0.0, vmax=1.25, interpolation="nearest")
        ax.set_title(f"{name}, {scattering}: {mean:.3f}", fontsize=9)
        ax.set_axis_off()
        print(f"{name:9} {scattering:8} mean light {mean:.3f}")
figure.savefig(picture, dpi=100)
print(f"wrote {picture}")
