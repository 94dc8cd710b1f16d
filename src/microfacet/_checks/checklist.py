"""The catalogue, and running it: at the notebooks' parameters, at given ones, or on a grid."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from microfacet._checks import common, routes
from microfacet._checks.check import Check, CheckItem, CheckResult, Tally
from microfacet._family import families as families_of_the_library


def _tables() -> dict[str, Any]:
    """The module of each family's checks, which has its name, in the order of the library; or `common`."""
    paths = {family: f"{__package__}.{family.name}" for family in families_of_the_library()}
    return {
        family.name: import_module(path) if find_spec(path) else common.table(family)
        for family, path in paths.items()
    }


TABLES = _tables()

#: The roughnesses that the second routes have been made for; each module says it of its shape parameter.
COVERED = {"alpha": (1e-6, 1e3)}


def catalogue() -> tuple[CheckItem, ...]:
    """Every check there is, family by family, the statements of its notebook among them.

    >>> [item.id for item in catalogue()][:2]
    ['beckmann.density', 'beckmann.sigma_upper']
    """
    return tuple(check.item(family) for family, table in TABLES.items() for check in table.CHECKS)


def run(
    ids: Iterable[str] | None = None,
    families: Iterable[str] | None = None,
    grid: bool = False,
    parameters: Mapping[str, float] | None = None,
) -> Iterator[CheckResult]:
    """Run checks, yielding each result as it is there.

    Parameters
    ----------
    ids : iterable of str, optional
        Run these alone, for instance ``["gtr.marginal"]``.
    families : iterable of str, optional
        Run these families alone, for instance ``["k0"]``.
    grid : bool
        Run each check at every point of a grid over the family's domain, one result for each point.
    parameters : mapping, optional
        Values for "alpha", "gamma" and "a" that replace the check's own. A family takes those it has. A check
        whose statement does not hold or cannot be evaluated there is left out.

    Raises
    ------
    ValueError
        At the call, not later: an unknown id, family or parameter; a parameter outside a family's domain or
        outside what the checks cover, the contract's ranges with room: beyond, a failure says nothing.

    Examples
    --------
    >>> [result.passed for result in run(ids=["k0.lambda_of_x"], parameters={"alpha": 0.3})]
    [True]
    """
    overrides = {} if parameters is None else {name: float(value) for name, value in parameters.items()}
    chosen = _chosen(ids, families)
    _validate(overrides, {family for family, _ in chosen})
    return _results(chosen, grid, overrides)


def tallies(results: Iterable[CheckResult]) -> dict[str, dict[str, Tally]]:
    """How the statements went, family by family: those of the notebook, and the further ones, which are ours.

    A statement holds if it does at all parameters at which it was checked.

    >>> tallies(run(ids=["k0.survival", "k0.lambda_of_x"]))["k0"]["notebook"]
    Tally(stated=13, checked=1, held=1)
    """
    held: dict[str, bool] = {}
    for result in results:
        held[result.id] = held.get(result.id, True) and result.passed

    def tally(family: str, notebook: bool) -> Tally:
        ids = [item.id for item in catalogue() if item.family == family and item.notebook == notebook]
        return Tally(len(ids), sum(name in held for name in ids), sum(held.get(name, False) for name in ids))

    checked = {name.partition(".")[0] for name in held}
    return {
        family: {"notebook": tally(family, True), "further": tally(family, False)}
        for family in TABLES
        if family in checked
    }


def _chosen(ids: Iterable[str] | None, families: Iterable[str] | None) -> list[tuple[str, Check]]:
    checks = {
        f"{family}.{check.name}": (family, check)
        for family, table in TABLES.items()
        for check in table.CHECKS
    }
    wanted_ids = _known("check", ids, checks)
    wanted_families = _known("family", families, TABLES)
    return [
        (family, check)
        for name, (family, check) in checks.items()
        if (wanted_ids is None or name in wanted_ids)
        and (wanted_families is None or family in wanted_families)
    ]


def _known(kind: str, names: Iterable[str] | None, known: Iterable[str]) -> set[str] | None:
    if names is None:
        return None
    wanted = {names} if isinstance(names, str) else set(names)
    unknown = sorted(wanted - set(known))
    if unknown:
        from difflib import get_close_matches

        near = get_close_matches(unknown[0], known, n=3) or list(known)
        raise ValueError(f"unknown {kind} {unknown[0]!r}; did you mean one of {', '.join(near[:6])}?")
    return wanted


def _validate(overrides: Mapping[str, float], families: Iterable[str]) -> None:
    domains = {name: {p.name: p for p in family.parameters} for name, family in routes.families().items()}
    known = sorted({name for domain in domains.values() for name in domain})
    for name, value in overrides.items():
        if name not in known:
            raise ValueError(f"unknown parameter {name!r}; the families have {', '.join(known)}")
        for family in sorted(families):
            if name in domains[family]:
                domain = domains[family][name]
                if not domain.lower < value < domain.upper:
                    interval = f"({domain.lower:g}, {domain.upper:g})"
                    raise ValueError(f"{family}: {name} must lie in {interval}, got {value:g}")
                covered_here = COVERED | getattr(TABLES[family], "COVERED", {})
                lowest, highest = covered_here.get(name, (domain.lower, domain.upper))
                if not lowest <= value <= highest:
                    covered = f"[{lowest:g}, {highest:g}]"
                    raise ValueError(f"the checks of {family} cover {name} in {covered}, got {value:g}")


def _results(
    chosen: Iterable[tuple[str, Check]], grid: bool, overrides: Mapping[str, float]
) -> Iterator[CheckResult]:
    for family, check in chosen:
        points = TABLES[family].GRID if grid else ({},)
        distinct = {tuple(check.at({**point, **overrides}).items()) for point in points}
        for point in sorted(distinct):
            values = dict(point)
            if not check.unless(*values.values()):
                yield check.run(family, routes.kernels(family), values)
