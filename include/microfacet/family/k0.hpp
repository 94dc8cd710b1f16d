// K0 slopes: Beckmann with an exponentially distributed squared roughness; Bessel K at a = 1.
//
//   P22(r2)         = 2 K_0(2y)/pi,  y^2 = r2    infinite at 0
//   survival(r2)    = 2 y K_1(2y)
//   P2(t)           = exp(-2|t|)
//   slope_sf(t)     = exp(-2t)/2
//   slope_excess(x) = exp(-2x)/4
//
// d'Eon's notebook "K0 NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/math.hpp"
#include "microfacet/family/bessel_k.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet {

template <class T>
class k0 {
 public:
  using scalar = T;
  static constexpr std::string_view name = "k0";
  static constexpr std::array<parameter, 0> parameters{};
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool shape_invariant = true;

  T P22(const T& r2) const { return isotropic().P22(r2); }
  T P22_of_slope(const T& y) const { return isotropic().P22_of_slope(y); }
  T D(const T& z, const T& h2) const { return isotropic().D(z, h2); }
  T survival(const T& r2) const { return isotropic().survival(r2); }
  T radius(const T& xi) const { return isotropic().radius(xi); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  T P2(const T& t) const { return exp(T(-2) * abs(t)); }
  T slope_sf(const T& t) const {
    return symmetric_sf(t, [](const T& x) { return T(0.5) * exp(T(-2) * x); });
  }
  T slope_excess(const T& x) const { return T(0.25) * exp(T(-2) * x); }

 private:
  static bessel_k<T> isotropic() { return bessel_k<T>(T(1)); }
};

static_assert(radial_family<k0<double>>);

}  // namespace microfacet
