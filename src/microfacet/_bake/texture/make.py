"""Make a lookup texture: check what is asked for, integrate rows, measure what is missed between texels."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from microfacet._bake.recipe import entry_of, grid, one_of, shape_name
from microfacet._bake.texture.axes import Axis, shape_axis, texel_axis
from microfacet._bake.texture.files import format_of, require_writer
from microfacet._bake.texture.rows import CHANNELS, Row, row
from microfacet._bake.texture.table import LookupTexture
from microfacet._radial import RadialNDF

__all__ = ["lookup_texture"]

Array = NDArray[Any]
Progress = Callable[[str, int, int], None]
Maker = Callable[[float, float], Any]

OWNER = "lookup_texture"
_COSINES = 48  # of a roughness at which the texture is checked
_LARGEST = 4096  # texels along an axis, and
_TEXELS = 2**24  # in all slices
TYPES = ("float32", "float16")


def lookup_texture(
    kind: str,
    family: str | RadialNDF,
    *,
    size: tuple[int, int] = (64, 64),
    shape: ArrayLike | None = None,
    cosine_mapping: str = "linear",
    roughness_mapping: str = "sqrt",
    dtype: str = "float32",
    check: int = 32,
    output: str | Path | None = None,
    format: str | None = None,
    threads: int | None = None,
    progress: Progress = lambda *_: None,
) -> LookupTexture:
    """Tabulate what a real-time renderer looks up: albedo, missing energy, or the split-sum scale and bias.

    Texels are integrals without noise, of one order of scattering with height-correlated masking and
    shadowing.

    Parameters
    ----------
    kind : {"albedo", "energy", "split_sum"}
        The albedo E of a perfect mirror and its average; 1 - E and its average; or scale and bias of the
        albedo F0 scale + bias of a metal with Schlick's reflectance.
    family : str or RadialNDF
        Such as "student_t"; or a density of your own, at the roughnesses of the texels.
    size : (int, int)
        Texels along the cosine, and along the roughness.
    shape : array_like
        The family's shape parameter, where it has one; several values, in equal steps of it, of its logarithm
        or of its reciprocal, are slices of the texture.
    cosine_mapping : {"linear", "sqrt"}
        What grows in equal steps from texel to texel, the cosine or its square root. Texel i of n lies where
        that is (i + 0.5)/n.
    roughness_mapping : {"sqrt", "linear"}
        The same of alpha. Its square root is what engines call the perceptual roughness.
    dtype : {"float32", "float16"}
        Of the texels.
    check : int
        At so many roughnesses (and shapes) between the texels, and 48 cosines for each, what is read from the
        texture is compared with the integral; `errors` says how far apart they are. 0 leaves that out.
    output : path, optional
        NAME.exr, or NAME.raw and NAME.raw.json; it appears when it is whole.
    format : {"exr", "raw"}, optional
        By default as the name says.
    threads : int, optional
        All processors by default.
    progress : callable
        Called with a text, how many rows are done, and how many there are.

    Returns
    -------
    LookupTexture

    Raises
    ------
    ValueError
        If an argument lies outside its domain; nothing has been written then.

    References
    ----------
    C. Kulla and A. Conty, Revisiting physically based shading at Imageworks, SIGGRAPH 2017 course;
    E. Turquin, Practical multiple scattering compensation for microfacet models, 2019; B. Karis, Real shading
    in Unreal Engine 4, SIGGRAPH 2013 course.

    Examples
    --------
    >>> import microfacet as mf
    >>> table = mf.lookup_texture("split_sum", "k0", size=(16, 16), check=0)
    >>> table.values.shape
    (1, 16, 16, 2)
    >>> scale, bias = table.lookup(0.5, 0.25)
    >>> print(f"{scale:.2f} {bias:.2f}")
    0.93 0.03
    """
    one_of(OWNER, "kind", kind, CHANNELS)
    one_of(OWNER, "dtype", dtype, TYPES)
    if not isinstance(check, int | np.integer) or check < 0:
        raise ValueError(f"{OWNER}: check must be a whole number in [0, inf), got {check!r}")
    entry = entry_of(OWNER, family)
    cosine, roughness, third = _axes(entry, size, shape, cosine_mapping, roughness_mapping)
    if output is not None:
        require_writer(format_of(output, format))
    make = _maker(entry, third)
    places = [(alpha, value) for value in (third.values if third else (0.0,)) for alpha in roughness.values]
    for place in (places[0], places[-1]):
        make(*place)  # the ends of the grids: constructors say what lies outside
    rows = _computed(partial(_row, kind, make, np.array(cosine.values)), places, threads)
    values = np.empty((len(places), cosine.count, len(CHANNELS[kind])))
    error = 0.0
    for done, (at, found) in enumerate(rows):
        progress(f"{kind} of {entry.name}", done, len(places))
        values[at], error = found.values, max(error, found.error)
    table = LookupTexture(
        kind=kind,
        family=entry.name,
        values=values.reshape(-1, roughness.count, *values.shape[1:]).astype(dtype),
        cosine=cosine,
        roughness=roughness,
        shape=third,
        errors={"quadrature": error},
    )
    if check:
        progress(f"comparing {kind} of {entry.name}", 0, check)
        table = table._with_errors({"quadrature": error, "lookup": _measured(table, make, check, threads)})
    if output is not None:
        table.save(output, format)
    return table


def _axes(
    entry: Any, size: tuple[int, int], shape: ArrayLike | None, cosine_mapping: str, roughness_mapping: str
) -> tuple[Axis, Axis, Axis | None]:
    """Those of these arguments, or one sentence that says which of them is wrong."""
    for name, mapping in (("cosine_mapping", cosine_mapping), ("roughness_mapping", roughness_mapping)):
        one_of(OWNER, name, mapping, ("linear", "sqrt"))
    if not (
        isinstance(size, Sequence)
        and len(size) == 2
        and all(isinstance(n, int | np.integer) and 2 <= n <= _LARGEST for n in size)
    ):
        raise ValueError(f"{OWNER}: size must be two whole numbers in [2, {_LARGEST}], got {size!r:.80}")
    name = shape_name(entry)
    if bool(name) != (shape is not None):
        text = f"needs {name}, its shape" if name else "has no shape parameter"
        raise ValueError(f"{OWNER}: {entry.name} {text}")
    third = None if shape is None else shape_axis(name, grid(name, shape, OWNER))
    texels = size[0] * size[1] * (third.count if third else 1)
    if texels > _TEXELS:
        raise ValueError(f"{OWNER}: a texture may have {_TEXELS} texels in all, this one has {texels}")
    return (
        texel_axis("cosine", cosine_mapping, int(size[0])),
        texel_axis("alpha", roughness_mapping, int(size[1])),
        third,
    )


def _maker(entry: Any, third: Axis | None) -> Maker:
    """Distributions of a family, from alpha and the shape."""
    cls: Any = entry.cls
    return lambda alpha, value: cls(alpha=alpha) if third is None else cls(alpha=alpha, **{third.name: value})


def _row(kind: str, make: Maker, cosine: Array, place: tuple[float, float]) -> Row:
    return row(kind, make(*place), cosine)


def _computed(
    function: Callable[[Any], Row], places: Sequence[Any], threads: int | None
) -> Iterator[tuple[int, Row]]:
    """Rows, in the order in which they get done, and which of the places each is of."""
    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        futures = {pool.submit(function, place): at for at, place in enumerate(places)}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _measured(table: LookupTexture, make: Maker, check: int, threads: int | None) -> dict[str, Any]:
    """How far what is read between the texels lies from the integral, by channel."""
    from scipy.stats.qmc import Halton

    points = Halton(2, scramble=False)
    points.fast_forward(1)  # the first is the corner
    v, z = points.random(check).T
    alpha = table.roughness.at(v)
    value = table.shape.at(z) if table.shape else np.zeros(check)
    cosine = table.cosine.at((np.arange(_COSINES) + 1 / 3) / _COSINES)
    exact = np.empty((check, _COSINES, len(table.channels)))
    compute = partial(_row, table.kind, make, cosine)
    for at, found in _computed(compute, list(zip(alpha.tolist(), value.tolist(), strict=True)), threads):
        exact[at] = found.values
    difference = np.abs(table.lookup(cosine, alpha[:, np.newaxis], value[:, np.newaxis]) - exact)
    measured: dict[str, Any] = {"points": exact[..., 0].size}
    for k, channel in enumerate(table.channels):
        one = difference[..., k]
        i, j = np.unravel_index(np.argmax(one), one.shape)
        where = {"cosine": float(cosine[j]), "alpha": float(alpha[i])}
        if table.shape:
            where[table.shape.name] = float(value[i])
        measured[channel] = {"mean": float(one.mean()), "largest": float(one.max()), "at": where}
    return measured
