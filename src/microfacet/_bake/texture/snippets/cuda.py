"""CUDA, and HIP, whose texture objects are called the same."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".cuh",
    real="float",
    colour="float",
    pair="float2",
    pair_of="make_float2({}, {})",
    table="cudaTextureObject_t table",
    fetch="tex2D<float2>(table, {x}, {y})",
    binding="a texture object of float2 with normalized coordinates, cudaFilterModeLinear and "
    "cudaAddressModeClamp; call the functions of reflectances for each channel",
    function="inline __device__ {type} {name}({parameters})\n{{",
    local="const {type} {name} = {value};",
    suffix_of_numbers="f",
    names={"min": "fminf", "max": "fmaxf", "sqrt": "sqrtf", "log": "logf", "floor": "floorf"},
    preamble="""#if defined(__HIP__)
#include <hip/hip_runtime.h>
#define cudaTextureObject_t hipTextureObject_t
#endif
""",
)
