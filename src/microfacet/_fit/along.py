"""What speaks against the numbers of a fit to a profile: one sentence with figures each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import stats

from microfacet._fit.cautions import cautions
from microfacet._fit.errors import jacobian, parameters
from microfacet._fit.halves import part_of
from microfacet._fit.line import ALONG, Line
from microfacet._fit.model import Model
from microfacet._fit.newton import Maximum
from microfacet._fit.verdict import percent
from microfacet._profile import Profile

__all__ = ["cautions_along"]

_APART = 0.01  # probability of halves as different as these by chance
_FEWEST_SLOPES = 400


def cautions_along(
    profile: Profile, line: Line, fitted: tuple[Model, Maximum], max_slope: float | None
) -> tuple[str, ...]:
    """Of a profile, its slopes, and the family that ranks first."""
    model, found = fitted
    both = np.column_stack((line.raw, line.raw))  # the cautions of a map look at two components
    said = [*cautions(profile, both, None, (model, found.state), None, None), *_halves(model, found)]
    if max_slope is not None:
        beyond = float(np.mean(np.abs(line.raw) > max_slope))
        if beyond > 0:
            said.append(
                f"{percent(beyond)} of the slopes are steeper than {max_slope:g}, which the instrument does "
                "not measure: they are artefacts, and should be masked"
            )
    return tuple(said)


def _halves(model: Model, found: Maximum) -> Iterator[str]:
    """Whether the first half of the line and the second differ beyond their errors."""
    sizes, cells = model.slopes.sizes, np.arange(ALONG).reshape(-1, 1)
    parts = [cells[: ALONG // 2], cells[ALONG // 2 :]]
    if not found.free.any() or min(sizes[part].sum() for part in parts) < _FEWEST_SLOPES:
        return
    values = parameters(model, found.state)
    ways = jacobian(model, found.state)[:, found.free]
    measured = [part_of(found, part, ways) for part in parts]
    if any(one is None for one in measured):
        return
    (first, first_errors), (second, second_errors) = (one for one in measured if one is not None)
    errors = np.hypot(first_errors, second_errors)
    kept = [k for k in range(len(values)) if errors[k] > 0]
    apart = [float(second[k] - first[k]) / float(errors[k]) for k in kept]
    if not apart or stats.chi2.sf(float(np.sum(np.square(apart))), len(apart)) >= _APART:
        return
    worst = int(np.argmax(np.abs(apart)))
    name, whole = list(values.items())[kept[worst]]
    yield (
        f"the line is not one population: {name} is about {whole + first[kept[worst]]:.4g} in its first half "
        f"and {whole + second[kept[worst]]:.4g} in its second, {abs(apart[worst]):.1f} standard errors apart"
    )
