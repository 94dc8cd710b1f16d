"""C99, which is C++ as well."""

from __future__ import annotations

from microfacet._export.language import C_CALLS, OPERATORS, Language

__all__ = ["LANGUAGE"]

_VECTORS = """#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef MICROFACET_VECTORS
#define MICROFACET_VECTORS
typedef struct { float x, y; } mf_vec2;
typedef struct { float x, y, z; } mf_vec3;
typedef struct { float x, y, z, w; } mf_vec4;

static inline mf_vec2 mf_vec2_of(float x, float y) {
  mf_vec2 v = {x, y};
  return v;
}

static inline mf_vec3 mf_vec3_of(float x, float y, float z) {
  mf_vec3 v = {x, y, z};
  return v;
}

static inline mf_vec4 mf_vec4_of(float x, float y, float z, float w) {
  mf_vec4 v = {x, y, z, w};
  return v;
}

static inline float mf_float_of_bits(int bits) {
  float x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

static inline int mf_bits_of_float(float x) {
  int bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}
#endif"""

LANGUAGE = Language(
    name="c",
    title="C and C++",
    ending=".h",
    vectors={2: "mf_vec2", 3: "mf_vec3", 4: "mf_vec4"},
    calls={**C_CALLS, "bits": "mf_bits_of_float({0})", "from_bits": "mf_float_of_bits({0})"},
    operators={
        **OPERATORS,
        "shift_left": "(int)((unsigned){0} << {1})",
        "shift_right_logical": "(int)((unsigned){0} >> {1})",
    },
    native=True,
    number="{0}f",
    infinity="mf_float_of_bits(0x7f800000)",
    nan="mf_float_of_bits(0x7fc00000)",
    declare="const {type} {name} = {value};",
    unused="(void){name};",
    vector="{type}_of({values})",
    function="static inline {type} {name}({parameters}) {{",
    parameter_out="{type} *{name}",
    struct="typedef struct {{",
    struct_end="}} {name};",
    table="static const {type} {name}[{count}] = {{{values}}};",
    preamble=_VECTORS,
)
