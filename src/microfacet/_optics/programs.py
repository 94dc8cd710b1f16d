"""Formats of optics programs, written as their public descriptions say; none of the programs was at hand."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from microfacet._optics import grid
from microfacet._optics.records import facts

if TYPE_CHECKING:
    from microfacet._optics.brdf import BrdfTable

__all__ = ["astm", "lighttools", "zemax"]


def astm(table: BrdfTable, stream: BinaryIO) -> None:
    """Text in the manner of ASTM E1392 as files of public databases have it: keywords, the names of the
    variables, and rows of angles in radians with a value for every wavelength.
    """
    lines = [f"{name.upper()} {said}" for name, said in facts(table).items() if said]
    names = ["theta_i", "phi_i", "theta_s", "phi_s", *(f"{1e9 * w:g}nm" for w in table.wavelengths)]
    shape = table.values.shape[1:]
    lines += [f"NUM_POINTS {int(np.prod(shape))}", f"VARS {','.join(names)}"]
    i, j, a, p = (index.ravel() for index in np.indices(shape))
    angles = np.radians([table.theta_i[i], table.phi_i[j], table.polar[p], table.azimuth[a]])
    values = table.values.reshape(len(table.wavelengths), -1)
    _lines(stream, lines)
    np.savetxt(stream, np.concatenate((angles, values)).T, fmt="%.9g", delimiter=",", newline="\n")


def zemax(table: BrdfTable, number: int, stream: BinaryIO) -> None:
    """Zemax' tabular BSDF (BSDF data interchange): one wavelength, blocks of rows of azimuth.

    Every block is one sample rotation and angle of incidence and begins with the total integrated scatter, a
    part of the incident light.
    """
    symmetric = grid.symmetric(table.ndf, table.phi_i) and float(table.azimuth[-1]) <= 180
    plane = "PlaneSymmetrical" if symmetric else "Asymmetrical"
    symmetry = plane if len(table.phi_i) == 1 else "Asymmetrical4D"
    lines = [f"#{text}" for text in _comments(table, number)]
    lines += ["Source  Measured", f"Symmetry  {symmetry}", "SpectralContent  Monochrome"]
    lines += [f"ScatterType  {table.scatter}"]
    for name, angles in (
        ("SampleRotation", table.phi_i),
        ("AngleOfIncidence", table.theta_i),
        ("ScatterAzimuth", table.azimuth),
        ("ScatterRadial", table.polar),
    ):
        lines += [f"{name}  {len(angles)}", _row(angles)]
    lines += ["", "Monochrome", "DataBegin"]
    for j in range(len(table.phi_i)):
        for i in range(len(table.theta_i)):
            lines.append(f"TIS  {table.albedo[number, i, j]:.6g}")
            lines += [_row(row, ".4E") for row in table.values[number, i, j]]
    _lines(stream, [*lines, "DataEnd"])


def lighttools(table: BrdfTable, number: int, stream: BinaryIO) -> None:
    """A BSDF of LightTools: one wavelength, a block for every direction of the light.

    Angles count from the normal. Light of an isotropic surface comes from azimuth 90 there, so all azimuths
    are turned by 90 degrees.
    """
    azimuth = (table.azimuth + 90) % 360
    order = np.argsort(azimuth, kind="stable")
    lines = [f"# {text}" for text in _comments(table, number)]
    lines += ["Source  Generated", "Symmetry  Asymmetric", "SpectralContent  Monochrome"]
    lines += [f"ScatterAzimuth  {len(azimuth)}", _row(azimuth[order])]
    lines += [f"ScatterRadial  {len(table.polar)}", _row(table.polar), "DataBegin"]
    for i, theta in enumerate(table.theta_i):
        for j, phi in enumerate(table.phi_i):
            lines += [f"AOI  {theta:g}", f"POI  {(phi + 90) % 360:g}", "Side  Front"]
            lines += [f"Wavelength  {1e9 * table.wavelengths[number]:g}", f"ScatterType  {table.scatter}"]
            lines.append(f"TIS  {table.albedo[number, i, j]:.6g}")
            lines += [_row(row, ".4E") for row in table.values[number, i, j][order]]
    _lines(stream, [*lines, "DataEnd"])


def _comments(table: BrdfTable, number: int) -> list[str]:
    index = table.index[number]
    return [
        f"{name}: {said}"
        for name, said in (
            facts(table)
            | {"wavelength": f"{1e9 * table.wavelengths[number]:g} nm", "n": index.real, "k": index.imag}
        ).items()
        if said != ""
    ]


def _row(numbers: Iterable[float], form: str = ".6g") -> str:
    return "  ".join(format(float(number), form) for number in numbers)


def _lines(stream: BinaryIO, lines: Iterable[str]) -> None:
    stream.write(("\n".join(lines) + "\n").encode("ascii", "replace"))
