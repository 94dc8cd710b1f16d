// What values a parameter may have. A constant outside is refused, from the scene and after each change; of a
// texture that varies, what lies outside is taken at the nearest end of its range.
#pragma once

#include <mitsuba/render/texture.h>

#include <string>

#include "variant.hpp"

namespace microfacet::plugin {

struct domain {
  const char *what, *interval;  // in words
  float lower, upper;
  bool with_lower, with_upper;
};

constexpr float huge = 3.4e38F;
inline constexpr domain roughnesses{"roughness", "(0, 1e4]", 0, 1e4F, false, true},
    angles{"an angle in radians", "[-1e3, 1e3]", -1e3F, 1e3F, true, true},
    indices{"an index of refraction", "(0, inf)", 0, huge, false, true},
    indices_of_tables{"an index of refraction", "[0, inf)", 0, huge, true, true},
    extinctions{"an extinction coefficient", "[0, inf)", 0, huge, true, true},
    relative_indices{"a relative index of refraction", "(1e-8, 1e8)", 1e-8F, 1e8F, false, false},
    factors{"a factor", "[0, 1]", 0, 1, true, true};

using Texture = mitsuba::Texture<Float, Spectrum>;

// The first number of an array.
template <class R>
float number(const R& x, std::size_t lane = 0) {
  if constexpr (drjit::is_jit_v<R>) {
    return drjit::slice<float>(drjit::detach(x), lane);
  } else {
    return x;
  }
}

// Throws one sentence, in the name of the plugin.
void check(const std::string& plugin, const char* name, const Float& values, const domain& allowed);
// The same for a texture of numbers or of spectra that does not vary; nullptr is none.
void check_number(const std::string& plugin, const char* name, const Texture* texture, const domain& allowed);
void check_spectrum(const std::string& plugin, const char* name, const Texture* texture,
                    const domain& allowed);

// Also where x is no number. Derivatives reach the ends.
template <class R>
R bounded(const R& x, float lower, float upper) {
  return drjit::select(x >= lower, drjit::select(x <= upper, x, R(upper)), R(lower));
}

}  // namespace microfacet::plugin
