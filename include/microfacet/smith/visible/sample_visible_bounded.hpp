// Visible normals of GGX for reflection: mirrored directions that would end below the horizon are left out as
// far as a smaller spherical cap can (Eto and Tokuyoshi, Bounded VNDF Sampling for Smith-GGX Reflections,
// 2023). The density is no longer D_visible.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"

namespace microfacet {

namespace detail {

// The cap of w reaches down to z = -k w.z in standard space; all of it for w below the horizon.
template <class T, class Shape>
T bound_of_cap(const Shape& shape, const vec3<T>& w) {
  const T a = minimum(shape.least(), T(1)), a2 = a * a;
  const T s2 = square(T(T(1) + sqrt(w.x * w.x + w.y * w.y)));
  return select(w.z > T(0), T((T(1) - a2) * s2 / (s2 + a2 * w.z * w.z)), T(1));
}

}  // namespace detail

template <class Family, class T, class Shape>
vec3<T> sample_visible_bounded(const ndf<Family, T, Shape>& distribution, const vec3<T>& w, const T& xi0,
                               const T& xi1, const T& = T(0)) {
  const detail::unit_direction<T> seen(distribution.shape(), w);
  const T k = detail::bound_of_cap(distribution.shape(), w);
  const vec3<T> facet =
      distribution.family().bounded_facet(seen.w, k, detail::uniform(xi0), detail::uniform(xi1));
  return detail::normal_of_facet(distribution.shape(), seen, facet);
}

// Its density per steradian: D (w . m) over the area of the cap, 0 for a normal that mirrors w out of it.
template <class Family, class T, class Shape>
T pdf_visible_bounded(const ndf<Family, T, Shape>& distribution, const vec3<T>& m, const vec3<T>& w) {
  const Shape& shape = distribution.shape();
  const T k = detail::bound_of_cap(shape, w), s2 = shape.stretch2(w).high, length = sqrt(s2 + w.z * w.z);
  // 2/(length + k w.z), which cancels for w.z < 0, where k = 1.
  const T above = T(2) / (length + k * maximum(w.z, T(0)));
  const T below = T(2) * (length - minimum(w.z, T(0))) / s2;
  const T cosine = dot(m, w) / sqrt(dot(m, m));
  // The mirrored direction's height over the lowest one, in standard space, where normals have the slopes
  // over alpha: 2 (w . h) h_z/|h|^2 - (1 - k) w.z with h = (x/alpha_x, y/alpha_y, z).
  const T unit = shape.unit(), h2 = shape.unit_slope2(m).high / square(unit) + m.z * m.z;
  const T height = T(2) * dot(m, w) * m.z / h2 - (T(1) - k) * w.z;
  const T density = maximum(cosine, T(0)) * distribution.D(m) * select(w.z > T(0), above, below);
  return select(height >= T(0), density, T(density * T(0)));
}

}  // namespace microfacet
