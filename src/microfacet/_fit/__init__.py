"""Maximum-likelihood fits of the families' slope densities to measured slopes.

`slopes.py` turns slopes into what a likelihood needs, `blocks.py` says where on the map they lie, `model.py`
holds the likelihood of one family and its derivatives, `newton.py` finds the maximum, `errors.py` and
`goodness.py` say how much it is worth, `estimate.py` ranks the families. `scales.py` fits at several lags,
`table.py` fits tables.
"""

from __future__ import annotations

from microfacet._fit.estimate import fit
from microfacet._fit.result import FitResult, Goodness, TableFit
from microfacet._fit.scales import ScaleFit, fit_scales
from microfacet._fit.table import fit_table

__all__ = ["FitResult", "Goodness", "ScaleFit", "TableFit", "fit", "fit_scales", "fit_table"]
