// Directions in standard space, where roughness is 1 and their azimuth is 0, and the way back for normals.
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/spherical_cap.hpp"

namespace microfacet {

namespace detail {

// A direction in standard space: x = cot(theta), and its azimuth.
template <class T>
struct standard_direction {
  T x, cosine, sine;

  template <class Shape>
  standard_direction(const Shape& shape, const vec3<T>& w) {
    constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
    T a = w.x, b = w.y;
    shape.to_standard(a, b);
    const T length2 = a * a + b * b;
    const auto vertical = length2 < T(single ? 1e-36 : 1e-290);
    const T inverse = T(1) / sqrt(select(vertical, T(1), length2));
    // From far below the horizon only slopes beyond -x are seen.
    const T most = T(single ? 1e9 : 1e15), deepest = T(single ? -1e18 : -1e150);
    cosine = select(vertical, T(1), T(a * inverse));
    sine = select(vertical, T(0), T(b * inverse));
    // Straight down nothing is seen.
    const T top = select(w.z > T(0), most, select(w.z > T(0), w.z, nan<T>()));
    const T x_argument = select(vertical, top, T(w.z * inverse));
    x = select(x_argument > most, most, select(x_argument < deepest, deepest, x_argument));
  }
};

// A direction in standard space of unit length, and its azimuth.
template <class T>
struct unit_direction {
  cap_direction<T> w;
  T cosine, sine;

  template <class Shape>
  unit_direction(const Shape& shape, const vec3<T>& given) {
    constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
    T a = given.x, b = given.y;
    shape.to_standard(a, b);
    const T across2 = a * a + b * b, length2 = across2 + given.z * given.z;
    const auto vertical = across2 < T(single ? 1e-36 : 1e-290);
    const T across = sqrt(select(vertical, T(1), across2)), length = sqrt(length2);
    // Both reciprocals from one quotient. Straight down nothing is seen.
    const T both = T(1) / (across * nan_unless((!vertical) | (given.z > T(0)), length));
    const T per_across = both * length;
    w = {select(vertical, T(0), T(across2 * both)), given.z * across * both, length2 * both};
    cosine = select(vertical, T(1), T(a * per_across)), sine = select(vertical, T(0), T(b * per_across));
  }
};

// The unit normal of a facet (in the plane of w, across it, up) of standard space.
template <class T, class Shape>
vec3<T> normal_of_facet(const Shape& shape, const unit_direction<T>& w, const vec3<T>& m) {
  T x = w.cosine * m.x - w.sine * m.y, y = w.sine * m.x + w.cosine * m.y;
  shape.to_surface(x, y);
  const T inverse = T(1) / sqrt(x * x + y * y + m.z * m.z);
  return {x * inverse, y * inverse, m.z * inverse};
}

// The unit normal of slopes, favourable ones positive, in the frame of a standard direction.
template <class T, class Shape>
vec3<T> normal_of_visible(const Shape& shape, const standard_direction<T>& w, const visible_slopes<T>& s) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T most = T(single ? 1e18 : 1e150);
  T x = w.cosine * s.along - w.sine * s.across, y = w.sine * s.along + w.cosine * s.across;
  shape.to_surface(x, y);
  // Beside slopes whose squares might overflow 1 is nothing.
  const T scale = select(maximum(T(abs(x)), T(abs(y))) > most, T(single ? 1e-12 : 1e-110), T(1));
  x = x * scale, y = y * scale;
  const T z = T(1) / sqrt(T(1) + (x * x + y * y));
  return {x * z, y * z, z};
}

}  // namespace detail

}  // namespace microfacet
