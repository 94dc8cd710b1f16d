"""The Metal Shading Language."""

from __future__ import annotations

from microfacet._export.language import OPERATORS, SHADER_CALLS, Language

__all__ = ["LANGUAGE"]

LANGUAGE = Language(
    name="metal",
    title="Metal Shading Language",
    ending=".metal",
    vectors={2: "float2", 3: "float3", 4: "float4"},
    calls={
        **SHADER_CALLS,
        "absolute": "fabs({0})",
        "minimum": "fmin({0}, {1})",
        "maximum": "fmax({0}, {1})",
        "bits": "as_type<int>({0})",
        "from_bits": "as_type<float>({0})",
    },
    operators={**OPERATORS, "shift_right_logical": "int(uint({0}) >> {1})"},
    number="{0}f",
    infinity="as_type<float>(0x7f800000)",
    nan="as_type<float>(0x7fc00000)",
    declare="const {type} {name} = {value};",
    unused="(void){name};",
    function="inline {type} {name}({parameters}) {{",
    parameter_out="thread {type}& {name}",
    table="constant {type} {name}[{count}] = {{{values}}};",
    preamble="#include <metal_stdlib>\nusing namespace metal;",
)
