"""Maximum-likelihood fits of the families' slope densities to measured slopes.

`slopes.py` turns slopes into what a likelihood needs, `blocks.py` says where on the map they lie, `model.py`
holds the likelihood of one family and its derivatives, `newton.py` finds the maximum, `errors.py` and
`goodness.py` say how much it is worth, `estimate.py` ranks the families.
"""

from __future__ import annotations

from microfacet._fit.estimate import fit
from microfacet._fit.result import FitResult, Goodness

__all__ = ["FitResult", "Goodness", "fit"]
