"""The command `microfacet`: one module a command, with its options and what it prints.

Exit status 0; 1 when a check failed; 2 for bad input, with one sentence on stderr; 130 after Ctrl-C.
"""

from __future__ import annotations

import microfacet as mf
from microfacet._optional import needed

with needed("the command microfacet needs"):
    import click

from microfacet.cli import (
    bake,
    brdf,
    compare,
    evaluate,
    export,
    families,
    fit,
    gallery,
    render,
    report,
    sample,
    spectrum,
    surface,
    synthesize,
    verify,
)
from microfacet.cli.program import Program, folder_option

__all__ = ["main"]


@click.group(
    cls=Program, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(mf.__version__, prog_name="microfacet")
@folder_option("--include-dir", mf.get_include, "Print the folder of the C++ headers.")
@folder_option("--cmake-dir", mf.get_cmake_dir, "Print the folder of the CMake package.")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Microfacet normal distribution functions: evaluate, sample, fit, verify, report.

    \b
    Examples:
      microfacet verify
      microfacet report --terrain
      microfacet eval ggx sigma 0.5 1 --alpha 0.3
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


for command in (
    bake.bake,
    brdf.brdf,
    compare.compare,
    evaluate.evaluate,
    export.export,
    families.families,
    fit.fit,
    gallery.gallery,
    render.render,
    report.report,
    sample.sample,
    surface.surface,
    spectrum.spectrum,
    synthesize.synthesize,
    verify.verify,
):
    main.add_command(command)
