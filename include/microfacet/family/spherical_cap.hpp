// Visible normals of power laws by way of reflection: about a visible normal of slopes (P, q)/scale the
// direction w = (wx, 0, wz), mirrored, lands on the spherical cap z > -wz. For GGX it is uniform there
// (Dupuy and Benyoub, Sampling visible GGX normals with spherical caps, 2023).
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

inline constexpr double sqrt_two = 1.4142135623730950488;

// A height on the cap of the direction (wx, 0, wz): h = z + wz is `share` in (0, 1] of its largest.
template <class T>
class spherical_cap {
 public:
  spherical_cap(const T& wx, const T& wz, const T& share)
      : spherical_cap(wx, wz, share, T(1), T(1) - share) {}
  // A smaller cap, up to z = -k wz, of which `share` + `rest` = 1 is the part below the height.
  spherical_cap(const T& wx, const T& wz, const T& share, const T& k, const T& rest) : wx_(wx), wz_(wz) {
    const T larger = T(1) + abs(wz_), smaller = wx_ * wx_ / larger;
    const auto up = wz > T(0);
    const T plus = select(up, larger, smaller), minus = select(up, smaller, larger);  // 1 + wz, 1 - wz
    const T bounded = plus - (T(1) - k) * wz_;                                        // 1 + k wz
    h_ = maximum(T(share * bounded + (T(1) - k) * wz_), T(1e-18));
    sine_ = sqrt(rest * bounded * (h_ + minus));
  }

  // The normal that mirrors w to this height at the azimuth of the cosine and sine of its half: components in
  // the plane of w, across it and up, of any length.
  vec3<T> facet(const T& cosine2, const T& double_product) const {
    const T difference = h_ * (h_ - T(2) * wz_) / maximum(T(wx_ + sine_), smallest<T>());  // wx - sine
    return {multiply_add(T(T(2) * sine_), cosine2, difference), sine_ * double_product, h_};
  }
  vec3<T> facet_of_uniform(const T& xi) const {
    const elementary::circle<T> half = elementary::cos_sin_of_turns(T(T(0.5) * xi));
    return facet(half.cosine * half.cosine, T(2) * half.sine * half.cosine);
  }
  // Density (wz + z)^2/(1 + w . o) on the cap: a linear height, and the tangent of half the azimuth is that
  // of a uniform angle times (1 + wz z + wx sin)/h.
  vec3<T> facet_of_cubic(const T& xi) const {
    const elementary::circle<T> half = elementary::cos_sin_of_turns(T(T(0.5) * xi - T(0.25)));
    const T a = half.cosine * h_, b = half.sine * (wx_ * wx_ + wz_ * h_ + wx_ * sine_);
    const T inverse = T(1) / (a * a + b * b + smallest<T>());
    return facet(T(a * a * inverse), T(T(2) * a * b * inverse));
  }

 private:
  T wx_, wz_, h_, sine_;
};

}  // namespace microfacet
