"""The shading language of WebGPU."""

from __future__ import annotations

from microfacet._export.language import OPERATORS, SHADER_CALLS, Language

__all__ = ["LANGUAGE"]

# A constant expression must not be infinite or nan, what a variable holds may be.
_FLOAT_OF = """fn {prefix}float_of(bits: u32) -> f32 {
  var variable = bits;
  return bitcast<f32>(variable);
}"""

LANGUAGE = Language(
    name="wgsl",
    title="WGSL",
    ending=".wgsl",
    real="f32",
    integer="i32",
    vectors={2: "vec2f", 3: "vec3f", 4: "vec4f"},
    calls={
        **SHADER_CALLS,
        "bits": "bitcast<i32>({0})",
        "from_bits": "bitcast<f32>({0})",
        "select": "select({2}, {1}, {0})",
    },
    operators={
        **OPERATORS,
        "shift_left": "{0} << u32({1})",
        "shift_right": "{0} >> u32({1})",
        "shift_right_logical": "bitcast<i32>(bitcast<u32>({0}) >> u32({1}))",
    },
    infinity="{prefix}float_of(0x7f800000u)",
    nan="{prefix}float_of(0x7fc00000u)",
    helpers={"{prefix}float_of(": _FLOAT_OF},
    declare="let {name} = {value};",
    variable="var {name} = {value};",
    unset="var {name}: {type};",
    turns="for (var {i} = 0; {i} < {most}{moving}; {i}++) {{",
    function="fn {name}({parameters}) -> {type} {{",
    parameter="{name}: {type}",
    struct_field="  {name}: {type},",
    struct_end="}}",
    struct_value="var {name}: {type};",
    # A constant would be copied at each read with an index that is not constant: measured, ten times slower.
    table="var<private> {name}: array<{type}, {count}> = array<{type}, {count}>({values});",
)
