"""HLSL, shader model 5 and later."""

from __future__ import annotations

from microfacet._export.language import OPERATORS, SHADER_CALLS, Language

__all__ = ["LANGUAGE"]

LANGUAGE = Language(
    name="hlsl",
    title="HLSL",
    ending=".hlsl",
    vectors={2: "float2", 3: "float3", 4: "float4"},
    calls={**SHADER_CALLS, "bits": "asint({0})", "from_bits": "asfloat({0})"},
    operators={**OPERATORS, "shift_right_logical": "(int)((uint){0} >> {1})"},
    infinity="asfloat(0x7f800000)",
    nan="asfloat(0x7fc00000)",
    turns="[loop] for (int {i} = 0; {i} < {most}{moving}; ++{i}) {{",
    table="static const {type} {name}[{count}] = {{{values}}};",
)
