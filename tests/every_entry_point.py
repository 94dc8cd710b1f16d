"""Uses every public entry point once with one family: `python every_entry_point.py FAMILY FOLDER`.

Each step compares what it finds with something that another way gives. tests/test_add_a_family.py runs it for
the family of the walk.
"""

from __future__ import annotations

import json
import math
import pathlib
import sys
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import microfacet as mf
from microfacet._docs import QUANTITIES

Array = np.ndarray[Any, Any]
ALPHA = 0.3


class Subject:
    """One family at its example, and where files go."""

    def __init__(self, name: str, folder: pathlib.Path) -> None:
        (self.family,) = (family for family in mf.families() if family.name == name)
        self.shape = {own.name: own.pictured for own in self.family.parameters[1:]}
        self.ndf = self.family.cls(alpha=ALPHA, **self.shape)
        self.options = [f"--{key.replace('_', '-')}={value}" for key, value in self.shape.items()]
        self.folder = folder

    def main(self, *arguments: str) -> str:
        """What the command line prints."""
        from click.testing import CliRunner

        from microfacet.cli import main

        result = CliRunner().invoke(main, list(arguments))
        assert result.exit_code == 0, (arguments, result.output, result.exception)
        return result.output


def directions(n: int, seed: int = 1) -> Array:
    w = np.random.default_rng(seed).normal(size=(n, 3))
    w[:, 2] = abs(w[:, 2]) + 0.1
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


def ufuncs(s: Subject) -> None:
    kernels = s.family.kernels
    for name in QUANTITIES:
        f = getattr(kernels, name)
        first = (0.1, 0.2) if name == "P22" else (0.4,)
        assert np.isfinite(f(*first, ALPHA, *s.shape.values())), name
    u = np.linspace(0.05, 0.95, 9)
    np.testing.assert_allclose(
        kernels.sigma(u, ALPHA, *s.shape.values()),
        u * (1 + kernels.Lambda(u, ALPHA, *s.shape.values())),
        rtol=1e-13,
    )


def frozen(s: Subject) -> None:
    m, xi = directions(50), np.random.default_rng(2).random((50, 4))
    for name in ("D", "sigma", "Lambda", "G1"):
        assert np.isfinite(getattr(s.ndf, name)(m)).all(), name
    assert np.isfinite(s.ndf.G2(m, m[::-1])).all()
    if s.family.anisotropic:
        turned = s.family.cls(alpha_x=0.2, alpha_y=0.5, rotation=0.4, **s.shape)
        assert np.isfinite(turned.D(turned.sample(xi[:, :2]))).all()


def samplers(s: Subject) -> None:
    w = [0.6, 0.0, 0.8]
    one = mf.testing.chi2(s.ndf.sample, s.ndf.pdf, n=100_000, seed=1)
    assert one.p_value > 1e-4, one
    for scheme, dims in (("continuous", s.ndf.visible_dims), ("mixture", s.ndf.mixture_dims)):
        draw = partial(s.ndf.sample_visible, w, scheme=scheme)
        found = mf.testing.ks_visible_slope(s.ndf, w, sampler=draw, dims=dims, n=20_000, seed=2)
        assert found.p_value > 1e-4, found
    seen = draw(np.random.default_rng(3).random((9, s.ndf.mixture_dims)))
    assert (s.ndf.pdf_visible(seen, w) > 0).all()


def materials(s: Subject) -> None:
    wi, rng = directions(6, 3), np.random.default_rng(4)
    for material in (
        mf.Conductor(s.ndf, 0.2, 3.9),
        mf.Dielectric(s.ndf, 1.5),
        mf.Diffuse(s.ndf, 0.8),
        mf.Conductor(s.ndf, scattering="multiple"),
    ):
        given = (
            {"rng": 4} if material.scattering == "multiple" else {"xi": rng.random((6, material.sample_dims))}
        )
        wo, weight, pdf = material.sample(wi, **given)
        assert np.isfinite(weight).all()
        assert np.isfinite(material.eval(wi, wo, rng=5)).all()
        assert np.isfinite(pdf).all()
        albedo = np.asarray(material.albedo(wi, n=2000, rng=6))
        assert ((albedo > 0) & (albedo < 1.05)).all(), material


def compensation(s: Subject) -> None:
    white, w = mf.Conductor(s.ndf), [0.6, 0.0, 0.8]
    for kind in (mf.KullaConty, mf.Turquin):
        lossless = kind(white)
        assert np.isfinite(lossless.eval(w, [0.0, 0.1, math.sqrt(0.99)])), kind


def surfaces(s: Subject) -> None:
    surface = mf.synthesize(s.ndf, (512, 512), seed=5)
    fitted = mf.fit(surface, s.family.name)[0]
    rough = math.sqrt(math.prod(fitted.roughness))
    median = float(s.family.kernels.sample_slope(0.5, ALPHA, *s.shape.values()))
    shape = [fitted.params[name] for name in s.shape]
    found = float(s.family.kernels.sample_slope(0.5, rough, *shape))
    assert abs(found / median - 1) < 0.1, fitted
    scales = mf.fit_scales(surface, [2, 4], s.family.name, max_slopes=5000)
    assert len(scales.results) == 2
    path = s.folder / "map.npz"
    s.main(
        "synthesize", s.family.name, f"--alpha={ALPHA}", *s.options, "--shape", "64", "64", "-o", str(path)
    )
    said = json.loads(s.main("fit", str(path), "--family", s.family.name, "--no-scales", "--json"))
    assert said["ranking"][0]["family"] == s.family.name


def tables(s: Subject) -> None:
    theta = np.radians(np.arange(2, 80, 3))
    density = theta, 7 * s.family.kernels.D(np.cos(theta), ALPHA, *s.shape.values())
    (found,) = mf.fit_table(density=density, families=s.family.name)
    assert found.objective < 1e-3, found
    edges = np.linspace(-1.5, 1.5, 61)
    counts = 1e5 * np.diff(s.family.kernels.slope_cdf(edges, ALPHA, *s.shape.values()))
    (found,) = mf.fit_table(histogram=(edges, counts), families=s.family.name)
    assert abs(found.params["mean"]) < 0.02
    try:
        (moment,) = mf.fit_table(mean_square_slopes=0.03, families=s.family.name, **s.shape)
    except ValueError as error:
        assert "mean square slope is infinite" in str(error), error  # noqa: PT017
    else:
        assert moment.params["alpha"] > 0


def bakes(s: Subject) -> None:
    shape = list(s.shape.values()) or None
    table = mf.bake("energy", s.family.name, alpha=[ALPHA], shape=shape, cos_theta=3)
    lost = 1 - np.asarray(mf.Conductor(s.ndf).albedo([math.sqrt(8) / 3, 0.0, 1 / 3]))
    np.testing.assert_allclose(table["missing"].values.ravel()[0], lost, rtol=1e-3, atol=1e-5)
    texture = mf.lookup_texture("energy", s.family.name, size=(8, 8), shape=shape, check=0)
    assert np.isfinite(texture.values).all()
    written = s.folder / "table.nc"
    s.main(
        *("bake", "energy", s.family.name, f"--alpha={ALPHA}", *s.options, "--cos=0.5", "-o", str(written))
    )
    assert written.exists()


def exports(s: Subject) -> None:
    text = mf.export("glsl", s.family.name, ["D", "Lambda", "sample_visible", "conductor"], **s.shape)
    assert f"{s.family.name}_D(" in text
    functions = mf.array_functions(s.family.name)
    m = directions(20)
    exact = s.family.kernels.D(m[:, 2], ALPHA, *s.shape.values())
    np.testing.assert_allclose(functions.D(m, alpha=ALPHA, **s.shape), exact, rtol=1e-12)
    assert f"{s.family.name}_D(" in s.main("export", "c", s.family.name, "--functions=D", *s.options)


def commands(s: Subject) -> None:
    said = s.main("eval", s.family.name, "Lambda", "0.4", f"--alpha={ALPHA}", *s.options)
    exact = float(s.family.kernels.Lambda(0.4, ALPHA, *s.shape.values()))
    assert math.isclose(float(said.split()[-1]), exact, rel_tol=1e-5), said
    path = s.folder / "normals.npy"
    s.main("sample", s.family.name, f"--alpha={ALPHA}", *s.options, "-n", "9", "-o", str(path))
    assert np.load(path).shape == (9, 3)
    assert s.family.name in s.main("families")
    for name in s.shape:
        assert f"--{name.replace('_', '-')} " in s.main("gallery", "--help")


def checks(s: Subject) -> None:
    results = json.loads(s.main("verify", "--family", s.family.name, "--json"))["checks"]
    assert len(results) >= 2
    assert all(result["passed"] for result in results), results


def pages(s: Subject) -> None:
    from matplotlib import pyplot as plt

    from microfacet import plot

    for draw in (plot.density, plot.joint, plot.marginal, plot.sigma, plot.Lambda, plot.histogram):
        draw(s.ndf, plt.figure().gca())
        plt.close()
    path = s.folder / "report.html"
    s.main("report", "--family", s.family.name, *s.options, "--quick", "--output", str(path))
    page = path.read_text(encoding="utf-8")
    assert f'id="{s.family.name}"' in page


def steps() -> Iterator[Any]:
    """All of the above, in their order."""
    yield from (ufuncs, frozen, samplers, materials, compensation, surfaces, tables, bakes, exports, commands)
    yield from (checks, pages)


def main(name: str, folder: str) -> None:
    """Every step once; each says its name, so that a failure is found."""
    import matplotlib as mpl

    mpl.use("agg")
    subject = Subject(name, pathlib.Path(folder))
    for step in steps():
        print(step.__name__, flush=True)
        step(subject)


if __name__ == "__main__":
    main(*sys.argv[1:])
