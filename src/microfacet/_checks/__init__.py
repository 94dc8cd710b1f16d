"""The checklist of the notebooks as data: each statement with its two sides, computed by independent routes.

To add a check, add one `Check(...)` to the table ``CHECKS`` at the end of the family's module (``gtr.py``).
Statements that hold for every family are factories in ``closed.py`` and ``integrals.py``, independent
computations are in ``routes.py``, and tolerances, with their reasons, in ``check.py``.
"""

from microfacet._checks.check import HISTOGRAM as HISTOGRAM
from microfacet._checks.check import SIGNIFICANCE as SIGNIFICANCE
from microfacet._checks.check import CheckItem as CheckItem
from microfacet._checks.check import CheckResult as CheckResult
from microfacet._checks.check import p_value as p_value
from microfacet._checks.routes import delta_integral as delta_integral
from microfacet._optional import needed

with needed("the checks need"):
    from microfacet._checks.checklist import catalogue as catalogue
    from microfacet._checks.checklist import run as run

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
