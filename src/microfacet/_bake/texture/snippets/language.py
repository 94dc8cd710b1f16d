"""How a language writes the few things that a snippet needs."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

__all__ = ["Language"]

_NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?:e-?\d+)?")


@dataclass(frozen=True)
class Language:
    """Patterns and names of a language.

    `real`, `colour` and `pair` are types: a number, reflectances of three channels (of one, where there is no
    arithmetic of vectors), and two numbers. `pair_of`, `first` and `second` make a pair and take it apart.
    `table` declares the texture as parameters. `fetch` reads it at {x}, {y} between 0 and 1, with linear
    filtering. `preamble` comes first. $ stands for the prefix of helpers, $width and $height for numbers.
    """

    suffix: str
    real: str
    colour: str
    pair: str
    pair_of: str
    table: str
    fetch: str
    binding: str  # what the caller has to set up, as a sentence
    first: str = "{}.x"
    second: str = "{}.y"
    function: str = "{type} {name}({parameters})\n{{"
    parameter: str = "{type} {name}"
    local: str = "{type} {name} = {value};"
    suffix_of_numbers: str = ""
    names: dict[str, str] = field(default_factory=dict)  # of functions that are called otherwise
    preamble: str = ""

    def type(self, name: str, prefix: str) -> str:
        """The type of that name in `Function`."""
        return {"real": self.real, "colour": self.colour, "pair": self.pair}[name].replace("$", prefix)

    def expression(self, text: str, prefix: str) -> str:
        """A formula in this language."""
        text = _NUMBER.sub(lambda number: number[0] + self.suffix_of_numbers, text)
        text = re.sub(r"\b(\w+)\.first\b", lambda name: self.first.format(name[1]), text)
        text = re.sub(r"\b(\w+)\.second\b", lambda name: self.second.format(name[1]), text)
        text = re.sub(r"\bpair\((.+), (.+)\)", lambda parts: self.pair_of.format(parts[1], parts[2]), text)
        text = re.sub(r"\bfetch\((\w+), (\w+)\)", lambda at: self.fetch.format(x=at[1], y=at[2]), text)
        for name, own in self.names.items():
            text = re.sub(rf"\b{name}\(", f"{own}(", text)
        return text.replace("$", prefix)
