"""The program around the commands: errors become sentences and exit statuses; options that many share."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, NoReturn

import click

from microfacet.cli import streams
from microfacet.cli.printing import say
from microfacet.cli.termination import ending_on_sigterm

__all__ = ["NumbersCommand", "Program", "families_option", "folder_option", "json_option"]

families_option = click.option(
    "--family", "families", multiple=True, metavar="NAME", help="Only this family; repeat for several."
)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


class Program(click.Group):
    """A group whose errors are one sentence, whatever raised them."""

    @streams.standard()
    def main(self, *args: Any, **options: Any) -> NoReturn:
        """Run, and turn the errors that a user can cause into exit statuses."""
        options["standalone_mode"] = False
        _stand_in_for_closed_streams()
        try:
            with ending_on_sigterm():
                status = super().main(*args, **options)
        except click.NoSuchOption as error:
            _fail(_no_such_option(error))
        except click.ClickException as error:
            _fail(error.format_message())
        except click.Abort:  # Ctrl-C
            sys.exit(130)
        except (ValueError, ImportError) as error:
            _fail(str(error))
        except MemoryError as error:
            _fail(": ".join(filter(None, ("there is not enough memory", str(error)))))
        except OSError as error:
            _fail(": ".join(str(part) for part in (error.filename, error.strerror or error) if part))
        sys.exit(status if isinstance(status, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Stop without a word when the reader of a pipe has left."""
        try:
            value = super().invoke(ctx)
            sys.stdout.flush()
        except BrokenPipeError:  # click itself would end with 1
            ctx.exit(streams.READER_LEFT)
        return value


class NumbersCommand(click.Command):
    """A command whose arguments may be negative numbers: what else begins with a hyphen is an option."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.ignore_unknown_options = True  # click's parser would take -0.5 for options

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Refuse an option that does not exist, which the parser has taken for an argument."""
        found, _, _ = self.make_parser(ctx).parse_args(args=list(args))
        for parameter in self.params:
            given = found.get(parameter.name or "") if isinstance(parameter, click.Argument) else None
            for text in given if isinstance(given, tuple | list) else (given,):
                if isinstance(text, str) and re.match(r"-(?!\d|\.\d|inf|nan|$)", text, re.IGNORECASE):
                    raise click.NoSuchOption(text.partition("=")[0], ctx=ctx)
        return super().parse_args(ctx, args)


def _no_such_option(error: click.NoSuchOption) -> str:
    known = (
        [name for entry in error.ctx.command.get_params(error.ctx) for name in entry.opts]
        if error.ctx
        else []
    )
    near = get_close_matches(error.option_name, known, n=1)
    return f"No such option: {error.option_name}." + (f" Did you mean {near[0]}?" if near else "")


def _stand_in_for_closed_streams() -> None:
    """A stream that the caller has closed is None in Python; an empty one does what is meant."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))  # noqa: SIM115  # for as long as the process lives


def _fail(message: str) -> NoReturn:
    say(message)
    sys.exit(2)


def folder_option(
    name: str, ask: Callable[[], str], what: str
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A flag that prints a folder and ends the program."""

    def show(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
        if asked:
            click.echo(ask())
            ctx.exit()

    return click.option(name, is_flag=True, is_eager=True, expose_value=False, callback=show, help=what)
