"""CUDA C++, which HIP takes as it is."""

from __future__ import annotations

from microfacet._export.language import C_CALLS, OPERATORS, Language

__all__ = ["LANGUAGE"]

LANGUAGE = Language(
    name="cuda",
    title="CUDA and HIP",
    ending=".cuh",
    vectors={2: "float2", 3: "float3", 4: "float4"},
    calls={**C_CALLS, "bits": "__float_as_int({0})", "from_bits": "__int_as_float({0})"},
    operators={
        **OPERATORS,
        "shift_left": "(int)((unsigned int){0} << {1})",
        "shift_right_logical": "(int)((unsigned int){0} >> {1})",
    },
    native=True,
    number="{0}f",
    infinity="__int_as_float(0x7f800000)",
    nan="__int_as_float(0x7fc00000)",
    declare="const {type} {name} = {value};",
    unused="(void){name};",
    vector="make_{type}({values})",
    function="__device__ inline {type} {name}({parameters}) {{",
    parameter_out="{type}& {name}",
    table="static __device__ const {type} {name}[{count}] = {{{values}}};",
)
