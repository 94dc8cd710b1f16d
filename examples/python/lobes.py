"""Where rough surfaces send light: one order of scattering, each further order, and all of them.

python examples/python/lobes.py [PICTURE.png] [WALKS]

Lobes f |cos| in the plane of incidence, on a logarithmic scale, of a metal, of glass and of diffuse facets
with the same K0 surface, lit from 60 degrees. Orders above the first are estimated by walks.
"""

import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

import microfacet as mf

INCIDENCE = 60.0
FLOOR = 1e-3  # the centre of the plots
NDF = mf.K0(alpha=1.0)
MATERIALS = {
    "metal": mf.Conductor(NDF, scattering="multiple"),
    "glass": mf.Dielectric(NDF, 1.5, scattering="multiple", mode="importance"),
    "diffuse facets": mf.Diffuse(NDF, 0.9, scattering="multiple"),
}
ORDERS = {"one facet": (1, 1), "two": (2, 2), "three": (3, 3), "all": (1, 2**31)}


def towards(degrees):
    """Directions in the plane of incidence; light comes from negative angles."""
    angle = np.radians(degrees)
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


picture = sys.argv[1] if len(sys.argv) > 1 else "lobes.png"
walks = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
angles = np.arange(-180.0, 180.0, 2.0) + 1.0  # along the horizon and the normal lobes may end or peak
figure, axes = plt.subplots(
    1, 3, figsize=(9.6, 3.6), subplot_kw={"projection": "polar"}, layout="constrained"
)
for ax, (name, material) in zip(axes, MATERIALS.items(), strict=True):
    for label, orders in ORDERS.items():
        lobe = material.eval(towards(-INCIDENCE), towards(angles), n=walks, rng=1, orders=orders)
        radius = np.log10(np.maximum(lobe, FLOOR) / FLOOR)
        style = {"color": "black", "linewidth": 1.6} if label == "all" else {"linewidth": 1.0}
        ax.plot(np.radians(angles), radius, label=label, **style)
        share = np.mean(np.where(np.abs(angles) < 90.0, lobe, 0.0)) / np.mean(lobe)
        print(f"{name:15} {label:9} largest {lobe.max():.4f}, {share:4.0%} of the plane above the surface")
    ax.plot(np.radians([-INCIDENCE] * 2), [0.0, -np.log10(FLOOR)], color="gray", linestyle=":")
    ax.set_theta_zero_location("N")
    ax.set_theta_direction(-1)
    ax.set(title=name, rticks=[1, 2, 3], ylim=(0.0, 3.9))
    ax.set_yticklabels(["0.01", "0.1", "1"], fontsize=7)
    ax.tick_params(axis="x", labelsize=7)
axes[0].legend(loc="lower center", fontsize=7, ncols=2, bbox_to_anchor=(0.5, -0.02))
figure.savefig(picture, dpi=100)
print(f"wrote {picture}")
