"""What the package can do without: which extra brings each library, and the sentence where one is missing.

The base install is NumPy and SciPy. Every other library is imported inside `needed`, asked for with `require`
before long work, or looked for with `installed` where another process imports it, so that the advice on
installing stands here alone.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["EXTRAS", "installed", "needed", "require", "sentence"]

#: The libraries of each extra of pyproject.toml, under the names that are imported.
EXTRAS = {
    "cli": ("click", "rich", "mpmath"),
    "plot": ("matplotlib",),
    "report": ("matplotlib", "mpmath", "jinja2", "latex2mathml", "pybtex"),
    "surface": ("SurfaceTopography", "OpenImageIO", "tifffile"),
    "symbolic": ("sympy",),
    "parquet": ("pyarrow",),
    "dask": ("dask", "distributed"),
    "bake": ("xarray", "zarr", "h5netcdf"),
    "mitsuba": ("mitsuba", "drjit", "nanobind", "platformdirs"),
    "jax": ("jax",),
    "torch": ("torch",),
}
# The smallest extra that has a library stands first.
_EXTRA_OF = {library: extra for extra, libraries in reversed(EXTRAS.items()) for library in libraries}


def sentence(what: str, library: str, extra: str | None = None) -> str:
    """Say that `what` ("figures need") is missing `library`, and which command installs it."""
    extra = extra or _EXTRA_OF[library]
    return (
        f'{what} {library}, which is not installed: pip install ".[{extra}]" in a checkout of microfacet, '
        f'or pip install "WHEEL[{extra}]" with its wheel'
    )


def installed(library: str) -> bool:
    """Whether the library is there, without loading it."""
    try:
        return importlib.util.find_spec(library) is not None
    except (ImportError, ValueError):  # ValueError: sys.modules holds None for it, it is switched off
        return False


def require(what: str, extra: str) -> None:
    """Raise ImportError with one sentence where a library of the extra is missing."""
    for library in EXTRAS[extra]:
        if not installed(library):
            raise ImportError(sentence(what, library, extra), name=library)


@contextmanager
def needed(what: str) -> Iterator[None]:
    """Raise ImportError with one sentence where a library that is imported in this block is missing.

    A library that is there and fails to import says itself what is wrong.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        if library not in _EXTRA_OF:
            raise
        raise ImportError(sentence(what, library), name=library) from None
