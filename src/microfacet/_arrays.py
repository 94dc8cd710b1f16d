"""Functions of NumPy arrays on arrays of other libraries: lazy on those of dask, labelled on those of xarray.

Both handle elementwise ufuncs by themselves. What draws or scatters has results of other shapes, for which
`lifted` says to them which axes are components.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

__all__ = ["as_array", "is_foreign", "lifted", "numbered"]

COMPONENTS = "xyz"  # the name of the axis of directions, unless an argument brings one

Argument = tuple[Any, str]


def _is_of(library: str, array: object) -> bool:
    return type(array).__module__.partition(".")[0] == library and hasattr(array, "shape")


def is_foreign(array: object) -> bool:
    """Whether it is an array of dask or xarray."""
    return _is_of("dask", array) or _is_of("xarray", array)


def as_array(values: Any) -> Any:
    """An array of NumPy, dask or xarray."""
    return values if type(values) is np.ndarray or is_foreign(values) else np.asanyarray(values)


def lifted(function: Callable[..., Any], *arguments: Argument, results: tuple[str, ...] = ("",)) -> Any:
    """`function` of the arrays, block by block where they are those of dask, with the labels of xarray.

    Each argument is an array and what its last axis holds: "w" the components of a direction, "xi" uniform
    numbers, "" nothing in particular. The other axes broadcast and come first in the results, followed by the
    channels of a material, and by the components where `results` says "w".
    """
    for array, _ in arguments:
        if type(array) is not np.ndarray and is_foreign(array):
            break
    else:
        return function(*[array for array, _ in arguments])
    empty = function(*(np.zeros((0, *_core(array, kind)), array.dtype) for array, kind in arguments))
    samples = [np.asarray(sample) for sample in (empty if len(results) > 1 else (empty,))]
    labels = _labels(arguments)
    own = [_axes(sample.ndim - 1, kind, labels) for sample, kind in zip(samples, results, strict=True)]
    lift = _labelled if any(_is_of("xarray", array) for array, _ in arguments) else _lazy
    found = lift(function, arguments, samples, own)
    return tuple(found) if len(results) > 1 else found[0]


def numbered(*arguments: Argument) -> Argument:
    """The numbers 0, 1, 2, ... of the elements that the arguments broadcast to, as one more argument."""
    arrays = [array for array, _ in arguments]
    if any(_is_of("xarray", array) for array in arrays):
        import xarray as xr

        places = [
            array.isel({array.dims[-1]: 0}, drop=True) if kind else array
            for array, kind in arguments
            if isinstance(array, xr.DataArray)
        ]
        like = xr.broadcast(*places)[0]
        return xr.DataArray(_count(like.shape), dims=like.dims), ""
    shape = np.broadcast_shapes(*(a.shape[: a.ndim - bool(kind)] for a, kind in arguments))
    return _count(shape), ""


def _count(shape: tuple[int, ...]) -> Any:
    return np.arange(float(math.prod(shape))).reshape(shape)


def _core(array: Any, kind: str) -> tuple[int, ...]:
    return tuple(array.shape[-1:]) if kind else ()


def _labels(arguments: tuple[Argument, ...]) -> tuple[str, dict[Any, Any]]:
    """The name and the coordinates of the components of directions."""
    for array, kind in arguments:
        if kind == "w" and _is_of("xarray", array):
            last = array.dims[-1]
            return last, {name: c for name, c in array.coords.items() if c.dims == (last,)}
    return COMPONENTS, {}


def _axes(count: int, kind: str, labels: tuple[str, dict[Any, Any]]) -> list[str]:
    """Names of a result's own axes."""
    behind = [labels[0]] if kind == "w" else []
    channels = count - len(behind)
    return [f"channel_{j}" if channels > 1 else "channel" for j in range(channels)] + behind


def _sizes(samples: list[Any], own: list[list[str]]) -> dict[str, int]:
    pairs = zip(samples, own, strict=True)
    return {name: n for sample, axes in pairs for name, n in zip(axes, sample.shape[1:], strict=True)}


def _lazy(
    function: Callable[..., Any], arguments: tuple[Argument, ...], samples: list[Any], own: list[list[str]]
) -> list[Any]:
    import dask.array as da

    inputs = ",".join(f"(axis_{i})" if kind else "()" for i, (_, kind) in enumerate(arguments))
    outputs = ",".join(f"({','.join(axes)})" for axes in own)
    dtypes = [sample.dtype for sample in samples]
    results = da.apply_gufunc(
        function,
        f"{inputs}->{outputs}",
        *(array for array, _ in arguments),
        output_dtypes=dtypes if len(samples) > 1 else dtypes[0],
        output_sizes=_sizes(samples, own),
        allow_rechunk=True,
    )
    return list(results) if len(samples) > 1 else [results]


def _labelled(
    function: Callable[..., Any], arguments: tuple[Argument, ...], samples: list[Any], own: list[list[str]]
) -> list[Any]:
    import xarray as xr

    given, cores = [], []
    for i, (array, kind) in enumerate(arguments):
        cores.append([f"axis_{i}"] if kind else [])
        if kind and isinstance(array, xr.DataArray):
            last = array.dims[-1]
            of_axis = [name for name, coordinate in array.coords.items() if last in coordinate.dims]
            array = array.drop_vars(of_axis).rename({last: cores[-1][0]})
        given.append(array)
    results = xr.apply_ufunc(
        function,
        *given,
        input_core_dims=cores,
        output_core_dims=own,
        join=xr.get_options()["arithmetic_join"],
        keep_attrs=True,
        dask="parallelized",
        output_dtypes=[sample.dtype for sample in samples],
        dask_gufunc_kwargs={"output_sizes": _sizes(samples, own), "allow_rechunk": True},
    )
    name, coordinates = _labels(arguments)
    several = results if len(samples) > 1 else (results,)
    return [result.assign_coords(coordinates) if name in result.dims else result for result in several]
