// A block of elements as a material's kernel sees it: arrays of values, and numbers that are the same for
// all.
#pragma once

#include <array>
#include <cstddef>

#include "bindings/material/distribution.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet::bindings {

inline constexpr std::size_t most_values = 12, most_constants = 6;

// One block of elements, whose arrays are valid up to `padded`.
template <class Real>
struct material_block {
  int count, padded;
  bool narrow_results;  // float32, though Real is double
  std::array<block<Real>, most_values> in;
  block<double> element;
  std::array<double, most_constants> constant;
  std::array<block<Real>, 5> out;

  template <class Lanes>
  Lanes at(std::size_t k, int i) const {
    return load<Lanes>(in[k].data() + i);
  }
  template <class Lanes>
  vec3<Lanes> direction(std::size_t k, int i) const {
    return {at<Lanes>(k, i), at<Lanes>(k + 1, i), at<Lanes>(k + 2, i)};
  }
  block3<Real> vectors(std::size_t k) const { return {in[k], in[k + 1], in[k + 2]}; }
};

template <class Real>
using material_kernel = void (*)(const array_distribution<Real>&, material_block<Real>&);

template <class Lanes>
void put(const Lanes& x, block<lane_of<Lanes>>& a, int i) {
  store(x, a.data() + i);
}
template <class Lanes>
void put(const vec3<Lanes>& v, block3<lane_of<Lanes>>& a, int i) {
  put(v.x, a.x, i), put(v.y, a.y, i), put(v.z, a.z, i);
}
template <class Lanes>
vec3<Lanes> at(const block3<lane_of<Lanes>>& a, int i) {
  return {load<Lanes>(a.x.data() + i), load<Lanes>(a.y.data() + i), load<Lanes>(a.z.data() + i)};
}
template <class Lanes>
Lanes at(const block<lane_of<Lanes>>& a, int i) {
  return load<Lanes>(a.data() + i);
}

}  // namespace microfacet::bindings
