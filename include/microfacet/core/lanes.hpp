// Loads and stores numbers of an array as a scalar, which is a number or a pack of them.
#pragma once

#include <cstring>

#include "microfacet/core/math.hpp"

namespace microfacet {

template <class Lanes>
using lane_of = typename scalar_traits<Lanes>::real;
template <class Lanes>
inline constexpr int width = sizeof(Lanes) / sizeof(lane_of<Lanes>);

template <class Lanes>
MICROFACET_INLINE Lanes load(const lane_of<Lanes>* source) {
  Lanes result;
  std::memcpy(&result, source, sizeof result);
  return result;
}
template <class Lanes>
MICROFACET_INLINE void store(const Lanes& values, lane_of<Lanes>* target) {
  std::memcpy(target, &values, sizeof values);
}

}  // namespace microfacet
