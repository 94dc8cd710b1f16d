"""HLSL, shader model 5 and later."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".hlsl",
    real="float",
    colour="float3",
    pair="float2",
    pair_of="float2({}, {})",
    table="Texture2D table, SamplerState state",
    fetch="table.SampleLevel(state, float2({x}, {y}), 0.0).rg",
    binding="a Texture2D and a SamplerState, MIN_MAG_LINEAR_MIP_POINT and CLAMP",
)
