// Visible normals of power laws by way of reflection: about a visible normal of slopes (P, q)/scale the
// direction w = (wx, 0, wz), mirrored, lands on the spherical cap z > -wz. For GGX it is uniform there
// (Dupuy and Benyoub, Sampling visible GGX normals with spherical caps, 2023).
//
// A facet is the sum of both directions, of any length. No quotient is formed: above the horizon everything is
// as it stands, below it times (1 - wz)/wx, which turns 1 + wz = wx^2/(1 - wz) into wx; and a facet comes out
// times wx + sine, so that its part in the plane, wx - sine = h (h - 2 wz)/(wx + sine) where it is least, does
// not cancel.
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/slope.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

inline constexpr double sqrt_two = 1.4142135623730950488;

// A height on the cap of a direction: h = z + wz is `share` in (0, 1] of its largest, and 1 - share is `rest`.
template <class T>
class spherical_cap {
 public:
  spherical_cap(const cap_direction<T>& w, const T& share, const T& rest) : spherical_cap(w) {
    h_ = maximum(T(share * whole_), T(1e-18));
    sine_ = sqrt(rest * (whole_ * h_ + wx_ * wx_));
  }
  // A smaller cap, from z = -k wz up, for w above the horizon where k < 1.
  spherical_cap(const cap_direction<T>& w, const T& share, const T& rest, const T& k) : spherical_cap(w) {
    const T cut = (T(1) - k) * wz_, kept = whole_ - cut;
    h_ = maximum(T(share * kept + cut), T(1e-18));
    sine_ = sqrt(rest * kept * (h_ + wx_ * wx_ / whole_));
  }

  // The normal that mirrors w to this height at the azimuth 2 pi xi: its components in the plane of w, across
  // it and up, of any length.
  vec3<T> facet_of_uniform(const T& xi) const {
    const elementary::circle<T> half = elementary::cos_sin_of_turns(T(T(0.5) * xi));
    return facet(half.cosine, half.sine);
  }
  // Density (wz + z)^2/(1 + w . o) on the cap: a linear height, and the tangent of half the azimuth is that
  // of a uniform angle times (1 + wz z + wx sin)/h.
  vec3<T> facet_of_cubic(const T& xi) const {
    const elementary::circle<T> half = elementary::cos_sin_of_turns(T(T(0.5) * xi - T(0.25)));
    return facet(T(half.cosine * h_ * scale_), T(half.sine * (wx_ * wx_ + wz_ * h_ + wx_ * sine_)));
  }

 private:
  explicit spherical_cap(const cap_direction<T>& w) {
    const auto up = w.wz > T(0);
    const T larger = T(1) + abs(w.wz);
    scale_ = select(up, T(1), T(larger * w.inverse_wx));
    wx_ = select(up, w.wx, larger), whole_ = select(up, larger, w.wx), wz_ = w.wz * scale_;
  }
  // At the azimuth whose half has this cosine and sine, both times any factor.
  vec3<T> facet(const T& cosine, const T& sine) const {
    const T sum = maximum(T(wx_ + sine_), T(1e-15)), c2 = cosine * cosine, n = c2 + sine * sine;
    const T twice = T(2) * sine_ * sum * cosine;
    return {multiply_add(twice, cosine, T(h_ * (h_ - T(2) * wz_) * n)), twice * sine, h_ * sum * n};
  }

  T wx_, wz_, whole_, scale_, h_, sine_;
};

}  // namespace microfacet
