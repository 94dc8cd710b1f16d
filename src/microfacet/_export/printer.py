"""A graph as one function of a language."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from microfacet._export.expressions import ATOM, Text, literal, operation
from microfacet._export.graph import Graph
from microfacet._export.language import Language
from microfacet._export.schedule import Block, Schedule

__all__ = ["Function", "printed"]

_LONGEST_INLINE = 48  # characters of an expression that is put into its user's
_LONGEST_RESULT = 90  # and into a result
_LETTERS = "xyzw"
_TEMPORARIES = {"real": "t", "integer": "n", "mask": "c"}


@dataclass(frozen=True)
class Function:
    """A function as text, and what it needs besides.

    Attributes
    ----------
    structs, lines : list of str
        The structure of its results, if any, and the function itself.
    parameters, results : list of (str, str, int)
        Names, types and numbers of components (1 for a scalar).
    operations : int
        As the graph counts them.
    """

    structs: list[str]
    lines: list[str]
    parameters: list[tuple[str, str, int]]
    results: list[tuple[str, str, int]]
    operations: int


def printed(
    language: Language, graph: Graph, name: str, tables: list[str], order: Sequence[str] = ()
) -> Function:
    """The graph as a function of that name, which reads constant arrays of those names.

    Arguments stand in `order`; those that it does not list come first.
    """
    return _Printer(language, graph, name, tables, order).function()


def _grouped(names: list[str]) -> list[tuple[str, list[int], list[int]]]:
    """Components with their vectors: (name, which components, positions in `names`), in order."""
    groups: dict[str, tuple[list[int], list[int]]] = {}
    for position, name in enumerate(names):
        base, dot, letter = name.partition(".")
        is_component = dot and len(letter) == 1 and letter in _LETTERS
        components, positions = groups.setdefault(base if is_component else name, ([], []))
        components.append(_LETTERS.index(letter) if is_component else -1)
        positions.append(position)
    return [(name, *parts) for name, parts in groups.items()]


class _Printer:
    def __init__(
        self, language: Language, graph: Graph, name: str, tables: list[str], order: Sequence[str]
    ) -> None:
        self.language, self.graph, self.name, self.tables, self.order = language, graph, name, tables, order
        self.schedule = Schedule(graph)
        self.given = {node for _, node in graph.results} if len(graph.results) == 1 else set()
        self.texts: dict[int, Text] = {}
        self.lines: list[str] = []
        self.indent = 1
        self.counts: dict[str, int] = {}

    # The function

    def function(self) -> Function:
        parameters = self._parameters()
        results, structs = self._results()
        self._block(self.schedule.body)
        self._give(results)
        return Function(structs, [self._head(parameters, results), *self.lines, "}"], parameters, results,
                        self.graph.operations)  # fmt: skip

    def _type(self, components: int) -> str:
        return self.language.real if components == 1 else self.language.vectors[components]

    def _parameters(self) -> list[tuple[str, str, int]]:
        """The arguments with their types; gives every input its text."""
        used = [node for node in self.schedule.uses if self.graph.operation[node] == "input"]
        by_input = {self.graph.value[node]: node for node in used}
        parameters = []
        groups = _grouped(list(self.graph.inputs))
        rank = {name: place for place, name in enumerate(self.order)}
        for name, components, positions in sorted(groups, key=lambda group: rank.get(group[0], -1)):
            count = max(components) + 1
            together = count in self.language.vectors
            if together:
                parameters.append((name, self._type(count), count))
            for component, position in zip(components, positions, strict=True):
                text = self._component(name, component, count) if together else name.replace(".", "_")
                if count > 0 and not together:
                    text = f"{name}_{_LETTERS[component]}"
                if not together:
                    parameters.append((text, self.language.real, 1))
                if position in by_input:
                    self.texts[by_input[position]] = Text(text)
            if not any(position in by_input for position in positions) and self.language.unused:
                unused = [name] if together else [entry[0] for entry in parameters[-len(positions) :]]
                for entry in unused:
                    self._line(self.language.unused, name=entry)
        return parameters

    def _component(self, name: str, index: int, count: int) -> str:
        template = self.language.of_three if count == 3 else self.language.component
        return template.format(name=name, letter=_LETTERS[index], index=index)

    def _results(self) -> tuple[list[tuple[str, str, int]], list[str]]:
        """The results with their types, and the structure that holds several."""
        results = []
        for name, components, _ in _grouped([name for name, _ in self.graph.results]):
            count = max(max(components) + 1, 1)
            plain = re.sub(r"\W", "_", name)
            results.append(("result" if plain == "value" else plain, self._type(count), count))
        language = self.language
        if len(results) == 1 or language.out_several or language.out_only:
            return results, []
        fields = [language.struct_field.format(name=name, type=type_) for name, type_, _ in results]
        struct = f"{self.name}_result"
        return results, [
            language.struct.format(name=struct),
            *fields,
            language.struct_end.format(name=struct),
        ]

    def _through_arguments(self, results: list[tuple[str, str, int]]) -> bool:
        return self.language.out_only or (self.language.out_several and len(results) > 1)

    def _head(self, parameters: list[tuple[str, str, int]], results: list[tuple[str, str, int]]) -> str:
        language = self.language
        listed = [language.parameter.format(name=name, type=type_) for name, type_, _ in parameters]
        returned = results[0][1] if len(results) == 1 else f"{self.name}_result"
        if self._through_arguments(results):
            listed += [language.parameter_out.format(name=name, type=type_) for name, type_, _ in results]
            returned = "void"
        return language.function.format(name=self.name, type=returned, parameters=", ".join(listed))

    def _give(self, results: list[tuple[str, str, int]]) -> None:
        language = self.language
        nodes = [node for _, node in self.graph.results]
        groups = _grouped([name for name, _ in self.graph.results])
        values = []
        for (_, type_, count), (_, components, positions) in zip(results, groups, strict=True):
            parts = [self._text(nodes[p]).text for _, p in sorted(zip(components, positions, strict=True))]
            together = language.vector.format(type=type_, values=", ".join(parts))
            values.append(together if count > 1 else parts[0])
        if self._through_arguments(results):
            for (name, _, _), value in zip(results, values, strict=True):
                self._line("{name} = {value};", name=name, value=value)
        elif len(results) == 1:
            self._line("return {value};", value=values[0])
        else:
            self._line(language.struct_value, type=f"{self.name}_result", name="result")
            for (name, _, _), value in zip(results, values, strict=True):
                self._line("result.{name} = {value};", name=name, value=value)
            self._line("return result;")

    # Statements

    def _line(self, template: str, **parts: object) -> None:
        self.lines.append("  " * self.indent + template.format(**parts))

    def _new(self, kind: str) -> str:
        self.counts[kind] = self.counts.get(kind, 0) + 1
        return f"{kind}{self.counts[kind]}"

    def _scalar(self, node: int) -> str:
        return str(getattr(self.language, self.graph.type[node]))

    def _block(self, block: Block) -> None:
        for unit in block.units:
            kind, index = unit
            if kind == "node":
                self._node(index, block)
            elif kind == "loop":
                self._loop(index)
            else:
                self._branch(index)

    def _node(self, node: int, block: Block) -> None:
        """Name an expression, or keep it for its only user in the same block."""
        name = self.graph.operation[node]
        arguments = [self._text(argument) for argument in self.graph.arguments[node]]
        if name == "table":
            text = Text(f"{self.tables[self.graph.value[node]]}[{arguments[0].text}]")
        else:
            text = operation(self.language, self.graph, node, arguments)
        inside = self.schedule.uses[node] == 1 and self.schedule.used["node", node][0] is block
        longest = _LONGEST_RESULT if node in self.given else 0 if name == "select" else _LONGEST_INLINE
        if inside and len(text.text) <= longest:
            self.texts[node] = text
        else:
            self._keep(node, text)

    def _keep(self, node: int, text: Text) -> None:
        kind = self.graph.type[node]
        new = self._new(_TEMPORARIES[kind])
        self._line(self.language.declare, type=self._scalar(node), name=new, value=text.text)
        self.texts[node] = Text(new)

    def _text(self, node: int) -> Text:
        if self.graph.operation[node] == "literal":
            return literal(self.language, self.graph.type[node], self.graph.value[node])
        return self.texts[node]

    def _loop(self, index: int) -> None:
        loop, language = self.graph.loops[index], self.language
        states = []
        for state, initial in zip(loop.state, loop.initial, strict=True):
            name = self._new("s")
            states.append(name)
            self._line(language.variable, type=self._scalar(state), name=name, value=self._text(initial).text)
            self.texts[state] = Text(name)
        moving = ""
        if self._text(loop.moving).text != language.true:
            moving = self._new("moving")
            self._line(language.variable, type=language.mask, name=moving, value=self._text(loop.moving).text)
        condition = f" && {moving}" if moving else ""
        self._line(language.turns, i=self._new("i"), most=loop.most, moving=condition)
        self.indent += 1
        self._block(self.schedule.bodies[index])
        self._step(index, states, moving)
        self.indent -= 1
        self._line("}}")
        self._name_results("loop_result", index, states)

    def _step(self, index: int, states: list[str], moving: str) -> None:
        """All states take their next values at once; then whether another turn follows."""
        loop, language = self.graph.loops[index], self.language
        moves = [
            (name, node)
            for name, node in zip(states, loop.next, strict=True)
            if self._text(node).text != name
        ]
        assigned = {name for name, _ in moves}
        values = [self._text(node).text for _, node in moves]
        for position, (_, node) in enumerate(moves):
            if set(re.findall(r"\w+", values[position])) & {name for name, _ in moves[:position]}:
                self._keep(node, Text(values[position]))
                values[position] = self.texts[node].text
        unsettled = self._text(loop.unsettled)
        if set(re.findall(r"\w+", unsettled.text)) & assigned:
            self._keep(loop.unsettled, unsettled)
            unsettled = self.texts[loop.unsettled]
        for (name, _), value in zip(moves, values, strict=True):
            self._line("{name} = {value};", name=name, value=value)
        if moving:
            self._line("{name} = {value};", name=moving, value=unsettled.text)
        elif unsettled.text != language.true:
            self._line(language.when, mask=f"!{unsettled.at(ATOM)}")
            self._line("  break;")
            self._line("}}")

    def _branch(self, index: int) -> None:
        branch = self.graph.branches[index]
        names = []
        for node in branch.taken:
            names.append(self._new("r"))
            self._line(self.language.unset, type=self._scalar(node), name=names[-1])
        taken, other = self.schedule.sides[index]
        self._line(self.language.when, mask=self._text(branch.mask).text)
        self._side(taken, names, branch.taken)
        self._line(self.language.otherwise)
        self._side(other, names, branch.other)
        self._line("}}")
        self._name_results("branch_result", index, names)

    def _side(self, block: Block, names: list[str], values: tuple[int, ...]) -> None:
        self.indent += 1
        self._block(block)
        for name, node in zip(names, values, strict=True):
            self._line("{name} = {value};", name=name, value=self._text(node).text)
        self.indent -= 1

    def _name_results(self, kind: str, index: int, names: list[str]) -> None:
        for node, operation_ in enumerate(self.graph.operation):
            if operation_ == kind and self.graph.value[node][0] == index:
                self.texts[node] = Text(names[self.graph.value[node][1]])
