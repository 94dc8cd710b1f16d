"""GLSL ES 3.00, as WebGL 2 takes it."""

from __future__ import annotations

from dataclasses import replace

from microfacet._export.languages import glsl

__all__ = ["LANGUAGE"]

LANGUAGE = replace(
    glsl.LANGUAGE,
    name="glsl-es",
    title="GLSL ES 3.00",
    note="Paste it after #version 300 es.",
    preamble="precision highp float;\nprecision highp int;",
)
