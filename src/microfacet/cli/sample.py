"""The command `microfacet sample`: normals as a file or a stream, in blocks, so that memory stays bounded."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import click
import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from microfacet._files import ending, replacing
from microfacet._optional import needed
from microfacet.cli.densities import DensityCommand, density_option
from microfacet.cli.parameters import distribution, family_named, parameter_options
from microfacet.cli.printing import announce, progress_line, where
from microfacet.cli.program import json_option

__all__ = ["Draw", "View", "sample", "save", "write_csv"]

Array = NDArray[Any]
#: Told what is written, how many normals are, and how many will be.
Progress = Callable[[str, int, int], None]

_BLOCK = 2**16


@click.command(cls=DensityCommand)
@click.argument("family")
@density_option
@click.option(
    "-n", "--count", type=click.IntRange(min=1), default=10, show_default=True, help="How many normals."
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Same seed, same normals."
)
@parameter_options
@click.option(
    "--visible",
    type=click.FloatRange(0.0, 180.0),
    metavar="THETA",
    help="Only normals seen from THETA degrees off the macronormal (above 90: from below the horizon).",
)
@click.option("--phi", type=float, metavar="DEGREES", help="Azimuth of that direction; 0 otherwise.")
@click.option(
    "--scheme",
    type=click.Choice(["continuous", "mixture"]),
    help="How they are drawn: continuous in the random numbers, or cheaper. Both are exact.",
)
@click.option("--bounded", is_flag=True, help="Fewer normals that reflect below the horizon (ggx).")
@click.option("--dtype", type=click.Choice(["float64", "float32"]), default="float64", help="Precision.")
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False), help="FILE.npy, .csv or .parquet; stdout otherwise."
)
@json_option
def sample(
    family: str,
    count: int,
    seed: int,
    parameters: dict[str, float],
    visible: float | None,
    phi: float | None,
    scheme: str | None,
    bounded: bool,
    dtype: str,
    output: str | None,
    as_json: bool,
) -> None:
    """Draw normals from D cos(theta), or those seen from a direction: rows x, y, z.

    The normal in a row depends on the seed and the number of the row alone. With --json a summary is printed,
    and --output says where the normals go.

    \b
    Examples:
      microfacet sample ggx --alpha 0.3
      microfacet sample k0 --alpha 0.3 --visible 85 -n 1000000 --seed 7 -o visible.npy
      microfacet sample ggx --alpha 0.3 --visible 60 --bounded -o normals.csv --json
    """
    if as_json and output is None:
        raise click.UsageError("--json prints a summary: say with --output where the normals go")
    options = {"phi": phi, "scheme": scheme, "bounded": bounded or None}
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    if visible is None and given:
        raise click.UsageError("--phi, --scheme and --bounded go with --visible")
    if scheme and bounded:
        raise click.UsageError("--scheme and --bounded exclude each other")
    view = None if visible is None else View(visible, **given)
    work = Draw(distribution(family_named(family), parameters), count, seed, dtype, view)
    if output is None:
        write_csv(work, sys.stdout.buffer)
        return
    with progress_line() as progress:
        save(work, Path(output), progress)
    announce(json.dumps({"path": where(output), **work.as_dict()}) if as_json else where(output), output)


@dataclass(frozen=True)
class View:
    """Whence normals are seen (degrees), and how they are drawn."""

    theta: float
    phi: float = 0.0
    scheme: str = "continuous"
    bounded: bool = False

    @property
    def direction(self) -> Array:
        """The unit vector: exactly vertical at 0 and 180, exactly horizontal at 90."""
        s, c = (
            math.sin(math.radians(min(self.theta, 180.0 - self.theta))),
            math.sin(math.radians(90.0 - self.theta)),
        )
        phi = math.radians(self.phi)
        return np.array([s * math.cos(phi), s * math.sin(phi), c])


@dataclass(frozen=True)
class Draw:
    """`count` normals of a distribution: which one is where depends on the seed and its number alone."""

    ndf: Any
    count: int
    seed: int
    dtype: str = "float64"
    view: View | None = None

    def __post_init__(self) -> None:
        if self.view is None:
            return
        if self.view.bounded and self.ndf.family != "ggx":
            raise ValueError(f"bounded sampling exists for ggx alone, not for {self.ndf.family}")
        if not (math.isfinite(self.view.theta) and math.isfinite(self.view.phi)):
            given = f"{self.view.theta:g} and {self.view.phi:g}"
            raise ValueError(f"visible and phi must be finite numbers of degrees, got {given}")
        if not self.ndf.sigma(self.view.direction) > 0.0:
            raise ValueError(f"no normal can be seen from {self.view.theta:g} degrees: sigma is 0")

    @property
    def dims(self) -> int:
        """Uniform random numbers of each normal."""
        if self.view is None or self.view.bounded:
            return 2
        return int(self.ndf.mixture_dims if self.view.scheme == "mixture" else self.ndf.visible_dims)

    def block(self, start: int, stop: int) -> Array:
        """The normals number `start` to `stop`, the same whatever was drawn before."""
        generator = np.random.PCG64(self.seed)
        generator.advance(start * self.dims)  # one step for each number
        xi = np.random.Generator(generator).random((stop - start, self.dims))
        if self.dtype == "float32":
            xi = (np.floor(xi * 2.0**24) * 2.0**-24).astype(np.float32)  # rounding would make some of them 1
        if self.view is None:
            return np.asarray(self.ndf.sample(xi))
        w = self.view.direction.astype(self.dtype)
        how: dict[str, Any] = {"bounded": True} if self.view.bounded else {"scheme": self.view.scheme}
        return np.asarray(self.ndf.sample_visible(w, xi, **how))

    def blocks(self) -> Iterator[Array]:
        """All of them."""
        for start in range(0, self.count, _BLOCK):
            yield self.block(start, min(start + _BLOCK, self.count))

    def as_dict(self) -> dict[str, Any]:
        """What was drawn, as a record."""
        view = self.view and {"theta": self.view.theta, "phi": self.view.phi}
        how = self.view and ("bounded" if self.view.bounded else self.view.scheme)
        return {
            "family": self.ndf.family,
            "parameters": self.ndf.parameters,
            "visible": view,
            "scheme": how,
            "count": self.count,
            "seed": self.seed,
            "dims": self.dims,
            "dtype": self.dtype,
        }


def save(draw: Draw, path: Path, progress: Progress = lambda *_: None) -> None:
    """Write .npy of shape (count, 3), .csv or .parquet with columns x, y, z; nothing is left if it fails.

    A pipe or device whose name has no such ending gets .csv.
    """
    format_ = ending(path, _WRITERS, ".csv")
    write = _WRITERS[format_]
    if format_ == ".parquet":
        _arrow()  # fails before anything is drawn

    def told() -> Iterator[Array]:
        done = 0
        for block in draw.blocks():
            progress(path.name, done, draw.count)
            yield block
            done += len(block)

    with replacing(path) as stream:
        write(draw, told(), stream)


def write_csv(draw: Draw, stream: BinaryIO) -> None:
    """Write lines x,y,z under a heading, with every digit."""
    _csv(draw, draw.blocks(), stream)


def _csv(draw: Draw, blocks: Iterator[Array], stream: BinaryIO) -> None:
    form = "{!r},{!r},{!r}\n" if draw.dtype == "float64" else "{:.9g},{:.9g},{:.9g}\n"
    stream.write(b"x,y,z\n")
    for block in blocks:
        stream.write("".join(form.format(*row) for row in block.tolist()).encode())


def _npy(draw: Draw, blocks: Iterator[Array], stream: BinaryIO) -> None:
    little = np.dtype(draw.dtype).newbyteorder("<")
    header = {"descr": little.str, "fortran_order": False, "shape": (draw.count, 3)}
    npy.write_array_header_1_0(stream, header)
    for block in blocks:
        stream.write(block.astype(little, copy=False).tobytes())


def _parquet(draw: Draw, blocks: Iterator[Array], stream: BinaryIO) -> None:
    arrow, parquet = _arrow()
    kind = arrow.float64() if draw.dtype == "float64" else arrow.float32()
    schema = arrow.schema([(name, kind) for name in "xyz"])
    with parquet.ParquetWriter(stream, schema) as writer:
        for block in blocks:
            columns = [arrow.array(np.ascontiguousarray(column)) for column in block.T]
            writer.write_table(arrow.table(columns, schema=schema))


def _arrow() -> tuple[Any, Any]:
    with needed("a .parquet file (.npy and .csv do not) needs"):
        import pyarrow
        import pyarrow.parquet
    return pyarrow, pyarrow.parquet


_WRITERS: dict[str, Callable[[Draw, Iterator[Array], BinaryIO], None]] = {
    ".npy": _npy,
    ".csv": _csv,
    ".parquet": _parquet,
}
