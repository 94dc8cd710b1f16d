// What becomes of light at one facet.
#pragma once

#include "microfacet/core/vec.hpp"

namespace microfacet {

template <class T, class Mask = decltype(T(0) < T(0))>
struct scattered {
  vec3<T> w;    // where it goes
  T weight;     // how much of it
  Mask passed;  // whether through the facet
};

}  // namespace microfacet
