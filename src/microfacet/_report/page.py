"""Sets the content as HTML: numbers, references and formulas become text, jinja2 does the rest."""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from typing import Any

import jinja2
from markupsafe import Markup, escape

import microfacet
from microfacet import _checks
from microfacet._family.looks import letter
from microfacet._report import mathml
from microfacet._report.figure import themed
from microfacet._report.sources import sources
from microfacet.plot import style

__all__ = ["measured", "number", "set_page"]


def set_page(template: str, **content: Any) -> str:
    """A page from a template of this package, with what all of them may use."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("microfacet._report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    filters: dict[str, Callable[..., Any]] = {
        "prose": lambda text: Markup(mathml.prose(text)),
        "display": lambda latex: Markup("".join(mathml.display_pieces(latex))),
        "inline": lambda latex: Markup(mathml.inline(latex)),
        "number": number,
        "p_value": _checks.p_value,
        "measured": measured,
        "symbol": _symbol,
        "color": lambda family: themed(style(family)[0]),
        "interval": _interval,
        "cite": _cite,
        "svg": Markup,
    }
    environment.filters |= filters
    now = datetime.datetime.now().astimezone()
    return environment.get_template(template).render(version=microfacet.__version__, now=now, **content)


def measured(value: float, error: float) -> Markup:
    """A number with its standard error, to two digits of the error."""
    if not (math.isfinite(error) and error > 0):
        return number(value, 4)
    digits = min(max(1 - math.floor(math.log10(error)), 0), 12)
    return Markup(f"{value:.{digits}f} ± {error:.{digits}f}".replace("-", "−"))


def number(value: float | None, digits: int = 6) -> Markup:
    """A number with so many significant digits: 1.5×10⁻¹³ where plain digits would be long."""
    if value is None:
        return Markup("–")
    if not math.isfinite(value):
        return Markup({math.inf: "∞", -math.inf: "−∞"}.get(value, "nan"))
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.replace("-", "−")
    if not exponent:
        return Markup(mantissa)
    return Markup(f"{mantissa}\u202f×\u202f10<sup>{int(exponent)}</sup>".replace("<sup>-", "<sup>−"))


def _symbol(name: str) -> Markup:
    stem, _, axis = name.partition("_")
    below = f"<sub>{axis}</sub>" if axis else ""
    return Markup(f"<i>{'φ' if name == 'rotation' else letter(stem)}{below}</i>")


def _interval(parameter: Any) -> Markup:
    upper = "∞" if math.isinf(parameter.upper) else f"{parameter.upper:g}"
    return Markup(f"({parameter.lower:g}, {upper})")


def _cite(text: str) -> Markup:
    """A key, or a text that begins with works such as "Walter et al. 2007; ...", linked to the references.

    The title after such a short form is dropped: the list of references has it.
    """
    works = sources()
    if text in works:
        return _link(text)
    parts = []
    for part in text.split("; "):
        key = next((key for key, source in works.items() if part.startswith(source.short)), None)
        if key is None:
            parts.append(escape(part))
            continue
        rest = part.removeprefix(works[key].short).replace(f", {works[key].title}", "")
        parts.append(_link(key) + escape(rest))
    return Markup("; ").join(parts)


def _link(key: str) -> Markup:
    return Markup('<a href="#ref-{}">{}</a>').format(key, sources()[key].short)
