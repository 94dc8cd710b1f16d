"""The checklist of the notebooks as data: each statement with its two sides, computed by independent routes.

To add a check, add one `Check(...)` to the table ``CHECKS`` at the end of the family's module (``gtr.py``),
found by the family's name. Besides, it has ``FAMILY``, ``GRID``, the points of a run over the domain, and
``COVERED``, the range of a shape parameter for which the second routes have been made. A check says with
`notebook` whether the family's notebook states it (the default) or the library adds it.

Statements that hold for every family are factories in ``closed.py`` and ``integrals.py``, independent
computations are in ``routes.py``, and tolerances, with their reasons, in ``check.py``.
"""

from microfacet._checks.check import HISTOGRAM as HISTOGRAM
from microfacet._checks.check import SIGNIFICANCE as SIGNIFICANCE
from microfacet._checks.check import CheckItem as CheckItem
from microfacet._checks.check import CheckResult as CheckResult
from microfacet._checks.check import Tally as Tally
from microfacet._checks.check import p_value as p_value
from microfacet._checks.routes import delta_integral as delta_integral
from microfacet._checks.symbolic import NOT_RUN as NOT_RUN
from microfacet._optional import needed

with needed("the checks need"):
    from microfacet._checks.checklist import catalogue as catalogue
    from microfacet._checks.checklist import run as run
    from microfacet._checks.checklist import tallies as tallies

__all__ = [
    "HISTOGRAM",
    "NOT_RUN",
    "SIGNIFICANCE",
    "CheckItem",
    "CheckResult",
    "Tally",
    "catalogue",
    "delta_integral",
    "p_value",
    "run",
    "tallies",
]
