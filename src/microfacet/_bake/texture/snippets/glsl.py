"""GLSL 4.50."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".glsl",
    real="float",
    colour="vec3",
    pair="vec2",
    pair_of="vec2({}, {})",
    table="sampler2D table",
    fetch="textureLod(table, vec2({x}, {y}), 0.0).rg",
    binding="a sampler2D, GL_LINEAR and GL_CLAMP_TO_EDGE",
)
