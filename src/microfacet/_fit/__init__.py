"""Maximum-likelihood fits of the families' slope densities to measured slopes.

`slopes.py` turns slopes into what a likelihood needs, `model.py` holds the likelihood of one family and its
parameters, `estimate.py` finds the maximum and ranks the families.
"""

from __future__ import annotations

from microfacet._fit.estimate import FitResult, fit

__all__ = ["FitResult", "fit"]
