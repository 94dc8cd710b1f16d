"""Who may put what into the cache of compiled plugins: we and root, and nobody else."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("mitsuba")
if os.name == "nt":
    pytest.skip("owners and modes of POSIX", allow_module_level=True)

from microfacet.mitsuba import _cache, _llvm

STRANGER = 4321
NAME = "scalar_rgb-0123456789abcdef0123.so"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, not made yet."""
    monkeypatch.setenv("MICROFACET_CACHE", str(tmp_path / "cache"))
    return _cache.directory()


@pytest.fixture
def library(cache: Path) -> Path:
    """A library that has passed its check."""
    with _cache.locked("scalar_rgb"):
        path = cache / NAME
        path.write_bytes(b"ELF")
        path.chmod(0o755)
        _cache.write_record(path, "")
    assert _cache.read_record(path) == ""
    return path


def give_away(path: Path) -> None:
    try:
        os.chown(path, STRANGER, -1, follow_symlinks=False)
    except PermissionError:
        pytest.skip("only root gives files away")


def of_another_user(path: Path) -> None:
    give_away(path)


def writable_by_all(path: Path) -> None:
    path.chmod(0o666)


def writable_by_a_group(path: Path) -> None:
    path.chmod(0o664)


def a_link(path: Path) -> None:
    path.rename(path.with_suffix(".moved"))
    path.symlink_to(path.with_suffix(".moved"))


def a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


CHANGES = [of_another_user, writable_by_all, writable_by_a_group, a_link, a_pipe]
each_change = pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)


@each_change
@pytest.mark.parametrize("suffix", [".so", ".json"])
def test_what_others_could_have_written_is_not_loaded(
    change: Callable[[Path], None], suffix: str, library: Path
) -> None:
    change(library.with_suffix(suffix))
    assert _cache.read_record(library) is None
    _rebuild(library)
    assert _cache.read_record(library) == ""


def _rebuild(library: Path) -> None:
    """As the module that compiles does."""
    new = library.with_name("linked")
    new.write_bytes(b"ELF again")
    new.chmod(0o755)
    os.replace(new, library)
    _cache.write_record(library, "")


@pytest.mark.parametrize("mask", [0o000, 0o002, 0o022, 0o077])
def test_the_umask_does_not_matter(mask: int, cache: Path) -> None:
    before = os.umask(mask)
    try:
        with _cache.locked("scalar_rgb"):
            path = cache / NAME
            path.write_bytes(b"ELF")
            path.chmod(0o755)
            _cache.write_record(path, "")
    finally:
        os.umask(before)
    assert stat.S_IMODE(cache.stat().st_mode) == 0o700
    assert _cache.read_record(path) == ""


def test_a_folder_that_others_could_write_is_closed(library: Path) -> None:
    """As earlier versions made it under a umask that leaves rights to a group."""
    library.parent.chmod(0o775)
    assert _cache.read_record(library) is None
    with _cache.locked("scalar_rgb"):
        assert stat.S_IMODE(library.parent.stat().st_mode) == 0o755
        assert _cache.read_record(library) == ""


def test_the_folder_of_another_user_is_refused(library: Path) -> None:
    give_away(library.parent)
    assert _cache.read_record(library) is None
    with (
        pytest.raises(
            ImportError, match=f"belongs to user {STRANGER}, .* choose another in MICROFACET_CACHE"
        ),
        _cache.locked("scalar_rgb"),
    ):
        pass


def test_a_link_of_another_user_is_refused(library: Path) -> None:
    library.parent.rename(library.parent.with_name("real"))
    library.parent.symlink_to(library.parent.with_name("real"))
    assert _cache.read_record(library) == ""  # a link of our own
    give_away(library.parent)
    assert _cache.read_record(library) is None
    with pytest.raises(ImportError, match="belongs to user"), _cache.locked("scalar_rgb"):
        pass


def test_locks_and_records_follow_no_links(cache: Path, tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.write_text("mine")
    cache.mkdir(parents=True, mode=0o700)
    (cache / "scalar_rgb.lock").symlink_to(precious)
    with pytest.raises(ImportError, match="cannot be written"), _cache.locked("scalar_rgb"):
        pass
    path = cache / NAME
    path.write_bytes(b"ELF")
    path.chmod(0o755)
    path.with_suffix(".json").symlink_to(precious)
    _cache.write_record(path, "")
    assert _cache.read_record(path) == ""
    assert precious.read_text() == "mine"


@pytest.mark.parametrize("text", ["[" * 100_000, "[]", "0", '"' + "x" * 2**21 + '"', "\xff"], ids=len)
def test_any_record(text: str, library: Path) -> None:
    library.with_suffix(".json").write_bytes(text.encode("latin-1"))
    assert _cache.read_record(library) is None


def test_the_memory_of_llvm_is_of_the_same_kind(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []

    def trial() -> tuple[bool, str]:
        tried.append(1)
        return True, ""

    monkeypatch.setattr(_llvm, "_try", trial)
    usable = _llvm.usable.__wrapped__
    for _ in range(2):
        assert usable() == (True, "")
    assert len(tried) == 1
    (memory,) = cache.glob("llvm-*.json")
    memory.chmod(0o666)
    assert usable() == (True, "")
    assert len(tried) == 2
    assert json.loads(memory.read_text()) is True
    assert not memory.stat().st_mode & 0o022


def test_nothing_of_others_is_dropped(cache: Path) -> None:
    """The folder may be one that a user has chosen, with libraries of the user's own."""
    cache.mkdir(parents=True)
    for number in range(_cache.KEPT + 5):
        for name in (f"libmitsuba{number}.so", f"libmitsuba{number}.json", f"scalar_rgb-{number}f.so"):
            (cache / name).touch()
    _cache.prune(cache)
    assert len(list(cache.glob("libmitsuba*"))) == 2 * (_cache.KEPT + 5)
    assert len(list(cache.glob("scalar_rgb-*"))) == _cache.KEPT
