"""Slang, which its compiler turns into SPIR-V, HLSL, Metal, WGSL, CUDA and C++."""

from __future__ import annotations

from dataclasses import replace

from microfacet._export.languages import hlsl

__all__ = ["LANGUAGE"]

LANGUAGE = replace(
    hlsl.LANGUAGE,
    name="slang",
    title="Slang",
    ending=".slang",
    turns="for (int {i} = 0; {i} < {most}{moving}; ++{i}) {{",
)
