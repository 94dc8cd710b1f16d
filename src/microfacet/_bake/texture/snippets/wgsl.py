"""WGSL."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".wgsl",
    real="f32",
    colour="vec3<f32>",
    pair="vec2<f32>",
    pair_of="vec2<f32>({}, {})",
    table="table: texture_2d<f32>, state: sampler",
    fetch="textureSampleLevel(table, state, vec2<f32>({x}, {y}), 0.0).rg",
    binding="a texture_2d<f32> and a sampler, linear and clamp-to-edge; float32 texels need the feature "
    "float32-filterable, half do not",
    function="fn {name}({parameters}) -> {type} {{",
    parameter="{name}: {type}",
    local="let {name}: {type} = {value};",
)
