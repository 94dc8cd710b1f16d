"""The Open Shading Language."""

from __future__ import annotations

from microfacet._export.language import OPERATORS, SHADER_CALLS, Language

__all__ = ["LANGUAGE"]

_NO_BITS = "OSL cannot read or write the bits of a number"
_NO_TABLES = "OSL has no constant arrays outside functions"

LANGUAGE = Language(
    name="osl",
    title="OSL",
    ending=".h",
    mask="int",
    true="1",
    false="0",
    vectors={3: "vector"},
    table="",
    calls={**SHADER_CALLS},
    operators={name: text for name, text in OPERATORS.items() if name != "shift_right_logical"},
    infinity="3.4028235e+38",
    nan="(0.0 * 1e+38 * 10.0)",
    of_three="{name}[{index}]",
    parameter_out="output {type} {name}",
    out_several=True,
    why_not={
        "bits": _NO_BITS,
        "from_bits": _NO_BITS,
        "shift_right_logical": _NO_BITS,
        "table": _NO_TABLES,
    },
    note="Include it in a shader; xi of two numbers are two arguments.",
)
