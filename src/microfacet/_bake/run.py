"""Bake a table: compute its cells, on threads or on a cluster, and write it."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import microfacet as mf
from microfacet._bake.cell import compute
from microfacet._bake.journal import Journal, provenance
from microfacet._bake.recipe import Recipe, recipe
from microfacet._bake.store import place, put, require_replaceable
from microfacet._optional import needed, require
from microfacet._radial import RadialNDF

__all__ = ["bake"]

Array = NDArray[np.float64]
Cells = Iterator[tuple[int, dict[str, Array]]]
WRITERS = {".nc": "h5netcdf", ".zarr": "zarr"}  # the libraries that write these endings


def bake(
    kind: str,
    family: str | RadialNDF,
    *,
    alpha: ArrayLike,
    shape: ArrayLike | None = None,
    material: str = "conductor",
    eta: ArrayLike | None = None,
    k: float = 0.0,
    cos_theta: ArrayLike | int = 32,
    azimuth: ArrayLike | int = 13,
    scattering: str = "multiple",
    walks: int = 10_000,
    seed: int = 0,
    output: str | Path | None = None,
    threads: int | None = None,
    dask: str | None = None,
    memory: float = 2**31,
    progress: Callable[[str, int, int], None] = lambda *_: None,
    command: str | None = None,
) -> Any:
    """Tabulate a material over a grid, into a labelled dataset and a file.

    Parameters
    ----------
    kind : {"albedo", "energy", "split_sum", "bsdf"}
        Albedos of one order and of all; what one order misses of them, and its average; scale and bias of the
        albedo F0 scale + bias of one order with Schlick's reflectance; or f.
    family : str or RadialNDF
        Such as "student_t"; or a density of your own, at the roughnesses of the grid.
    alpha, shape : array_like
        Grids of the isotropic roughness and of the family's shape parameter, where it has one.
    material : {"conductor", "dielectric"}
        A dielectric is tabulated in mode "importance", of which nothing is lost.
    eta, k : array_like, float
        A grid of relative indices of a dielectric; the one index of a conductor, a perfect mirror by default.
    cos_theta, azimuth : array_like or int
        Grids of directions. A number n stands for 1/n, 2/n, ... 1, and for n azimuths from 0 to pi.
    scattering : {"multiple", "single"}
        Of kind "bsdf".
    walks, seed : int
        Random walks of each direction, or pair of them, and their seed.
    output : path, optional
        NAME.nc (NetCDF 4) or NAME.zarr. It appears when it is whole. A bake that was interrupted goes on when
        it is called again, and the result is the same bit by bit.
    threads : int, optional
        All processors by default.
    dask : str, optional
        Address of the scheduler of a dask cluster that computes instead.
    memory : float
        In bytes: larger tables are refused.
    progress : callable
        Called with a text, how many cells are done, and how many there are.
    command : str, optional
        Recorded with the table.

    Returns
    -------
    xarray.Dataset
        With the grids as coordinates, and all that the numbers depend on as attributes.

    Raises
    ------
    ValueError
        If an argument lies outside its domain, or the table is too large; nothing has been written then.

    Examples
    --------
    >>> import microfacet as mf
    >>> table = mf.bake("energy", "ggx", alpha=[0.5, 1.0], cos_theta=4)
    >>> print(f"{float(table.missing.sel(alpha=1.0, cos_theta=1.0)):.6f}")
    0.693147
    """
    xarray = _xarray()
    if dask is not None:
        require("a dask cluster needs", "dask")
    what = recipe(
        kind, family, alpha=alpha, shape=shape, material=material, eta=eta, k=k, cos_theta=cos_theta,
        azimuth=azimuth, scattering=scattering, walks=walks, seed=seed,
    )  # fmt: skip
    if what.bytes > memory:
        raise ValueError(
            f"bake: the table needs {what.bytes / 1e9:.3g} GB, more than the {memory / 1e9:.3g} GB it may "
            "take: choose coarser grids, or allow more memory"
        )
    origin = provenance(
        command or f"microfacet.bake({kind!r}, {what.family!r}, ...)", _date(), mf.__version__
    )
    if output is None:
        cells = dict(_told(_compute(what, range(what.cells), threads, dask), what, 0, progress))
        return _dataset(xarray, what, cells, origin)
    target = place(output)
    require_replaceable(target)
    _require_writer(target)
    with Journal(target, what, origin).opened() as journal:
        cells = journal.done()
        missing = [cell for cell in range(what.cells) if cell not in cells]
        for cell, values in _told(_compute(what, missing, threads, dask), what, len(cells), progress):
            journal.keep(cell, values)
            cells[cell] = values
        table = _dataset(xarray, what, cells, journal.provenance)
        _write(table, target, what, journal)
        journal.remove()
    return table


def _told(cells: Cells, what: Recipe, done: int, progress: Callable[[str, int, int], None]) -> Cells:
    for cell in cells:
        progress(f"{what.kind} of {what.family}", done, what.cells)
        done += 1
        yield cell


def _compute(what: Recipe, cells: Iterable[int], threads: int | None, dask: str | None) -> Cells:
    """Cells in the order in which they get done."""
    if dask is not None:
        yield from _on_cluster(what, cells, dask)
        return
    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        futures = {pool.submit(compute, what, cell): cell for cell in cells}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _on_cluster(what: Recipe, cells: Iterable[int], address: str) -> Cells:
    from distributed import Client
    from distributed import as_completed as completed

    with Client(address) as client:
        futures = {client.submit(compute, what, cell): cell for cell in cells}
        for future, values in completed(futures, with_results=True):
            yield futures[future], values


def _dataset(xarray: Any, what: Recipe, cells: dict[int, dict[str, Array]], origin: dict[str, str]) -> Any:
    outer = tuple(len(axis) for axis in what.outer.values())
    variables = {}
    for name, directional in what.variables.items():
        stacked = np.stack([cells[cell][name] for cell in range(what.cells)])
        dims = (*what.outer, *(what.inner if directional else ()))
        variables[name] = (dims, stacked.reshape(*outer, *stacked.shape[1:]))
    coordinates = {name: np.array(axis) for name, axis in (what.outer | what.inner).items()}
    return xarray.Dataset(variables, coordinates, what.attributes | origin)


def _chunks(what: Recipe) -> dict[str, int]:
    """A cell of f is a chunk; the small tables are one."""
    outer = {name: 1 if what.kind == "bsdf" else len(axis) for name, axis in what.outer.items()}
    return outer | {name: len(axis) for name, axis in what.inner.items()}


def _date() -> str:
    """Now, or what a reproducible build takes for it (SOURCE_DATE_EPOCH)."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    now = datetime.now(UTC) if epoch is None else datetime.fromtimestamp(int(epoch), UTC)
    return now.isoformat(timespec="seconds")


def _xarray() -> Any:
    with needed("tables need"):
        import xarray
    return xarray


def _require_writer(target: Path) -> None:
    """Find out before hours of computing whether their result can be written."""
    with needed(f"writing {target.suffix} needs"):
        importlib.import_module(WRITERS[target.suffix])


def _write(table: Any, target: Path, what: Recipe, journal: Journal) -> None:
    """Beside the cells; what is whole then takes the place of what was there."""
    chunks = _chunks(what)
    shapes = {name: tuple(chunks[dim] for dim in variable.dims) for name, variable in table.data_vars.items()}
    new = journal.place(f"new{target.suffix}")
    if target.suffix == ".nc":
        encoding = {name: {"chunksizes": shape, "zlib": True} for name, shape in shapes.items()}
        table.to_netcdf(new, engine="h5netcdf", encoding=encoding)
    else:
        encoding = {name: {"chunks": shape} for name, shape in shapes.items()}
        table.to_zarr(new, mode="w", zarr_format=2, consolidated=True, encoding=encoding)
    put(new, target, journal.folder / "old")
