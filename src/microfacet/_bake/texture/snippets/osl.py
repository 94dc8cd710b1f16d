"""Open Shading Language."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".osl",
    real="float",
    colour="color",
    pair="color",
    pair_of="color({}, {}, 0.0)",
    table="string table",
    fetch='color(texture(table, {x}, {y}, 0.0, 0.0, 0.0, 0.0, "wrap", "clamp", "interp", "bilinear"))',
    binding="the name of the OpenEXR file",
    first="{}[0]",
    second="{}[1]",
)
