// Normals drawn from D cos(theta), from a pair of uniforms: the slope's length by the inverse of its survival
// function (xi = 0 gives the normal itself), its azimuth uniform in standard space.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"

namespace microfacet {

// The standard slope at survival 1 - xi. A family may state it without its square, which underflows first.
template <class Family, class T>
T sample_radius(const Family& family, const T& xi) {
  if constexpr (direct_radius<Family>) {
    return family.radius(xi);
  } else {
    return sqrt(family.radius2(xi));
  }
}

// tan(theta) of a normal of an isotropic distribution.
template <class Family, class T>
T sample_slope(const Family& family, const isotropic_shape<T>& shape, const T& xi) {
  const auto valid = (xi >= T(0)) & (xi < T(1));
  return shape.along_x() * sample_radius(family, nan_unless(valid, xi));
}

// cos(theta) of the same normal.
template <class T>
T cosine_of_slope(const T& slope) {
  const auto steep = slope > T(1e9);  // whose square may overflow
  return T(1) / select(steep, slope, T(sqrt(T(1) + slope * slope)));
}

// Pr(slope > r) for r >= 0; nan below.
template <class Family, class T>
T survival(const ndf<Family, T, isotropic_shape<T>>& distribution, const T& r) {
  const Family& family = distribution.family();
  const T valid = nan_unless(r >= T(0), r);
  const double_double<T> r2 = distribution.shape().slope2(valid);
  if constexpr (survival_by_slope<Family>) {  // where a square has lost digits
    const T most = square(largest_slope<T>());
    return select_lazy((minimum(r2.high, T(valid * valid)) < T(0x1p30) * smallest<T>()) | !(r2.high < most),
                       [&] { return family.survival_of_slope(distribution.shape().length(valid, T(0))); },
                       [&] { return family.survival(r2); });
  } else {
    return family.survival(r2);
  }
}

template <class Family, class T, class Shape>
vec3<T> sample_normal(const ndf<Family, T, Shape>& distribution, const T& xi_radius, const T& xi_azimuth) {
  const auto valid = (xi_radius >= T(0)) & (xi_radius < T(1)) & (xi_azimuth >= T(0)) & (xi_azimuth < T(1));
  const T radius = sample_radius(distribution.family(), nan_unless(valid, xi_radius));
  const elementary::circle<T> azimuth = elementary::cos_sin_of_turns(xi_azimuth);
  // Minus the slopes, so that 2 pi xi is the azimuth of the normal; the density is symmetric.
  T x = radius * azimuth.cosine, y = radius * azimuth.sine;
  distribution.shape().to_surface(x, y);
  const T z = cosine_of_slope(length(x, y));
  return {x * z, y * z, z};
}

}  // namespace microfacet
