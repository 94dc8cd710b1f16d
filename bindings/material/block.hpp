// Blocks of elements as a material's kernel sees them: arrays of values, and numbers that are the same for
// all.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/walk/rays.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet::bindings {

inline constexpr std::size_t most_values = 12, most_constants = 6, most_results = 5;

// A kernel sets up what it needs once, and asks for one block after the other. Arrays are valid up to
// `padded`, a multiple of any number of lanes.
template <class Real>
struct material_blocks {
  bool (*turn)(material_blocks&);  // to the next block, as long as there is one
  bool next() { return turn(*this); }

  int count = 0, padded = 0;
  bool narrow_results;  // float32, though Real is double
  bool one_material;    // whose parameters are the same for all elements
  Real tolerance;       // to which a direction of squared length 1 counts as normalised
  std::array<const Real*, most_values> in;
  std::array<Real*, most_results> out;
  block<double> element;
  std::array<double, most_constants> constant;

  template <class Lanes>
  Lanes at(std::size_t k, int i) const {
    return load<Lanes>(in[k] + i);
  }
  // A direction of unit length.
  template <class Lanes>
  vec3<Lanes> direction(std::size_t k, int i) const {
    return normalize(vec3<Lanes>{at<Lanes>(k, i), at<Lanes>(k + 1, i), at<Lanes>(k + 2, i)},
                     Lanes(tolerance));
  }
  template <class Lanes>
  block3<Real> directions(std::size_t k) const {
    block3<Real> result{};
    for (int i = 0; i < padded; i += width<Lanes>) {
      const vec3<Lanes> w = direction<Lanes>(k, i);
      store(w.x, result.x.data() + i), store(w.y, result.y.data() + i), store(w.z, result.z.data() + i);
    }
    return result;
  }
};

template <class Lanes>
void put(const vec3<Lanes>& v, block3<lane_of<Lanes>>& a, int i) {
  store(v.x, a.x.data() + i), store(v.y, a.y.data() + i), store(v.z, a.z.data() + i);
}
template <class Lanes>
vec3<Lanes> at(const block3<lane_of<Lanes>>& a, int i) {
  return {load<Lanes>(a.x.data() + i), load<Lanes>(a.y.data() + i), load<Lanes>(a.z.data() + i)};
}

}  // namespace microfacet::bindings
