"""What every command has in common: errors become one sentence, and families' parameters become options."""

from __future__ import annotations

import functools
import math
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

import click

from microfacet._console import streams
from microfacet._console.termination import ending_on_sigterm
from microfacet._files import is_stdout
from microfacet._text import printable

__all__ = [
    "NumbersCommand",
    "Program",
    "announce",
    "axes_options",
    "families_option",
    "folder_option",
    "json_option",
    "parameter_options",
    "progress",
    "say",
    "surface_options",
    "view_options",
    "where",
]

Command = Callable[..., Any]


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


def say(message: str) -> None:
    """One sentence on stderr, whatever of files and arguments it quotes; without a stderr, none."""
    with suppress(OSError):
        click.echo("microfacet: " + printable(" ".join(message.split()), 1000), err=True)


def _fail(message: str) -> NoReturn:
    say(message)
    sys.exit(2)


def folder_option(name: str, ask: Callable[[], str], what: str) -> Callable[[Command], Command]:
    """A flag that prints a folder and ends the program."""

    def show(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
        if asked:
            click.echo(ask())
            ctx.exit()

    return click.option(name, is_flag=True, is_eager=True, expose_value=False, callback=show, help=what)


def parameter_options(command: Command) -> Command:
    """Options for the parameters of all families; the command gets those given as `parameters`."""

    @click.option("--alpha", type=float, metavar="X", help="Roughness, in slope units.")
    @click.option("--gamma", type=float, metavar="X", help="Tail of gtr and student_t.")
    @click.option("--a", type=float, metavar="X", help="Shape of bessel_k.")
    @functools.wraps(command)
    def wrapped(alpha: float | None, gamma: float | None, a: float | None, **rest: Any) -> Any:
        options = {"alpha": alpha, "gamma": gamma, "a": a}
        given = {name: value for name, value in options.items() if value is not None}
        return command(parameters=given, **rest)

    return wrapped


def axes_options(command: Command) -> Command:
    """Options for roughness along two axes, added to `parameters` (their angle in radians)."""

    @click.option(
        "--alpha-x",
        "--alpha-u",
        "alpha_x",
        type=float,
        metavar="X",
        help="Roughness along x, with --alpha-y in place of --alpha.",
    )
    @click.option("--alpha-y", "--alpha-v", "alpha_y", type=float, metavar="X", help="Roughness along y.")
    @click.option("--rotation", type=float, metavar="DEGREES", help="Of these axes, counter-clockwise.")
    @functools.wraps(command)
    def wrapped(
        parameters: dict[str, float],
        alpha_x: float | None,
        alpha_y: float | None,
        rotation: float | None,
        **rest: Any,
    ) -> Any:
        angle = None if rotation is None else math.radians(rotation)
        axes = {"alpha_x": alpha_x, "alpha_y": alpha_y, "rotation": angle}
        given = {name: value for name, value in axes.items() if value is not None}
        return command(parameters=parameters | given, **rest)

    return wrapped


# How to read and prepare a measured surface, in the order in which it is done.
_SURFACE: dict[str, dict[str, Any]] = {
    "slopes": {
        "type": click.Choice(["table", "opengl", "directx"]),
        "help": "The file holds slopes, in two columns, or as a normal map of this convention.",
    },
    "channel": {"metavar": "NAME", "help": "Which map of a file that holds several: name or number."},
    "pixel_size": {"type": float, "metavar": "METRES", "help": "For a file that states none."},
    "unit": {"metavar": "NAME", "help": "Of the lengths in a file that states none."},
    "scale": {"type": float, "metavar": "X", "help": "Metres per grey level of a height image."},
    "outliers": {"type": float, "metavar": "X", "help": "Mask what sticks out by X robust deviations."},
    "level": {
        "metavar": "KIND",
        "help": "plane (default), three-point, none, or the degree of a polynomial.",
    },
    "level_point": {"multiple": True, "metavar": "COLUMN,ROW", "help": "A point of three-point; thrice."},
    "form": {"metavar": "KIND", "help": "Remove a sphere, a cylinder, or a polynomial of this degree."},
    "s_filter": {"type": float, "metavar": "METRES", "help": "Cut-off of a Gaussian S-filter."},
    "l_filter": {"type": float, "metavar": "METRES", "help": "Cut-off of a Gaussian L-filter."},
    "lag": {"type": click.IntRange(min=1), "metavar": "N", "help": "Pixels to either side of a slope."},
    "lag_length": {"type": float, "metavar": "METRES", "help": "The same as a length."},
}


def surface_options(command: Command) -> Command:
    """Options that read and prepare a measured surface; the command gets those given as `reading`."""

    @functools.wraps(command)
    def wrapped(**rest: Any) -> Any:
        values = {name: rest.pop(name) for name in _SURFACE}
        reading = {name: value for name, value in values.items() if value not in (None, ())}
        return command(reading=reading, **rest)

    for name, how in reversed(_SURFACE.items()):
        wrapped = click.option(f"--{name.replace('_', '-')}", **how)(wrapped)
    return wrapped


def view_options(command: Command) -> Command:
    """Options that say whence normals are seen; the command gets those given as `view`, None without any."""

    @click.option(
        "--visible",
        type=click.FloatRange(0.0, 180.0),
        metavar="THETA",
        help="Only normals seen from THETA degrees off the macronormal (above 90: from below the horizon).",
    )
    @click.option("--phi", type=float, metavar="DEGREES", help="Azimuth of that direction; 0 otherwise.")
    @click.option(
        "--scheme",
        type=click.Choice(["continuous", "mixture"]),
        help="How they are drawn: continuous in the random numbers, or cheaper. Both are exact.",
    )
    @click.option("--bounded", is_flag=True, help="Fewer normals that reflect below the horizon (ggx).")
    @functools.wraps(command)
    def wrapped(
        visible: float | None, phi: float | None, scheme: str | None, bounded: bool, **rest: Any
    ) -> Any:
        options = {"phi": phi, "scheme": scheme, "bounded": bounded or None}
        given = {name: value for name, value in options.items() if value is not None}
        if visible is None and given:
            raise click.UsageError("--phi, --scheme and --bounded go with --visible")
        if scheme and bounded:
            raise click.UsageError("--scheme and --bounded exclude each other")
        return command(view=None if visible is None else {"theta": visible, **given}, **rest)

    return wrapped


def where(path: str | Path) -> str:
    """The file that a command has written, as all of them print it: an absolute path."""
    return str(Path(path).absolute())


def announce(line: str, *written: str | Path) -> None:
    """Print what a command says of the files it has written; on stderr, where one of them is stdout."""
    click.echo(line, err=any(map(is_stdout, written)))


families_option = click.option(
    "--family", "families", multiple=True, metavar="NAME", help="Only this family; repeat for several."
)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


@contextmanager
def progress() -> Iterator[Callable[[str, int, int], None]]:
    """A line on stderr that says what is going on, where stderr is a terminal."""
    if not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(what), completed=done, total=total or None
        )
