"""C99 and C++, on the bare numbers of the raw format."""

from __future__ import annotations

from microfacet._bake.texture.snippets.language import Language

LANGUAGE = Language(
    suffix=".h",
    real="float",
    colour="float",
    pair="$pair",
    pair_of="$pair_of({}, {})",
    table="const float *table",
    fetch="$fetch(table, {x}, {y})",
    binding="the content of the raw file in float32; call the functions of reflectances for each channel",
    function="static inline {type} {name}({parameters})\n{{",
    local="const {type} {name} = {value};",
    suffix_of_numbers="f",
    names={"min": "fminf", "max": "fmaxf", "sqrt": "sqrtf", "log": "logf", "floor": "floorf"},
    preamble="""#include <math.h>

typedef struct {
    float x, y;
} $pair;

static inline $pair $pair_of(float x, float y)
{
    const $pair result = {x, y};
    return result;
}

/* Linear between texels, the outermost ones beyond. */
static inline $pair $fetch(const float *table, float x, float y)
{
    const float u = fminf(fmaxf(x * $width.0f - 0.5f, 0.0f), $width.0f - 1.0f);
    const float v = fminf(fmaxf(y * $height.0f - 0.5f, 0.0f), $height.0f - 1.0f);
    const int i = (int)fminf(u, $width.0f - 2.0f), j = (int)fminf(v, $height.0f - 2.0f);
    const float s = u - (float)i, t = v - (float)j;
    const float *a = table + 2 * (j * $width + i), *b = a + 2 * $width;
    const float first = (1.0f - t) * ((1.0f - s) * a[0] + s * a[2]) + t * ((1.0f - s) * b[0] + s * b[2]);
    const float second = (1.0f - t) * ((1.0f - s) * a[1] + s * a[3]) + t * ((1.0f - s) * b[1] + s * b[3]);
    return $pair_of(first, second);
}
""",
)
