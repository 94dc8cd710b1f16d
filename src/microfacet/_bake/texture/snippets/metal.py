"""Metal's shading language."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".metal",
    real="float",
    colour="float3",
    pair="float2",
    pair_of="float2({}, {})",
    table="metal::texture2d<float> table, metal::sampler state",
    fetch="table.sample(state, float2({x}, {y}), metal::level(0.0f)).rg",
    binding="a texture2d<float> and a sampler with filter::linear and address::clamp_to_edge",
    function="static inline {type} {name}({parameters})\n{{",
    suffix_of_numbers="f",
    names={name: f"metal::{name}" for name in ("min", "max", "sqrt", "log", "floor")},
    preamble="#include <metal_stdlib>\n",
)
