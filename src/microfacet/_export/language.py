"""What the printer has to know about a language, and a start for those that look like C."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["C_CALLS", "OPERATORS", "SHADER_CALLS", "Language"]

#: Functions under the names that most languages give them; {0}, {1}, {2} are the arguments.
SHADER_CALLS: Mapping[str, str] = {
    "minimum": "min({0}, {1})",
    "maximum": "max({0}, {1})",
    "absolute": "abs({0})",
    "sqrt": "sqrt({0})",
    "floor": "floor({0})",
    "exp": "exp({0})",
    "log": "log({0})",
    "pow": "pow({0}, {1})",
    "sin": "sin({0})",
    "cos": "cos({0})",
}

#: The functions of C's <math.h> in single precision.
C_CALLS: Mapping[str, str] = {
    "minimum": "fminf({0}, {1})",
    "maximum": "fmaxf({0}, {1})",
    "absolute": "fabsf({0})",
    "pow": "powf({0}, {1})",
    **{name: name + "f({0})" for name in ("sqrt", "floor", "exp", "log", "expm1", "log1p", "sin", "cos")},
}

#: What is written with operators; integers are compared and added as real numbers are.
OPERATORS: Mapping[str, str] = {
    "integer and": "{0} & {1}",
    "integer or": "{0} | {1}",
    "shift_left": "{0} << {1}",
    "shift_right": "{0} >> {1}",
    "shift_right_logical": "int(uint({0}) >> {1})",
    "select": "{0} ? {1} : {2}",
}


@dataclass(frozen=True)
class Language:
    """One language: names of types and functions, and templates of statements.

    Attributes
    ----------
    name, title, ending : str
        What users ask for, how it is written, and how names of its files end.
    real, integer, mask : str
        Types of scalars.
    vectors : mapping of int to str
        Types with so many components; what is missing here becomes scalars.
    calls : mapping of str to str
        Templates of the operations that are calls. What is neither here nor in `operators` cannot be had.
    operators : mapping of str to str
        Templates whose arguments and result are put into parentheses wherever they are not simple.
    number, true, false : str
        Literals; {0} is the decimal number.
    infinity, nan : str
        Expressions, since no literal stands for them.
    declare, variable, unset, unused : str
        Statements: a constant {name} with its {value}, a variable, one without value, an argument not used.
    turns, when, otherwise, end : str
        A loop over {i} below {most} that goes on while {moving} (empty or " && ..."), if and else.
    vector, component, of_three : str
        A vector of {values}; its component {letter} or number {index}, and that of a vector of three.
    function, parameter, parameter_out, struct, struct_field, struct_end, struct_value : str
        Heads of functions and structures, and the variable in which a structure is put together.
    out_only : bool
        Whether functions give their results through arguments alone.
    out_several : bool
        Whether they do where there are several.
    table, line_of_table : str
        A constant array.
    helpers : mapping of str to str
        Functions that a call or literal needs, by a word in the text; {prefix} makes their names unique.
    comment : str
        How a line of comment begins.
    preamble : str
        What stands before all functions.
    why_not : mapping of str to str
        Why an operation cannot be had, as the end of a sentence.
    note : str
        One sentence for the head of the file: how it is used.
    native : bool
        Whether it has expm1, log1p and an accurate sine and cosine.
    document : callable, optional
        What makes the texts of several files by their names; the first is the one that was asked for.
    """

    name: str
    title: str
    ending: str
    vectors: Mapping[int, str]
    real: str = "float"
    integer: str = "int"
    mask: str = "bool"
    calls: Mapping[str, str] = field(default_factory=lambda: SHADER_CALLS)
    operators: Mapping[str, str] = field(default_factory=lambda: OPERATORS)
    number: str = "{0}"
    true: str = "true"
    false: str = "false"
    infinity: str = ""
    nan: str = ""
    declare: str = "{type} {name} = {value};"
    variable: str = "{type} {name} = {value};"
    unset: str = "{type} {name};"
    unused: str = ""
    turns: str = "for (int {i} = 0; {i} < {most}{moving}; ++{i}) {{"
    when: str = "if ({mask}) {{"
    otherwise: str = "}} else {{"
    vector: str = "{type}({values})"
    component: str = "{name}.{letter}"
    of_three: str = "{name}.{letter}"
    function: str = "{type} {name}({parameters}) {{"
    parameter: str = "{type} {name}"
    parameter_out: str = "out {type} {name}"
    struct: str = "struct {name} {{"
    struct_field: str = "  {type} {name};"
    struct_end: str = "}};"
    struct_value: str = "{type} {name};"
    out_only: bool = False
    out_several: bool = False
    table: str = "const {type} {name}[{count}] = {type}[{count}]({values});"
    helpers: Mapping[str, str] = field(default_factory=dict)
    comment: str = "//"
    preamble: str = ""
    why_not: Mapping[str, str] = field(default_factory=dict)
    note: str = ""
    native: bool = False
    document: Callable[[Any, str], dict[str, str]] | None = None
