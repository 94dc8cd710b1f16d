"""Compensation lobes against the walk: prints the table of docs/compensation.md (some minutes).

Over directions wo drawn from cos/pi, f is compared with two independent estimates a and b of the walk's,
whose product has no bias from their noise: rms^2 = E[(f - a)(f - b)] / E[a b].
"""

from __future__ import annotations

import numpy as np

import microfacet as mf

CHOSEN = {"student_t": 2.5}  # where it is not the value of pictures
SHAPES = {
    family.name: {own.name: CHOSEN.get(family.name, own.pictured) for own in family.parameters[1:]}
    for family in mf.families()
}
ALPHAS = (0.1, 0.3, 1.0)
ANGLES = np.radians([0.0, 30.0, 60.0, 80.0])
METALS = {"white": (np.inf, 0.0), "copper (green)": (0.95, 2.58)}
DIRECTIONS, WALKS = 512, 1024


def outgoing() -> np.ndarray:
    """Points of a lattice, drawn from cos/pi."""
    k = np.arange(DIRECTIONS) + 0.5
    xi, phi = k / DIRECTIONS, 2 * np.pi * ((k * (np.sqrt(5) - 1) / 2) % 1)
    radius = np.sqrt(xi)
    return np.stack((radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - xi)), -1)


def main() -> None:
    wi = np.stack((np.sin(ANGLES), 0 * ANGLES, np.cos(ANGLES)), -1)
    wo = outgoing()
    print("| family | alpha | metal | missing | energy: K-C | energy: T | f: none | f: K-C | f: T |")
    print("|---|---|---|---|---|---|---|---|---|")
    for family in mf.families():
        for alpha in ALPHAS:
            ndf = family.cls(alpha=alpha, **SHAPES[family.name])
            for name, metal in METALS.items():
                single = mf.Conductor(ndf, *metal)
                walk = mf.Conductor(ndf, *metal, scattering="multiple")
                first, all_ = single.albedo(wi), walk.albedo(wi, n=200_000, rng=1)
                lobes = [mf.KullaConty(single), mf.Turquin(single)]
                energy = [np.abs(lobe.albedo(wi) - all_).max() for lobe in lobes]
                i, o = wi[:, None], wo[None]
                once = single.eval(i, o) / o[..., 2]
                a, b = (walk.eval(i, o, n=WALKS, rng=seed, orders=(2, 2**31)) / o[..., 2] for seed in (2, 3))
                light = np.mean((once + a) * (once + b))
                errors = [
                    np.sqrt(max(0.0, np.mean((c - once - a) * (c - once - b)) / light))
                    for c in (once, *(lobe.eval(i, o) / o[..., 2] for lobe in lobes))
                ]
                missing = (all_ - first).max()
                cells = [f"{x:.3f}" for x in (missing, *energy)] + [f"{100 * x:.1f} %" for x in errors]
                print("|", " | ".join((family.name, f"{alpha:g}", name, *cells)), "|", flush=True)


if __name__ == "__main__":
    main()
