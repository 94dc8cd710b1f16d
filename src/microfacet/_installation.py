"""Where the C++ headers and the CMake package of this installation are."""

from __future__ import annotations

from pathlib import Path

__all__ = ["get_cmake_dir", "get_include"]


def get_include() -> str:
    """The folder of the C++ headers, for a compiler's ``-I``.

    Returns
    -------
    str
        The folder that has ``microfacet/smith/ndf.hpp`` and all else that is included as ``microfacet/...``.

    Examples
    --------
    >>> import pathlib
    >>> import microfacet as mf
    >>> pathlib.Path(mf.get_include(), "microfacet", "smith", "ndf.hpp").exists()
    True
    """
    here = Path(__file__).parent
    installed = here / "include"
    return str(installed if installed.is_dir() else here.parent.parent / "include")


def get_cmake_dir() -> str:
    """The folder of the CMake package, for ``find_package(microfacet)`` with ``-Dmicrofacet_DIR=...``.

    Returns
    -------
    str
        The folder that has ``microfacet-config.cmake``.

    Raises
    ------
    FileNotFoundError
        If microfacet runs from a source tree: installing it makes the CMake package.

    Examples
    --------
    >>> import pathlib
    >>> import microfacet as mf
    >>> pathlib.Path(mf.get_cmake_dir(), "microfacet-config.cmake").exists()
    True
    """
    folder = Path(__file__).parent / "share" / "cmake" / "microfacet"
    if not folder.is_dir():
        raise FileNotFoundError(
            f"there is no CMake package at {folder}: only an installed microfacet has one"
        )
    return str(folder)
