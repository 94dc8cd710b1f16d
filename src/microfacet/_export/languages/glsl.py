"""GLSL 4.50, as Vulkan and OpenGL take it."""

from __future__ import annotations

from microfacet._export.language import SHADER_CALLS, Language

__all__ = ["LANGUAGE"]

LANGUAGE = Language(
    name="glsl",
    title="GLSL 4.50",
    ending=".glsl",
    vectors={2: "vec2", 3: "vec3", 4: "vec4"},
    calls={**SHADER_CALLS, "bits": "floatBitsToInt({0})", "from_bits": "intBitsToFloat({0})"},
    infinity="intBitsToFloat(0x7f800000)",
    nan="intBitsToFloat(0x7fc00000)",
    note="Paste or include it after #version 450.",
)
