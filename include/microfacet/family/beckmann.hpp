// Beckmann: Gaussian slopes.
//
//   P22(r2)         = exp(-r2)/pi
//   survival(r2)    = exp(-r2)
//   P2(t)           = exp(-t^2)/sqrt(pi)
//   slope_sf(t)     = erfc(t)/2
//   slope_excess(x) = ierfc(x)/2
//
// Beckmann and Spizzichino 1963; Walter et al. 2007; Heitz 2014.
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/erf.hpp"

namespace microfacet {

template <class T>
class beckmann {
 public:
  using scalar = T;
  static constexpr std::string_view name = "beckmann";
  static constexpr std::array<parameter, 0> parameters{};
  static constexpr std::array<std::string_view, 3> sources{"beckmann1963scattering", "walter2007microfacet",
                                                           "deon2020hitchhiker"};
  static constexpr bool shape_invariant = true;
  static constexpr bool native_float32 = true;
  static constexpr unsigned costly = 0;

  T nothing() const { return T(0); }
  T P22(const twofold<T>& r2) const { return exp(-r2) * T(1 / pi); }
  MICROFACET_INLINE T D(const T& z_argument, const twofold<T>& h2) const {
    // Where 1/z^2 would overflow, D is zero.
    const T z = maximum(z_argument, T(1) / largest_slope<T>()), reciprocal = T(1) / (z * z);
    const T value = exp<60>(-quotient(h2, exact_product(z, z), reciprocal));
    return value * reciprocal * (reciprocal * T(0x1p-60 / pi));
  }
  T survival(const twofold<T>& r2) const { return exp(-r2); }
  T radius2(const T& xi) const { return -log1p(-xi); }
  T P2(const slope<T>& t, const T& factor = T(1)) const {
    return exp<60>(-t.squared) * (T(0x1p-60 / sqrt_pi) * factor);
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(
        t, [](const slope<T>& x) { return T(0.5) * exp(-x.squared) * erfc_scaled(x.value.high); });
  }
  T slope_excess(const slope<T>& x) const { return T(0.5) * exp(-x.squared) * ierfc_scaled(x.value.high); }
  fraction<T> slope_excess_fraction(const slope<T>& x) const {
    const auto [numerator, denominator] = ierfc_scaled_fraction(x.value.high);
    return {T(0.5) * exp(-x.squared) * numerator, denominator};
  }
};

static_assert(radial_family<beckmann<double>>);

}  // namespace microfacet
