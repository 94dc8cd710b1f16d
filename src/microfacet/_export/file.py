"""A whole file: head, constant arrays, one function per quantity."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from microfacet._export.expressions import Missing, literal
from microfacet._export.graph import Graph
from microfacet._export.language import Language
from microfacet._export.printer import Function, printed

__all__ = ["Content", "Tables", "commented", "function_of", "plain_file"]

_WIDTH = 100
# The order in which functions take what is no parameter.
ARGUMENTS = ("p", "q", "r", "m", "wi", "wo", "w", "xi", "choice")


@dataclass(frozen=True)
class Content:
    """What a file holds: graphs by the names of their functions, and the lines of its head.

    Attributes
    ----------
    prefix : str
        How the names of its functions begin, for instance "student_t_".
    meanings : dict of str to str
        What each function is, in a sentence.
    intervals : dict of str to (float, float)
        The domains of its parameters, in the order in which functions take them.
    """

    prefix: str
    graphs: dict[str, Graph]
    meanings: dict[str, str]
    head: Sequence[str]
    intervals: dict[str, tuple[float, float]]


def commented(language: Language, lines: Sequence[str]) -> str:
    """Lines of prose as a comment."""
    wrapped: list[str] = []
    for line in lines:
        if line.startswith(" "):  # a command, to be copied
            wrapped.append(line)
        else:
            wrapped += textwrap.wrap(line, _WIDTH, subsequent_indent="  ", break_on_hyphens=False) or [""]
    return "\n".join(f"{language.comment} {line}".rstrip() for line in wrapped)


class Tables:
    """The constant arrays of a file: equal ones are one."""

    def __init__(self, language: Language, prefix: str) -> None:
        self.language, self.prefix = language, prefix
        self.names: dict[tuple[str, bytes], str] = {}
        self.lines: list[str] = []

    def of(self, graph: Graph) -> list[str]:
        """The names of the arrays of a graph; those that it does not read have none."""
        used = {graph.value[node] for node, operation in enumerate(graph.operation) if operation == "table"}
        return [self._name(table) if i in used else "" for i, table in enumerate(graph.tables)]

    def _name(self, table: np.ndarray) -> str:
        key = (table.dtype.str, table.tobytes())
        if key not in self.names:
            self.names[key] = f"{self.prefix}table{len(self.names) + 1}"
            kind = "real" if table.dtype.kind == "f" else "integer"
            numbers = [literal(self.language, kind, value).text for value in table.tolist()]
            text = self.language.table.format(
                type=getattr(self.language, kind),
                name=self.names[key],
                count=len(table),
                values=", ".join(numbers),
            )
            self.lines += textwrap.wrap(text, _WIDTH, subsequent_indent="  ", break_long_words=False)
        return self.names[key]


def function_of(language: Language, content: Content, name: str, tables: Tables) -> Function:
    """One function of a file; ValueError says why the language cannot have it."""
    graph = content.graphs[name]
    if graph.real != "float32":
        raise ValueError(f"{content.prefix}{name} is recorded in {graph.real}; files are in single precision")
    if graph.tables and not language.table:
        raise ValueError(
            f"{content.prefix}{name} cannot be had in {language.title}: {language.why_not['table']}"
        )
    order = (*ARGUMENTS, *content.intervals)
    try:
        return printed(language, graph, content.prefix + name, tables.of(graph), order)
    except Missing as error:
        raise ValueError(f"{content.prefix}{name} cannot be had in {language.title}: {error}") from None


def plain_file(language: Language, content: Content) -> str:
    """The text of a file of functions."""
    tables = Tables(language, content.prefix)
    parts: list[str] = []
    for name in content.graphs:
        function = function_of(language, content, name, tables)
        parts += ["\n".join(function.structs)] if function.structs else []
        parts.append("\n".join([commented(language, [content.meanings[name]]), *function.lines]))
    body = "\n\n".join(parts)
    arrays = "\n".join(tables.lines)
    helpers = [text for word, text in language.helpers.items() if word in body + arrays]
    above = [commented(language, content.head), language.preamble, *helpers, arrays]
    text = "\n\n".join(part for part in (*above, body) if part) + "\n"
    return text.replace("{prefix}", content.prefix)
