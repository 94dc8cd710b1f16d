"""GLSL ES 3.00, of WebGL2 and mobile devices."""

from __future__ import annotations

from dataclasses import replace

from microfacet._bake.texture.snippets.glsl import LANGUAGE as GLSL

LANGUAGE = replace(
    GLSL,
    suffix=".essl",
    table="highp sampler2D table",
    binding="a highp sampler2D, LINEAR and CLAMP_TO_EDGE; float32 texels need OES_texture_float_linear, "
    "half do not",
    real="highp float",
    colour="highp vec3",
    pair="highp vec2",
)
