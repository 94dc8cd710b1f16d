"""The command `microfacet families`."""

from __future__ import annotations

import json

import click

import microfacet as mf
from microfacet.cli.printing import console, finite, show
from microfacet.cli.program import json_option

__all__ = ["families"]


@click.command()
@json_option
def families(as_json: bool) -> None:
    """List the families, their parameters and sources."""
    if as_json:  # null is an end of an interval that is open to infinity
        records = [
            {
                "name": family.name,
                "title": family.title,
                "parameters": [
                    finite({"name": own.name, "lower": own.lower, "upper": own.upper})
                    for own in family.parameters
                ],
                "anisotropic": family.anisotropic,
                "sources": list(family.sources),
            }
            for family in mf.families()
        ]
        click.echo(json.dumps(records, indent=1))
        return
    rows = [
        [
            family.name,
            family.title,
            ", ".join(f"{p.name} in ({p.lower:g}, {p.upper:g})" for p in family.parameters),
            "yes" if family.anisotropic else "no",
            ", ".join(family.sources),
        ]
        for family in mf.families()
    ]
    show(console(), ["family", "title", "parameters", "anisotropic", "sources"], rows, left=5)
