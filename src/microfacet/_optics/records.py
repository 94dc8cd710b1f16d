"""General formats of a table: CSV in rows, NetCDF as arrays with their axes."""

from __future__ import annotations

import io
import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from microfacet._optional import needed, require

if TYPE_CHECKING:
    from microfacet._optics.brdf import BrdfTable

__all__ = ["csv", "facts", "netcdf", "require_netcdf", "scattered_angles"]

Array = NDArray[np.float64]


def facts(table: BrdfTable) -> dict[str, Any]:
    """What a reader of the file should know, as words and numbers."""
    conventions = (
        "directions point away from the surface; phi counts counter-clockwise from +x; the specular "
    )
    conventions += "direction is theta_s = theta_i, phi_s = phi_i + 180"
    return {
        "title": f"{table.scatter} of {table.ndf.family} facets, predicted by microfacet",
        "family": table.ndf.family,
        "parameters": json.dumps({name: float(value) for name, value in table.ndf.parameters.items()}),
        "scatter": table.scatter,
        "scattering": table.scattering,
        "reference": table.reference,
        "conventions": conventions,
        "notes": "; ".join(table.notes),
    }


def scattered_angles(table: BrdfTable) -> tuple[Array, Array]:
    """theta_s and phi_s in degrees, (theta_i, phi_i, azimuth, polar): from the normal on the light's side, or
    on the other one for a BTDF.
    """
    if table.reference == "normal":
        shape = (len(table.theta_i), len(table.phi_i), len(table.azimuth), len(table.polar))
        theta, phi = np.broadcast_arrays(table.polar, table.azimuth[:, np.newaxis])
        return np.broadcast_to(theta, shape), np.broadcast_to(phi, shape)
    wo = table.directions()[1]
    theta = np.degrees(np.arctan2(np.hypot(wo[..., 0], wo[..., 1]), wo[..., 2]))
    return theta, np.degrees(np.arctan2(wo[..., 1], wo[..., 0])) % 360


def csv(table: BrdfTable, stream: BinaryIO) -> None:
    """One row for each wavelength and pair of directions; the unit of a column is in its name."""
    theta_s, phi_s = scattered_angles(table)
    shape = table.values.shape
    k, i, j, a, p = (index.ravel() for index in np.indices(shape))
    columns = {
        "wavelength_m": table.wavelengths[k],
        "n": table.index.real[k],
        "k": table.index.imag[k],
        "theta_i_deg": table.theta_i[i],
        "phi_i_deg": table.phi_i[j],
        "theta_s_deg": theta_s[i, j, a, p],
        "phi_s_deg": phi_s[i, j, a, p],
    }
    if table.reference == "specular":
        columns |= {"radial_deg": table.polar[p], "azimuth_deg": table.azimuth[a]}
    name = table.scatter.lower()
    columns |= {
        f"{name}_per_sr": table.values.ravel(),
        f"{name}_error_per_sr": table.errors.ravel(),
        f"{name}_single_per_sr": table.single.ravel(),
        "albedo": table.albedo[k, i, j],
        "albedo_error": table.albedo_error[k, i, j],
        "albedo_single": table.albedo_single[k, i, j],
    }
    text = io.TextIOWrapper(stream, encoding="ascii", newline="", write_through=True)
    text.write(",".join(columns) + "\n")
    forms = ["%.9g"] * len(columns)
    np.savetxt(text, np.column_stack(list(columns.values())), fmt=forms, delimiter=",", newline="\n")
    text.detach()


def require_netcdf() -> None:
    """ImportError in one sentence where what writes NetCDF is missing."""
    require("NetCDF needs", "bake")


def netcdf(table: BrdfTable, stream: BinaryIO) -> None:
    """A dataset of xarray, with units and what is known of the table as attributes."""
    with needed("NetCDF needs"):
        import xarray

    light = ("wavelength", "theta_i", "phi_i")
    names = ("polar", "azimuth") if table.reference == "specular" else ("theta_s", "phi_s")
    axes = (*light, names[1], names[0])
    per_sr, degrees = {"units": "sr-1"}, {"units": "degree"}
    name = table.scatter.lower()
    dataset = xarray.Dataset(
        {
            name: (
                axes,
                table.values,
                per_sr | {"long_name": f"{table.scatter}, {table.scattering} scattering"},
            ),
            f"{name}_error": (axes, table.errors, per_sr | {"long_name": "standard error of the walks"}),
            f"{name}_single": (axes, table.single, per_sr | {"long_name": f"{table.scatter} of one order"}),
            "albedo": (light, table.albedo, {"units": "1", "long_name": "directional albedo of all orders"}),
            "albedo_error": (light, table.albedo_error, {"units": "1", "long_name": "of the walks"}),
            "albedo_single": (light, table.albedo_single, {"units": "1", "long_name": "of one order"}),
            "n": (light[:1], table.index.real, {"units": "1"}),
            "k": (light[:1], table.index.imag, {"units": "1"}),
        },
        {
            "wavelength": ("wavelength", table.wavelengths, {"units": "m"}),
            "theta_i": ("theta_i", table.theta_i, degrees),
            "phi_i": ("phi_i", table.phi_i, degrees),
            names[0]: (names[0], table.polar, degrees),
            names[1]: (names[1], table.azimuth, degrees),
        },
        facts(table),
    )
    with tempfile.TemporaryDirectory(prefix="microfacet-") as folder:
        whole = Path(folder) / "table.nc"
        dataset.to_netcdf(whole, engine="h5netcdf")
        stream.write(whole.read_bytes())
