"""Tables: what is in them, that an interrupted bake goes on to the same bytes, and bad input."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import microfacet as mf
from limits import HANG
from microfacet._bake import run as running
from microfacet._bake.cell import compute
from microfacet.cli import main

xarray = pytest.importorskip("xarray")
pytest.importorskip("zarr")
pytest.importorskip("h5netcdf")

ENERGY: dict[str, Any] = {"alpha": [0.2, 0.6, 1.0], "cos_theta": [0.3, 1.0]}


def content(path: Path) -> dict[str, bytes]:
    """Every byte of a file, or of the files in a folder."""
    if path.is_file():
        return {"": path.read_bytes()}
    return {str(f.relative_to(path)): f.read_bytes() for f in sorted(path.rglob("*")) if f.is_file()}


def read(path: Path) -> Any:
    if path.suffix == ".nc":
        return xarray.load_dataset(path, engine="h5netcdf")
    return xarray.open_zarr(path).load()


def direction(cosine: float) -> list[float]:
    return [float(np.sqrt(1 - cosine**2)), 0.0, cosine]


# What is in them


def test_energy_is_what_albedos_miss() -> None:
    table = mf.bake("energy", "student_t", alpha=[0.9], shape=[2.5, 4.0], cos_theta=[0.2, 0.7])
    assert dict(table.sizes) == {"alpha": 1, "gamma": 2, "cos_theta": 2}
    white = mf.Conductor(mf.StudentT(alpha=0.9, gamma=2.5))
    here = table.sel(alpha=0.9, gamma=2.5)
    assert float(here.missing.sel(cos_theta=0.7)) == 1 - white.albedo(direction(0.7))
    assert float(here.missing_average) == 1 - white.average_albedo()


def test_albedo_of_a_dielectric() -> None:
    table = mf.bake(
        "albedo",
        "k0",
        alpha=[0.5],
        material="dielectric",
        eta=[1 / 1.5, 1.5],
        cos_theta=[0.4, 1.0],
        walks=4000,
    )
    assert dict(table.sizes) == {"alpha": 1, "eta": 2, "cos_theta": 2}
    glass = mf.Dielectric(mf.K0(alpha=0.5), 1.5, mode="importance")
    here = table.sel(alpha=0.5, eta=1.5, cos_theta=0.4)
    for part in ("reflected", "transmitted"):
        assert float(here[f"single_{part}"]) == glass.albedo(direction(0.4), part=part)
    walk = mf.Dielectric(glass.ndf, 1.5, mode="importance", scattering="multiple")
    value, error = walk.albedo(direction(0.4), n=4000, rng=9, part="transmitted", with_error=True)
    assert abs(value - float(here.multiple_transmitted)) < 4.5 * np.hypot(error, float(here.multiple_error))
    assert np.all(table.multiple_reflected > table.single_reflected - 4 * table.multiple_error)


def test_bsdf_is_f() -> None:
    table = mf.bake(
        "bsdf",
        "ggx",
        alpha=[0.4],
        cos_theta=[0.5, 0.9],
        azimuth=[0.0, 2.0],
        eta=0.2,
        k=3.0,
        scattering="single",
    )
    gold = mf.Conductor(mf.GGX(alpha=0.4), 0.2, 3.0)
    sine = np.sqrt(1 - 0.9**2)
    wo = [sine * np.cos(2.0), sine * np.sin(2.0), 0.9]
    f = table.f.sel(alpha=0.4, cos_theta_i=0.5, cos_theta_o=0.9, azimuth=2.0)
    assert float(f) == pytest.approx(float(gold.eval(direction(0.5), wo)) / 0.9, rel=1e-13)
    # Reciprocal: the same grid for both.
    np.testing.assert_allclose(
        table.f, table.f.transpose("alpha", "cos_theta_o", "cos_theta_i", "azimuth").values, rtol=1e-12
    )
    glass = mf.bake(
        "bsdf", "ggx", alpha=[0.4], cos_theta=3, azimuth=2, material="dielectric", eta=1.5, walks=2
    )
    assert glass.cos_theta_o.values.tolist() == sorted([-1, -2 / 3, -1 / 3, 1 / 3, 2 / 3, 1])


def test_compensation_takes_tables() -> None:
    table = mf.bake("energy", "bessel_k", alpha=np.linspace(0.3, 0.5, 3), shape=[0.7], cos_theta=16)
    metal = mf.Conductor(mf.BesselK(alpha=0.4, a=0.7), 0.2, 3.0)
    wi = np.array([direction(c) for c in (0.3, 0.8)])
    for lobe in (mf.KullaConty, mf.Turquin):
        np.testing.assert_allclose(lobe(metal, table).albedo(wi), lobe(metal).albedo(wi), atol=1e-3)
        with pytest.raises(ValueError, match=r"the table has alpha in \[0.3, 0.5\], got 0.6"):
            lobe(mf.Conductor(mf.BesselK(alpha=0.6, a=0.7)), table)
        with pytest.raises(ValueError, match="the table is of bessel_k"):
            lobe(mf.Conductor(mf.GGX(alpha=0.4)), table)


# Files


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_a_bake_that_was_interrupted_goes_on(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    (tmp_path / "whole").mkdir()
    whole, resumed = tmp_path / "whole" / f"t{suffix}", tmp_path / f"t{suffix}"
    bake = {"walks": 50, "seed": 3, **ENERGY}
    expected = mf.bake("albedo", "ggx", output=whole, threads=1, **bake)
    computed: list[int] = []

    def fails_after_two(what: Any, cell: int) -> Any:
        if len(computed) == 2:
            raise KeyboardInterrupt
        computed.append(cell)
        return compute(what, cell)

    monkeypatch.setattr(running, "compute", fails_after_two)
    with pytest.raises(KeyboardInterrupt):
        mf.bake("albedo", "ggx", output=resumed, threads=1, **bake)
    assert not resumed.exists()
    computed.clear()
    monkeypatch.setattr(
        running, "compute", lambda what, cell: (computed.append(cell), compute(what, cell))[1]
    )
    table = mf.bake("albedo", "ggx", output=resumed, **bake)
    assert len(computed) == 1  # the two others were kept
    assert table.identical(expected)
    assert content(resumed) == content(whole)
    assert {path.name for path in tmp_path.iterdir()} == {"whole", resumed.name}  # nothing is left
    on_disk = read(resumed)
    assert on_disk.equals(table)
    assert on_disk.attrs["version"] == mf.__version__
    assert on_disk.attrs["date"] == "2023-11-14T22:13:20+00:00"
    assert on_disk.attrs["seed"] == 3


def test_a_damaged_cell_is_computed_again_and_another_recipe_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "t.nc"
    monkeypatch.setattr(running, "_write", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        mf.bake("energy", "ggx", output=output, **ENERGY)
    monkeypatch.undo()
    folder = tmp_path / ".t.nc.bake"
    (folder / "000001.npz").write_bytes(b"PK half of a file")
    with pytest.raises(ValueError, match="interrupted"):
        mf.bake("energy", "ggx", output=output, **{**ENERGY, "cos_theta": [0.5]})
    table = mf.bake("energy", "ggx", output=output, **ENERGY)
    assert table.equals(mf.bake("energy", "ggx", **ENERGY))
    assert not folder.exists()


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_a_table_takes_the_place_of_an_older_one(suffix: str, tmp_path: Path) -> None:
    output = tmp_path / f"t{suffix}"
    mf.bake("energy", "ggx", alpha=1.0, cos_theta=[0.5, 1.0], output=output)
    mf.bake("energy", "beckmann", alpha=[0.3, 1.0], cos_theta=[1.0], output=output)
    assert read(output).attrs["family"] == "beckmann"
    assert [path.name for path in tmp_path.iterdir()] == [output.name]


def test_threads_and_clusters_change_nothing() -> None:
    distributed = pytest.importorskip("distributed")
    bake = {"walks": 50, "seed": 3, **ENERGY}
    expected = mf.bake("albedo", "ggx", threads=1, **bake)
    assert mf.bake("albedo", "ggx", threads=3, **bake).equals(expected)
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tcp"
    )
    with cluster:
        assert mf.bake("albedo", "ggx", dask=cluster.scheduler_address, **bake).equals(expected)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_killed_command_goes_on(tmp_path: Path) -> None:
    bake: dict[str, Any] = {"alpha": np.linspace(0.1, 1, 10), "eta": 0.2, "k": 3.0, "walks": 4000}
    grids = ["--alpha", "0.1:1:10", "--cos", "0.5,1", "--eta", "0.2", "--k", "3"]
    options = [*grids, "--walks", "4000", "--threads", "1"]
    # Killed by itself, in the middle of its work however busy the machine is.
    code = """
import os, signal
from microfacet._bake.journal import Journal
from microfacet.cli import main
keep, kept = Journal.keep, []
def keep_three(*given):
    keep(*given)
    kept.append(given)
    if len(kept) == 3:
        os.kill(os.getpid(), signal.SIGKILL)
Journal.keep = keep_three
main()
"""
    command = [sys.executable, "-c", code, "bake", "albedo", "ggx", *options, "-o", "t.nc"]
    assert subprocess.run(command, cwd=tmp_path, timeout=HANG).returncode == -signal.SIGKILL
    journal = tmp_path / ".t.nc.bake"
    assert not (tmp_path / "t.nc").exists()
    kept = {path.name: path.read_bytes() for path in journal.glob("0*.npz")}
    assert len(kept) == 3
    table = mf.bake("albedo", "ggx", cos_theta=[0.5, 1.0], output=tmp_path / "t.nc", **bake)
    assert table.equals(mf.bake("albedo", "ggx", cos_theta=[0.5, 1.0], **bake))
    assert read(tmp_path / "t.nc").equals(table)
    assert [path.name for path in tmp_path.iterdir()] == ["t.nc"]


# The command, and bad input


def test_the_command_writes_and_says_so(tmp_path: Path) -> None:
    output = tmp_path / "t.zarr"
    result = CliRunner().invoke(
        main,
        [
            "bake",
            "energy",
            "gtr",
            "--alpha",
            "0.2,0.4",
            "--gamma",
            "1:2:2",
            "--cos",
            "0.5",
            "-o",
            str(output),
            "--json",
        ],
    )
    assert result.exit_code == 0, result.output
    said = json.loads(result.stdout)
    assert said["sizes"] == {"alpha": 2, "gamma": 2, "cos_theta": 1}
    assert said["variables"] == ["missing", "missing_average"]
    table = read(output)
    assert table.gamma.values.tolist() == [1.0, 2.0]
    assert "microfacet" in table.attrs["command"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["energy", "phong", "--alpha", "0.3"], "family must be one of"),
        (["energy", "ggx", "--alpha", "0:1:3"], "alpha must lie in"),
        (["energy", "ggx", "--alpha", "0.3,0.2"], "alpha must be increasing"),
        (["energy", "ggx", "--alpha", "a"], "a grid is"),
        (["energy", "ggx", "--alpha", "nan"], "alpha must be increasing"),
        (["energy", "ggx", "--alpha", "0.3", "--gamma", "2"], "ggx has no parameter gamma"),
        (["energy", "student_t", "--alpha", "0.3"], "student_t needs gamma"),
        (["energy", "student_t", "--alpha", "0.3", "--gamma", "1.2,3"], "gamma must lie in"),
        (["albedo", "ggx", "--alpha", "0.3", "--material", "dielectric"], "a dielectric needs eta"),
        (["albedo", "ggx", "--alpha", "0.3", "--material", "dielectric", "--eta", "-1"], "eta must lie"),
        (["albedo", "ggx", "--alpha", "0.3", "--cos", "0:1:4"], "cos_theta must lie in"),
        (["albedo", "ggx", "--alpha", "0.3", "--eta", "1,2"], "a conductor takes one eta"),
        (["bsdf", "ggx", "--alpha", "0.01:1:100000"], "GB"),
    ],
)
def test_bad_input_is_one_sentence(arguments: list[str], message: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["bake", *arguments, "-o", str(tmp_path / "t.nc")])
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.strip().count("\n") == 0
    assert not list(tmp_path.iterdir())


def test_output_is_checked_first(tmp_path: Path) -> None:
    for name, message in (("t.csv", "must end in"), ("no/t.nc", "folder that exists")):
        result = CliRunner().invoke(
            main, ["bake", "energy", "ggx", "--alpha", "0.3", "-o", str(tmp_path / name)]
        )
        assert result.exit_code == 2
        assert message in result.stderr
    assert not list(tmp_path.iterdir())
