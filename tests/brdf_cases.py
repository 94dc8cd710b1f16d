"""Surfaces and metals whose tables of scattering are tested."""

from __future__ import annotations

import microfacet as mf

__all__ = ["GOLD", "GROUND", "NM", "ROUGH", "TABLES"]

ROUGH = mf.StudentT(alpha=0.3, gamma=2.5)
GROUND = mf.StudentT(alpha_x=0.4, alpha_y=0.15, rotation=0.3, gamma=3.0)
GOLD = [0.97 + 1.87j, 0.25 + 2.90j]
NM = [500e-9, 600e-9]
#: The same gold in files of different makers.
TABLES = {
    "commas": "wavelength_nm,n,k\n600,0.25,2.90\n500,0.97,1.87\n",
    "spaces": "# gold\nwavelength (um)   n    k\n0.5 0.97 1.87\n0.6 0.25 2.90\n",
    "tabs": "\ufeffWavelength[m]\tn\tk\n5e-7\t0.97\t1.87\n6e-7\t0.25\t2.90\n",
    "two parts": "wl,n\n0.5,0.97\n0.6,0.25\n\nwl,k\n0.5,1.87\n0.6,2.90\n",
}
