"""The checklist of the notebooks as data: each statement with its two sides, computed by independent routes.

To add a check, add one `Check(...)` to the table ``CHECKS`` at the end of the family's module (``_gtr.py``).
Statements that hold for every family are factories in ``_closed.py`` and ``_integrals.py``, independent
computations are in ``_routes.py``, and tolerances, with their reasons, in ``_check.py``.
"""

from microfacet._checks._check import HISTOGRAM as HISTOGRAM
from microfacet._checks._check import SIGNIFICANCE as SIGNIFICANCE
from microfacet._checks._check import CheckItem as CheckItem
from microfacet._checks._check import CheckResult as CheckResult
from microfacet._checks._check import p_value as p_value
from microfacet._checks._routes import delta_integral as delta_integral
from microfacet._optional import needed

with needed("the checks need"):
    from microfacet._checks._run import catalogue as catalogue
    from microfacet._checks._run import run as run

__all__ = [
    "HISTOGRAM",
    "SIGNIFICANCE",
    "CheckItem",
    "CheckResult",
    "catalogue",
    "delta_integral",
    "p_value",
    "run",
]
