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

  T P22(const T& r2) const { return exp(-r2) / T(pi); }
  T D(const T& z, const T& h2) const { return density_from_log(T(-h2 / (z * z)), z) / T(pi); }
  T survival(const T& r2) const { return exp(-r2); }
  T radius2(const T& xi) const { return -log1p(-xi); }
  T P2(const T& t) const { return exp(-t * t) / T(sqrt_pi); }
  T slope_sf(const T& t) const {
    return symmetric_sf(t, [](const T& x) { return T(0.5) * exp(-x * x) * erfc_scaled(x); });
  }
  T slope_excess(const T& x) const { return T(0.5) * exp(-x * x) * ierfc_scaled(x); }
};

static_assert(radial_family<beckmann<double>>);

}  // namespace microfacet
