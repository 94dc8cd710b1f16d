"""How much memory files take: what they hold decides, not what they or our limits allow."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microfacet as mf
from hostile_cases import archive, x3p_index
from microfacet._surface.read import slope_tables
from microfacet._surface.read import slopes as slope_files

SIDE = 1500
BYTES = 8 * SIDE * SIDE


def peak(read: Callable[[], Any]) -> int:
    """Bytes that were in use at once, at most, of those that reading took."""
    tracemalloc.start()
    try:
        read()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def heights(dtype: str) -> np.ndarray:
    return (1000 * np.random.default_rng(1).normal(size=(SIDE, SIDE))).astype(dtype)


@pytest.mark.parametrize(("code", "dtype"), [("I", "<i2"), ("L", "<i4"), ("F", "<f4"), ("D", "<f8")])
@pytest.mark.parametrize("masked", [False, True])
def test_x3p(code: str, dtype: str, masked: bool, tmp_path: Path) -> None:
    """The heights once, their mask, and what compares them with it."""
    index = x3p_index(SIDE, SIDE).replace(
        "<AxisType>A</AxisType><DataType>D", f"<AxisType>A</AxisType><DataType>{code}"
    )
    members = {"main.xml": index, "bindata/data.bin": heights(dtype).tobytes()}
    if masked:
        link = "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>"
        members["main.xml"] = index.replace("</DataLink>", link)
        members["bindata/valid.bin"] = b"\x7f" * ((SIDE * SIDE + 7) // 8)
    (tmp_path / "map.x3p").write_bytes(archive(members))
    surface = mf.read_surface(tmp_path / "map.x3p")
    assert np.count_nonzero(surface.mask) == SIDE * SIDE * (7 / 8 if masked else 1)
    assert np.array_equal(surface.heights[surface.mask], 1e-6 * heights(dtype)[surface.mask].astype(float))
    assert peak(lambda: mf.read_surface(tmp_path / "map.x3p")) < 1.6 * BYTES


def test_npy_and_npz(tmp_path: Path) -> None:
    np.save(tmp_path / "map.npy", heights("<f8"))
    np.savez(tmp_path / "map.npz", heights=heights("<f8"), pixel_size=1.0)
    np.savez(tmp_path / "turned.npz", heights=heights("<f4").T, pixel_size=1.0)
    assert peak(lambda: mf.read_surface(tmp_path / "map.npy", pixel_size=1.0)) < 1.6 * BYTES
    assert peak(lambda: mf.read_surface(tmp_path / "map.npz")) < 1.6 * BYTES
    assert peak(lambda: mf.read_surface(tmp_path / "turned.npz")) < 2.1 * BYTES


@pytest.mark.parametrize(
    "content", ["0.1,0.2\n0.3,-0.4\n1,0\n2,3", "p q\n\n0.1 0.2\n# no\n0.3 -0.4\n1 0\n2 3\n"]
)
@pytest.mark.parametrize("suffix", [".csv", ".txt", ".dat"])
def test_a_few_slopes(content: str, suffix: str, tmp_path: Path) -> None:
    file = tmp_path / f"slopes{suffix}"
    file.write_text(content)
    assert mf.read_slopes(file).values.tolist() == [[0.1, 0.2], [0.3, -0.4], [1, 0], [2, 3]]
    assert peak(lambda: mf.read_slopes(file)) < 2**20


def test_a_few_heights(tmp_path: Path) -> None:
    (tmp_path / "map.csv").write_text("1 2 4\n\n3 5 9\n4 4 8\n")
    assert peak(lambda: mf.read_surface(tmp_path / "map.csv", pixel_size=1.0)) < 2**20


def test_empty_lines_count_for_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit is on the numbers."""
    monkeypatch.setattr(slope_files, "MAX_PIXELS", 5)
    monkeypatch.setattr(slope_tables, "MAX_PIXELS", 5)
    (tmp_path / "a.csv").write_text("1,2\n\n\n#\n\n3,4\n\n\n\n5,6\n7,8\n9,1")
    assert len(mf.read_slopes(tmp_path / "a.csv")) == 5
    (tmp_path / "a.csv").write_text("1,2\n" * 6)
    with pytest.raises(mf.SurfaceError, match="more than 5 slopes"):
        mf.read_slopes(tmp_path / "a.csv")


def test_a_surface_copies_what_others_could_change() -> None:
    mine = np.random.default_rng(0).normal(size=(8, 9))
    read_only = mine.copy()
    read_only.flags.writeable = False
    for given in (mine, mine.copy()[:], read_only[:], mine.astype("f4"), np.asfortranarray(mine)):
        assert not np.shares_memory(mf.Surface(given, 1.0).heights, given)
    assert mf.Surface(read_only, 1.0).heights is read_only
    mask = np.ones(mine.shape, bool)
    mask[2, 3] = False
    masked = mf.Surface(read_only, 1.0, mask)
    assert np.isnan(masked.heights[2, 3])
    assert np.isfinite(read_only).all()
    infinite = np.where(mask, mine, np.inf)
    infinite.flags.writeable = False
    assert np.isnan(mf.Surface(infinite, 1.0).heights[2, 3])
    assert np.isinf(infinite[2, 3])
