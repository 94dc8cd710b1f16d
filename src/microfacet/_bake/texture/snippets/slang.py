"""Slang."""

from __future__ import annotations

from dataclasses import replace

from microfacet._bake.texture.snippets.hlsl import LANGUAGE as HLSL

LANGUAGE = replace(
    HLSL, suffix=".slang", binding="a Texture2D and a SamplerState, linear and clamped to the edge"
)
