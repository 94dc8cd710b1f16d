// GGX (Trowbridge-Reitz): the member that Student-T (gamma = 2) and GTR (gamma = 2) share.
//
//   P22(r2)         = 1/(pi (1 + r2)^2)
//   survival(r2)    = 1/(1 + r2)
//   P2(t)           = 1/(2 (1 + t^2)^(3/2))
//   slope_sf(t)     = 1/(2 R (R + t)),  R = sqrt(1 + t^2)
//   mean_excess(x) = 1/(2 (x + R))
//
// Trowbridge and Reitz 1975; Walter et al. 2007; Heitz 2014.
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/spherical_cap.hpp"

namespace microfacet {

template <class T>
class ggx : public radial_defaults<T, part::scaled_P2 | part::scaled_sigma | part::facet_sampling |
                                          part::bounded_facet_sampling> {
 public:
  static constexpr std::string_view name = "ggx";
  static constexpr std::array<std::string_view, 3> sources{"trowbridge1975average", "walter2007microfacet",
                                                           "heitz2014masking"};

  T P22(const double_double<T>& r2) const { return T(1 / pi) / square(T(T(1) + r2.high)); }
  T D(const T& z, const double_double<T>& h2) const {
    return T(1 / pi) / square(multiply_add(z, z, h2.high));
  }
  T survival(const double_double<T>& r2) const { return T(1) / (T(1) + r2.high); }
  T radius2(const T& xi) const { return xi / (T(1) - xi); }
  T P2(const slope<T>& t, const T& factor = T(1)) const {
    const T a = T(1) + t.squared.high;
    return rounded(T(T(0.5) * factor / a)) / sqrt(a);
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) {
      const T root = sqrt(T(1) + x.squared.high);
      return T(0.5) / (root * (root + x.value.high));
    });
  }
  T mean_excess(const slope<T>& x) const { return T(0.5) / (x.value.high + sqrt(T(1) + x.squared.high)); }
  fraction<T> sigma_below(const T& c, const double_double<T>& s2) const {
    return {lifted(T(T(0.5) * s2.high)), maximum(T(abs(c) + sqrt(c * c + s2.high)), smallest<T>())};
  }

  // By a uniform point on a spherical cap: two uniforms; the first is 0 where the mirrored direction is +z.
  vec3<T> visible_facet(const cap_direction<T>& w, const T& xi0, const T& xi1) const {
    return spherical_cap<T>(w, T(T(1) - xi0), xi0).facet_of_uniform(xi1);
  }
  // The cap down to z = -k wz.
  vec3<T> bounded_facet(const cap_direction<T>& w, const T& k, const T& xi0, const T& xi1) const {
    return spherical_cap<T>(w, T(T(1) - xi0), xi0, k).facet_of_uniform(xi1);
  }
};

static_assert(radial_family<ggx<float>> && radial_family<ggx<double>>);

}  // namespace microfacet
