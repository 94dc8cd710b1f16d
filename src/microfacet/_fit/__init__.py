"""Maximum-likelihood fits of the families' slope densities to measured slopes.

`slopes.py` turns slopes into what a likelihood needs, `blocks.py` says where on the map they lie, `model.py`
holds the likelihood of one family and its derivatives, `newton.py` finds the maximum, `errors.py` and
`goodness.py` say how much it is worth, `estimate.py` ranks the families. `misfit.py` and `balance.py` test
whether a family describes the slopes (`pearson.py` has the law of their statistics), `halves.py` whether the
map is one population; `verdict.py`, `cautions.py` and `missing.py` say so in words. `scales.py` fits at
several lags, `table.py` fits tables, `comparison.py` puts surfaces side by side.
"""

from __future__ import annotations

from microfacet._fit.comparison import Comparison, Difference, compare
from microfacet._fit.estimate import fit
from microfacet._fit.halves import Halves
from microfacet._fit.result import FitResult, Goodness, TableFit
from microfacet._fit.results import FitResults
from microfacet._fit.scales import ScaleFit, fit_scales
from microfacet._fit.table import fit_table
from microfacet._fit.verdict import Verdict

__all__ = [
    "Comparison",
    "Difference",
    "FitResult",
    "FitResults",
    "Goodness",
    "Halves",
    "ScaleFit",
    "TableFit",
    "Verdict",
    "compare",
    "fit",
    "fit_scales",
    "fit_table",
]
