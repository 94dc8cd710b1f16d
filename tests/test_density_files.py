"""Densities in files: what is written is read again, and what anybody may have written is one sentence."""

from __future__ import annotations

import json
import pathlib
import zipfile
from typing import Any

import numpy as np
import pytest

import microfacet as mf

R = np.geomspace(1e-3, 6.0, 40)
GOOD: dict[str, Any] = {
    "kind": "microfacet density",
    "version": 1,
    "P22": {"r": R.tolist(), "values": np.exp(-R).tolist()},
}
DIRECTIONS = np.array([[0.6, 0.0, 0.8], [0.0, 0.96, 0.28], [-0.8, 0.0, -0.6]])

DENSITIES = {
    "heavy": (lambda r: (1.0 + r * r) ** -1.8, "json"),
    "singular": (lambda r: r**-1.5 * np.exp(-r), "npz"),
    "kink": (lambda r: np.exp(-5.0 * np.abs(r - 1.0)), "npz"),
}


@pytest.mark.parametrize("name", DENSITIES)
def test_what_is_saved_is_read(tmp_path: pathlib.Path, name: str) -> None:
    density, ending = DENSITIES[name]
    ndf = mf.RadialNDF(density, alpha_x=0.3, alpha_y=0.2, rotation=0.5)
    ndf.save(tmp_path / f"own.{ending}")
    again = mf.read_density(tmp_path / f"own.{ending}")
    assert again.parameters == ndf.parameters
    r = np.geomspace(1e-6, 3.0, 500)
    near = ndf.P22(r, 0.0) > 1e-60
    np.testing.assert_allclose(again.P22(r, 0.0)[near], ndf.P22(r, 0.0)[near], rtol=1e-8)
    np.testing.assert_allclose(again.sigma(DIRECTIONS), ndf.sigma(DIRECTIONS), rtol=1e-9)


def test_a_density_that_ends_is_read(tmp_path: pathlib.Path) -> None:
    """One whose values are 0 at the last slope ends there."""
    r = np.linspace(0.0, 1.0, 21)
    document = GOOD | {"P22": {"r": r.tolist(), "values": ((1 - r**2) ** 2).tolist()}}
    (tmp_path / "own.json").write_text(json.dumps(document))
    ndf = mf.read_density(tmp_path / "own.json")
    assert ndf.P22(1.01, 0.0) < 1e-6 * ndf.P22(0.0, 0.0)
    assert ndf.norm == pytest.approx(np.pi / 3, rel=1e-3)
    assert ndf.error < 1e-6


def test_roughness_of_the_call_goes_before_that_of_the_file(tmp_path: pathlib.Path) -> None:
    (tmp_path / "own.json").write_text(json.dumps(GOOD | {"alpha_x": 0.2, "alpha_y": 0.3, "rotation": 0.5}))
    assert mf.read_density(tmp_path / "own.json").parameters == {
        "alpha_x": 0.2, "alpha_y": 0.3, "rotation": 0.5
    }  # fmt: skip
    assert mf.read_density(tmp_path / "own.json", alpha=0.4).parameters == {
        "alpha_x": 0.4, "alpha_y": 0.4, "rotation": 0.0
    }  # fmt: skip


def test_a_table_of_D_by_cosine_is_that_by_angle() -> None:
    theta = np.radians(np.arange(0.0, 89.1, 3.0))
    exact = mf.StudentT(alpha=0.4, gamma=2.5)
    D = exact.D(np.sin(theta), 0.0, np.cos(theta))
    by_angle, by_cosine = (
        mf.RadialNDF.from_D(theta, D),
        mf.RadialNDF.from_D(None, D[::-1], u=np.cos(theta)[::-1]),
    )
    np.testing.assert_allclose(by_angle.sigma(DIRECTIONS), by_cosine.sigma(DIRECTIONS), rtol=1e-10)
    np.testing.assert_allclose(by_angle.sigma(DIRECTIONS), exact.sigma(DIRECTIONS), rtol=2e-3)


def changed(**content: Any) -> str:
    return json.dumps(GOOD | content)


HOSTILE = {
    "empty": ("", "the file is empty"),
    "text": ("hello", "it is no JSON"),
    "binary": (b"\xff\xfe\x00\x01" * 10, "neither JSON nor an npz file"),
    "deep": ("[" * 100_000, "nested too deeply"),
    "list": ("[1, 2]", "it is no density"),
    "other": (json.dumps({"kind": "fit"}), "it is no density"),
    "version": (changed(version=7), "its version is 7"),
    "versions": (changed(version=["x" * 1000]), "its version is"),
    "unknown": (changed(P23=1), "unknown keys P23"),
    "two": (changed(D={"theta": [0.0], "values": [1.0]}), "one of P22, D, histogram"),
    "none": (json.dumps({"kind": "microfacet density", "version": 1}), "got none"),
    "no list": (changed(P22={"r": 3, "values": [1]}), "P22.r must be a list"),
    "strings": (changed(P22={"r": ["1"] * 9, "values": [1.0] * 9}), "a list of numbers alone"),
    "nested": (changed(P22={"r": [[1.0]] * 9, "values": [1.0] * 9}), "a list of numbers alone"),
    "huge": (changed(P22={"r": [10**400] * 9, "values": [1.0] * 9}), "too large"),
    "infinite": (changed(P22={"r": [float("inf")] * 9, "values": [1.0] * 9}), "must be finite"),
    "lengths": (changed(P22={"r": [1.0, 2.0], "values": [1.0]}), "as many values as slopes"),
    "few": (changed(P22={"r": [1.0, 2.0], "values": [1.0, 2.0]}), "8 positive values at least"),
    "negative": (changed(P22={"r": R.tolist(), "values": (-R).tolist()}), "must not be negative"),
    "order": (changed(P22={"r": R[::-1].tolist(), "values": R.tolist()}), "must increase"),
    "lacks": (changed(P22={"r": R.tolist()}), "P22 lacks values"),
    "heavy": (changed(P22={"r": R.tolist(), "values": (R**-1.5).tolist()}), "integrable over the plane"),
    "alpha": (changed(alpha="0.3"), "alpha must be a number"),
    "alpha range": (changed(alpha=-1.0), "alpha must lie in"),
    "alphas": (changed(alpha_x=0.3), "either alpha, or both"),
    "word": (changed(P22=GOOD["P22"] | {"beyond": "nothing"}), 'beyond must be "power" or "zero"'),
    "long word": (changed(P22=GOOD["P22"] | {"beyond": "n" * 10**5}), "beyond must be a word"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_documents_are_one_sentence(tmp_path: pathlib.Path, name: str) -> None:
    content, message = HOSTILE[name]
    path = tmp_path / "own.json"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ValueError, match=message) as caught:
        mf.read_density(path)
    assert "\n" not in str(caught.value)
    assert "own.json" in str(caught.value)
    assert len(str(caught.value)) < len(str(path)) + 400


def test_too_many_numbers_are_refused_before_they_are_parsed(tmp_path: pathlib.Path) -> None:
    (tmp_path / "own.json").write_text("[" + "1," * 2**23)
    with pytest.raises(ValueError, match="more than 8388608 characters"):
        mf.read_density(tmp_path / "own.json")
    (tmp_path / "many.json").write_text(changed(P22={"r": [1] * 200_000, "values": [1] * 200_000}))
    with pytest.raises(ValueError, match="at most 131072 numbers"):
        mf.read_density(tmp_path / "many.json")


def npz(path: pathlib.Path, **arrays: Any) -> pathlib.Path:
    np.savez_compressed(path, **arrays, allow_pickle=True)
    return path


def test_hostile_archives_are_one_sentence(tmp_path: pathlib.Path) -> None:
    stated = {"kind": "microfacet density", "version": 1}
    pickled = {"P22.r": np.array([{"a": 1}], dtype=object), "P22.values": R}
    claims = tmp_path / "claims.npz"
    with zipfile.ZipFile(claims, "w") as archive:
        header = b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999,), }"
        archive.writestr("P22.r.npy", header.ljust(127) + b"\n")
    cases = {
        "pickle": (npz(tmp_path / "pickle.npz", **stated, **pickled), "never loaded"),
        "bomb": (npz(tmp_path / "bomb.npz", **stated, **{"P22.r": np.zeros(2**24)}), "unpacks to more than"),
        "many": (npz(tmp_path / "many.npz", **stated, **{"P22.r": np.zeros(2**18)}), "the limit is 131072"),
        "shape": (
            npz(tmp_path / "shape.npz", **stated, **{"P22.r": np.ones((3, 3)), "P22.values": R}),
            "P22.r",
        ),
        "claims": (claims, "own|claims"),
    }
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"PK\x03\x04" + bytes(100))
    for path, message in (*cases.values(), (broken, "broken")):
        with pytest.raises(ValueError, match=message) as caught:
            mf.read_density(path)
        assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match="no such file"):
        mf.read_density(tmp_path / "missing.json")
    with pytest.raises(ValueError, match="this is a folder"):
        mf.read_density(tmp_path)


def test_nothing_is_left_where_writing_fails(tmp_path: pathlib.Path) -> None:
    ndf = mf.RadialNDF(lambda r: np.exp(-(r**4)))
    with pytest.raises(ValueError, match=r"must end in .json, .npz"):
        ndf.save(tmp_path / "own.txt")
    with pytest.raises(FileNotFoundError):
        ndf.save(tmp_path / "no" / "own.json")
    assert not list(tmp_path.iterdir())
