"""Is my sampler right? Visible normals of GGX as one might write them, with a mistake, and without.

python examples/python/check_a_sampler.py
"""

import numpy as np

import microfacet as mf
from microfacet.testing import chi2, ks_visible_slope

ALPHA = 0.3


def visible_normals(w, xi, stretch):
    """Spherical caps: a point of a cap plus the stretched direction, stretched back."""
    w = w * [ALPHA, ALPHA, 1.0]
    w /= np.linalg.norm(w)
    z = (1.0 - xi[:, 0]) * (1.0 + w[2]) - w[2]
    s, phi = np.sqrt(np.maximum(1.0 - z * z, 0.0)), 2.0 * np.pi * xi[:, 1]
    m = (np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1) + w) * [stretch, stretch, 1.0]
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


ndf = mf.GGX(alpha=ALPHA)
for name, stretch in (("right", ALPHA), ("one percent too rough", 1.01 * ALPHA), ("unstretched", 1.0)):
    for degrees in (20, 70, 89):
        w = np.array([np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))])

        def sampler(xi, w=w, stretch=stretch):
            return visible_normals(w, xi, stretch)

        normals = chi2(sampler, lambda m, w=w: ndf.D_visible(m, w), resolution=(16, 16), tests=18)
        slopes = ks_visible_slope(ndf, w, sampler=sampler, dims=2, tests=18)
        verdicts = (
            f"{test} {'passes' if result else 'fails'} (p = {result.p_value:.1e})"
            for test, result in (("chi-square", normals), ("slopes", slopes))
        )
        print(f"{name:22} {degrees} degrees:", ", ".join(verdicts))
