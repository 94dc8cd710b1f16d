"""Stand-ins for the textures of CUDA and Metal, so that a C++ compiler reads and runs the snippets."""

from __future__ import annotations

__all__ = ["HEADS"]

_CUDA = """#include <cmath>
#define __device__
#define __global__
struct float2 { float x, y; };
static inline float2 make_float2(float x, float y) { return {x, y}; }
"""

# Clang's vectors have components by name and arithmetic with numbers, as those of Metal have.
_METAL = """#include <cmath>
typedef float float2 __attribute__((ext_vector_type(2)));
typedef float float3 __attribute__((ext_vector_type(3)));
typedef float float4 __attribute__((ext_vector_type(4)));
#define float2(...) (float2){__VA_ARGS__}
#define float3(...) (float3){__VA_ARGS__}
"""

# Linear between texels, clamped to the edge, as the snippets ask for.
_TEXEL = """
static inline void texel(const float *table, float x, float y, float *found)
{
    const double u = std::fmin(std::fmax(double(x) * WIDTH - 0.5, 0.0), WIDTH - 1.0);
    const double v = std::fmin(std::fmax(double(y) * HEIGHT - 0.5, 0.0), HEIGHT - 1.0);
    const int i = int(std::fmin(u, WIDTH - 2.0)), j = int(std::fmin(v, HEIGHT - 2.0));
    for (int k = 0; k < 2; ++k) {
        const float *at = table + 2 * (j * WIDTH + i) + k;
        const double low = at[0] + (u - i) * (at[2] - at[0]);
        const double high = at[2 * WIDTH] + (u - i) * (at[2 * WIDTH + 2] - at[2 * WIDTH]);
        found[k] = float(low + (v - j) * (high - low));
    }
}
"""

HEADS = {
    "c": "",
    "cuda": _CUDA
    + _TEXEL
    + """typedef const float *cudaTextureObject_t;
template <class T> T tex2D(cudaTextureObject_t table, float x, float y)
{
    float found[2];
    texel(table, x, y, found);
    return {found[0], found[1]};
}
""",
    "metal": _METAL
    + _TEXEL
    + """namespace metal {
struct sampler {};
struct level { explicit level(float) {} };
template <class T> struct texture2d {
    const float *data;
    float4 sample(sampler, float2 at, level) const
    {
        float found[2];
        texel(data, at.x, at.y, found);
        return (float4){found[0], found[1], 0.0f, 1.0f};
    }
};
static inline float min(float a, float b) { return std::fmin(a, b); }
static inline float max(float a, float b) { return std::fmax(a, b); }
using std::sqrt; using std::log; using std::floor;
}
""",
}
