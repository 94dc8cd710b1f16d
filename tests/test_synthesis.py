"""Synthetic height maps: the mixing laws they are made of, and the slopes that come out."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import integrate, stats

import microfacet as mf
from microfacet._surface import mixing
from microfacet.cli import main

MIXTURES = [
    mf.GGX(alpha=1.0),
    mf.StudentT(alpha=1.0, gamma=1.6),
    mf.StudentT(alpha=1.0, gamma=7.0),
    mf.K0(alpha=1.0),
    mf.BesselK(alpha=1.0, a=0.3),
    mf.BesselK(alpha=1.0, a=4.0),
    mf.GTR(alpha=0.3, gamma=0.5),
    mf.GTR(alpha=0.05, gamma=1.0),
    mf.GTR(alpha=0.3, gamma=2.7),
    mf.GTR(alpha=0.2, gamma=6.0),
    mf.GTR(alpha=1.7, gamma=1.4),
    mf.GTR(alpha=1.0, gamma=3.0),
]


@pytest.mark.parametrize("ndf", MIXTURES, ids=repr)
def test_the_mixing_law_superposes_beckmann_into_the_family(ndf):
    """P22(r) = int_0^1 exp(-r^2/m(u))/(pi m(u)) du with the quantile function m."""
    quantile = mixing.quantile(ndf)
    scale = ndf.parameters.get("alpha", 1.0)
    for r in (0.3 * scale, scale, 3 * scale):

        def part(y, r=r):  # u = 1/(1 + exp(-y)), so that both ends of the law are resolved
            u = 1 / (1 + math.exp(-y))
            m = float(quantile(np.array([u]))[0])
            return math.exp(-r * r / m) / (math.pi * m) * u * (1 - u)

        found, _ = integrate.quad(part, -36, 36, limit=400, epsabs=0, epsrel=1e-8)
        assert found == pytest.approx(float(ndf.P22(r, 0.0)), rel=2e-6)


def test_quantiles_rise():
    for ndf in MIXTURES:
        values = mixing.quantile(ndf)(np.linspace(1e-7, 1 - 1e-7, 10_001))
        assert (np.diff(values) >= 0).all()
        assert (values > 0).all()


@pytest.mark.parametrize("alpha", [(0.3, 0.3, 0.0), (0.3, 0.1, 0.6)])
def test_a_gaussian_map_has_the_slopes_of_beckmann(alpha):
    x, y, turn = alpha
    ndf = mf.Beckmann(alpha_x=x, alpha_y=y, rotation=turn)
    surface = mf.synthesize(ndf, (512, 640), (1e-6, 1.3e-6), correlation_length=6e-6, seed=2, pinned=True)
    slopes = surface.slopes()
    target = mixing.stretch(ndf)
    white = slopes @ np.linalg.inv(target).T * math.sqrt(2)
    # An area of 1/2 pi length^2 holds one independent value, so 512 x 640 pixels hold about 7000.
    assert np.cov(white.T) == pytest.approx(np.eye(2), abs=4 * math.sqrt(2 / 7000))
    assert np.mean(white**2) == pytest.approx(1.0, abs=0.01)  # over the inner pixels of an exact mean
    assert stats.kurtosis(white[:, 0]) == pytest.approx(0.0, abs=4 * math.sqrt(24 / 7000))


def test_maps_are_periodic_and_smooth_across_the_seam():
    surface = mf.synthesize(mf.StudentT(alpha=0.3, gamma=2.5), (128, 160), seed=3)
    heights = surface.heights
    second = np.roll(heights, -1, axis=1) - 2 * heights + np.roll(heights, 1, axis=1)
    seam = np.sqrt(np.mean(second[:, [0, -1]] ** 2))
    assert seam < 3 * np.sqrt(np.mean(second[:, 1:-1] ** 2))
    assert abs(np.mean(heights)) < 1e-12 * np.std(heights)


def test_a_gaussian_map_is_band_limited():
    power = np.abs(np.fft.rfft2(mf.synthesize(mf.Beckmann(alpha=0.3), (128, 160)).heights)) ** 2
    assert power[:, 70:].sum() < 1e-12 * power.sum()


@pytest.mark.parametrize(
    "ndf",
    [
        mf.GGX(alpha=0.2),
        mf.StudentT(alpha=0.3, gamma=4.0),
        mf.K0(alpha=0.3),
        mf.BesselK(alpha=0.3, a=2.5),
        mf.GTR(alpha=0.3, gamma=3.0),
    ],
    ids=repr,
)
def test_slopes_far_apart_follow_the_family(ndf):
    """Kolmogorov-Smirnov on the radial survival of slopes an amplitude length apart, over 6 maps."""
    family = next(family for family in mf.families() if family.name == ndf.family)
    values = ndf.parameters
    names = [parameter.name for parameter in family.parameters]
    arguments = [values[name] if name in values else values["alpha_x"] for name in names]
    uniform = []
    for seed in range(6):
        surface = mf.synthesize(ndf, (512, 512), seed=seed)
        slopes = surface.slopes().reshape(510, 510, 2)[22::45, 22::45].reshape(-1, 2)
        uniform.append(family.kernels.survival(np.hypot(*slopes.T), *arguments))
    assert stats.kstest(np.concatenate(uniform), "uniform").pvalue > mf.testing.sidak(0.01, 5)


@pytest.mark.parametrize(
    ("ndf", "of_alpha", "of_shape"),
    [
        (mf.StudentT(alpha_x=0.3, alpha_y=0.15, rotation=0.5, gamma=2.5), 0.015, 0.035),
        (mf.BesselK(alpha_x=0.2, alpha_y=0.3, rotation=-0.3, a=1.5), 0.035, 0.05),
    ],
    ids=["student_t", "bessel_k"],
)
def test_a_fit_recovers_the_family_and_its_axes(ndf, of_alpha, of_shape):
    """Within what the documentation of `synthesize` promises for such a map."""
    slopes = mf.synthesize(ndf, (1024, 1024), seed=11, pinned=True).slopes()[::29]
    (found,) = mf.fit(slopes, ndf.family, symmetry="anisotropic")
    within = {"alpha_x": of_alpha, "alpha_y": of_alpha, "gamma": of_shape, "a": of_shape}
    for name, value in ndf.parameters.items():
        tolerance = within[name] * value if name in within else 0.03  # radians
        assert found.params[name] == pytest.approx(value, abs=tolerance), name


def test_seeds_scatter_as_the_stated_correlation_says():
    """The mean square slope of a periodic Gaussian field has the relative variance 2 sum S^2/(sum S)^2, with
    the power spectrum S of its slopes; a pinned map has none.
    """
    ndf, size, length = mf.Beckmann(alpha=0.3), 48, 5.0

    def squares(**options):
        for seed in range(150):
            surface = mf.synthesize(ndf, (size, size), 1.0, correlation_length=length, seed=seed, **options)
            h = np.pad(surface.heights, 1, mode="wrap")
            yield np.mean((h[1:-1, 2:] - h[1:-1, :-2]) ** 2 + (h[2:, 1:-1] - h[:-2, 1:-1]) ** 2) / 4

    found, pinned = np.array(list(squares())), np.array(list(squares(pinned=True)))
    assert np.ptp(pinned) < 1e-12
    assert pinned[0] == pytest.approx(0.09)
    waves = 2 * math.pi * np.fft.fftfreq(size)
    kx, ky = np.meshgrid(waves, waves)
    power = np.exp(-(kx**2 + ky**2) * length**2 / 4) * (np.sin(kx) ** 2 + np.sin(ky) ** 2)
    expected = 2 * np.sum(power**2) / np.sum(power) ** 2
    # Mean and variance of 150 maps, within 3.5 of their own standard errors.
    assert np.mean(found) == pytest.approx(0.09, rel=3.5 * math.sqrt(expected / 150))
    assert np.var(found) / 0.09**2 == pytest.approx(expected, rel=3.5 * math.sqrt(2 / 150))


def test_the_roughness_of_maps_follows_the_law_over_the_seeds():
    """Local roughness where the map is largest scatters: the median slope of maps of few regions."""
    ndf = mf.StudentT(alpha=0.3, gamma=3.0)
    medians = [
        [
            np.median(np.hypot(*mf.synthesize(ndf, (96, 96), seed=seed, pinned=pinned).slopes().T))
            for seed in range(40)
        ]
        for pinned in (False, True)
    ]
    assert np.std(medians[0]) > 3 * np.std(medians[1])
    exact = float(mf.student_t.sample_slope(0.5, 0.3, 3.0))
    assert np.mean(medians[0]) == pytest.approx(exact, abs=3.5 * np.std(medians[0]) / math.sqrt(40))


def test_same_seed_same_map():
    one, same, other = (mf.synthesize(mf.K0(alpha=0.3), (128, 128), seed=seed).heights for seed in (5, 5, 6))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


class Unknown:
    """A distribution that is no mixture."""

    family = "cubes"
    parameters = {"alpha": 1.0}  # noqa: RUF012


@pytest.mark.parametrize(
    ("ndf", "options", "message"),
    [
        (mf.GTR(alpha=1.5, gamma=2.5), {}, "alpha > 1 and gamma > 2"),
        (Unknown(), {}, "no mixture of Beckmann surfaces is known for cubes"),
        (mf.GGX(alpha=0.3), {"shape": (8, 8)}, "shape"),
        (mf.GGX(alpha=0.3), {"shape": (10**6, 10**6)}, "limit"),
        (mf.GGX(alpha=0.3), {"shape": 100}, "shape"),
        (mf.GGX(alpha=0.3), {"shape": (64.0, 64.0)}, "shape"),
        (mf.GGX(alpha=0.3), {"pixel_size": -1.0}, "pixel_size"),
        (mf.GGX(alpha=0.3), {"correlation_length": 1e-6}, "at least 2 pixels"),
        (mf.GGX(alpha_x=0.1, alpha_y=0.9), {}, "at least 6 pixels"),
        (mf.GGX(alpha=0.3), {"correlation_length": 1e-4}, "correlation lengths wide"),
        (mf.GGX(alpha=0.3), {"amplitude_length": 5e-6}, "amplitude_length must lie"),
        (mf.GGX(alpha=0.3), {"amplitude_length": 1.0}, "amplitude_length must lie"),
        (mf.GGX(alpha=0.3), {"seed": -1}, "seed"),
    ],
)
def test_what_cannot_be_made_is_one_sentence(ndf, options, message):
    with pytest.raises(mf.SurfaceError, match=message) as caught:
        mf.synthesize(ndf, **({"shape": (128, 128)} | options))
    assert "\n" not in str(caught.value)


def test_the_command_writes_what_the_function_makes(tmp_path):
    path = str(tmp_path / "map.npz")
    options = "--alpha-x .3 --alpha-y .1 --rotation 20 --gamma 2.5 --shape 160 128 --pixel-size 2e-6 --seed 4"
    result = CliRunner().invoke(main, ["synthesize", "student_t", *options.split(), "-o", path, "--json"])
    assert result.exit_code == 0, result.stderr
    ndf = mf.StudentT(alpha_x=0.3, alpha_y=0.1, rotation=math.radians(20), gamma=2.5)
    expected = mf.synthesize(ndf, (128, 160), 2e-6, seed=4)
    found = mf.read_surface(path)
    assert np.array_equal(found.heights, expected.heights)
    assert found.pixel_size == expected.pixel_size
    record = json.loads(result.stdout)
    assert record["steps"] == list(expected.steps)
    assert record["roughness"]["Sq"] == pytest.approx(np.std(expected.heights))
    plain = CliRunner().invoke(
        main, ["synthesize", "ggx", "--alpha", ".3", "--shape", "99", "99", "-o", path]
    )
    assert plain.stdout == f"{path}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("ggx --alpha 0.3 --gamma 2 -o map.npz", "ggx takes alpha, got alpha and gamma"),
        ("ggx -o map.npz", "alpha"),
        ("student_t --alpha 0.3 -o map.npz", "gamma"),
        ("gtr --alpha-x 0.3 --alpha-y 1 --gamma 2 -o map.npz", "gtr has no alpha_x"),
        ("gtr --alpha 2 --gamma 3 -o map.npz", "no mixture"),
        ("ggx --alpha 0.3 -o map.txt", "must end in .npz"),
        ("ggx --alpha 0.3", "--output"),
        ("ggx --alpha 0.3 --shape 5 5 -o map.npz", "--shape"),
        ("ggx --alpha 0.3 -o missing/map.npz", "missing"),
        ("cubes --alpha 0.3 -o map.npz", "family must be one of"),
    ],
)
def test_bad_commands_write_nothing(tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["synthesize", *arguments.split()])
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())
