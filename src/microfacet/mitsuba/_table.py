"""Densities of one's own as parameters of the plugins: their tables in single precision, as text."""

from __future__ import annotations

import base64
from pathlib import Path

from microfacet._files import replacing
from microfacet._radial import RadialNDF

__all__ = ["table", "write_table"]

_HEADING = "microfacet tables 1:"


def table(ndf: RadialNDF) -> dict[str, str]:
    """A density of your own as parameters of both materials, whose roughness the scene gives.

    Parameters
    ----------
    ndf : RadialNDF
        Its density counts, not its roughness.

    Returns
    -------
    dict of str to str
        ``distribution`` and ``tables``, which belong into the dictionary of the material.

    Raises
    ------
    ValueError
        If the density is no RadialNDF, or is smooth only piece by piece.

    Examples
    --------
    >>> import mitsuba as mi
    >>> import numpy as np
    >>> import microfacet as mf
    >>> mi.set_variant("scalar_rgb")
    >>> from microfacet.mitsuba import table
    >>> own = table(mf.RadialNDF(lambda r: (1 + r * r) ** -2.5))
    >>> bsdf = mi.load_dict({"type": "microfacet_conductor", "alpha": 0.3, **own})
    """
    return {"distribution": "table", "tables": _text(ndf)}


def write_table(path: str | Path, ndf: RadialNDF) -> None:
    """Write the tables of a density of your own to a file, for the plugins' ``filename``.

    Parameters
    ----------
    path : path-like
        The file, of some ten kilobytes.
    ndf : RadialNDF
        As of `table`.

    Examples
    --------
    >>> import os, tempfile
    >>> import microfacet as mf
    >>> from microfacet.mitsuba import write_table
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_table(os.path.join(folder, "own.tables"), mf.RadialNDF(lambda r: (1 + r * r) ** -2.5))
    ...     os.listdir(folder)
    ['own.tables']
    """
    text = _text(ndf)
    with replacing(path) as stream:
        stream.write(text.encode() + b"\n")


def _text(ndf: RadialNDF) -> str:
    if not isinstance(ndf, RadialNDF):
        raise ValueError(f"table: ndf must be a RadialNDF, got {type(ndf).__name__}")
    if not ndf._prepared:
        raise ValueError(
            "table: the density is smooth only piece by piece, of which the plugins have no tables"
        )
    single: bytes = ndf.kernels.tables(False, ndf._handle)
    return _HEADING + base64.b64encode(single).decode()
