"""The works that the pages cite: references.bib, read and set by pybtex."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

from markupsafe import Markup
from pybtex.backends.html import Backend
from pybtex.database import parse_file
from pybtex.richtext import Text
from pybtex.style.formatting.unsrt import Style

import microfacet

__all__ = ["Source", "sources"]


class Source(NamedTuple):
    """A reference: as texts cite it (Walter et al. 2007), its title without a subtitle, all of it as HTML."""

    short: str
    title: str
    html: Markup


@cache
def sources() -> dict[str, Source]:
    """Every work that has an author, by its key and in the order of the keys."""
    here = Path(microfacet.__file__).parent
    installed = here / "references.bib"
    path = installed if installed.exists() else here.parents[1] / "references.bib"  # in a source tree
    entries = {e.key: e for e in parse_file(path, "bibtex").entries.values() if "author" in e.persons}
    for entry in entries.values():
        entry.fields.pop("url", None)  # links to DOIs alone: they stay
    found = {}
    for reference in Style(abbreviate_names=True).format_entries(list(entries.values())):
        entry = entries[reference.key]
        names = [" ".join(person.prelast_names + person.last_names) for person in entry.persons["author"]]
        who = f"{names[0]} et al." if len(names) > 2 else " and ".join(names)
        short, title = (
            str(Text.from_latex(text)) for text in (f"{who} {entry.fields['year']}", entry.fields["title"])
        )
        html = Markup(reference.text.render(Backend()))
        found[reference.key] = Source(short, title.partition(":")[0], html)
    return dict(sorted(found.items()))
