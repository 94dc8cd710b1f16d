"""Stand-ins for what CUDA and Metal bring, so that a C++ compiler reads and runs their text."""

from __future__ import annotations

__all__ = ["CUDA", "METAL"]

_BITS = """#include <cmath>
#include <cstring>
static inline float float_of(int bits) { float x; std::memcpy(&x, &bits, sizeof x); return x; }
static inline int bits_of(float x) { int bits; std::memcpy(&bits, &x, sizeof bits); return bits; }
struct float2 { float x, y; };
struct float3 { float x, y, z; };
struct float4 { float x, y, z, w; };
"""

CUDA = (
    _BITS
    + """#define __device__
static inline float2 make_float2(float x, float y) { return {x, y}; }
static inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
static inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }
static inline float __int_as_float(int bits) { return float_of(bits); }
static inline int __float_as_int(float x) { return bits_of(x); }
"""
)

# Metal's vectors are made by their names, as aggregates are from C++20 on; `constant` is an address space.
METAL = (
    _BITS
    + """#define constant static const
#define thread
typedef unsigned int uint;
namespace metal {
using std::exp; using std::log; using std::sqrt; using std::floor; using std::pow;
using std::sin; using std::cos; using std::fabs; using std::fmin; using std::fmax;
template <class To> To as_type(float x) { return bits_of(x); }
template <class To> To as_type(int bits) { return float_of(bits); }
}
"""
)
