// Directions in the local frame: n = +z, pointing away from the surface.
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
struct vec3 {
  T x, y, z;
};

template <class T>
T dot(const vec3<T>& a, const vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace microfacet
