// Exponential slopes: Bessel K at a = 3/2, whose Lambda the notebook calls unknown and approximates.
//
//   P22(r2)        = 2 exp(-2 r)/pi
//   survival(r2)   = (1 + 2r) exp(-2r)
//   P2(t)          = (4/pi) t K_1(2t)
//   slope_sf, mean_excess   special/variance_gamma.hpp
//
// d'Eon's notebook "Exponential NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/bessel_k.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/bessel_k0.hpp"

namespace microfacet {

template <class T>
class exponential : public radial_defaults<T, part::direct_radius | part::radius_by_odds, of_all> {
 public:
  static constexpr std::string_view name = "exponential";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool tables_alone = true;

  T P22(const double_double<T>& r2) const { return times_exp_minus(T(2 / pi), scaled(T(2), sqrt(r2))); }
  T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    const double_double<T> r2 = quotient(h2, two_prod(z, z), reciprocal);
    return times_exp_minus(T(square(reciprocal) * T(2 / pi)), scaled(T(2), sqrt(bounded(r2))));
  }
  T survival(const double_double<T>& r2) const {
    const double_double<T> twice = scaled(T(2), sqrt(bounded(r2)));
    return times_exp_minus(T(T(1) + twice.high), twice);
  }
  T radius2(const T& xi) const { return square(radius(xi)); }
  T radius(const T& xi) const { return select(xi == T(1), infinite<T>(), radius_at_depth(T(-log1p(-xi)))); }
  T radius_at_odds(const T& odds) const { return radius_at_depth(log1p(odds)); }
  T P2(const slope<T>& t) const {
    const slope<T> size = microfacet::bounded(slope<T>(abs(t.value), t.squared));
    return T(2 / pi) * detail::k0_functions<T>(size.squared).survival();
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) { return bessel_k<T>(T(1.5)).slope_sf(x); });
  }
  T mean_excess(const slope<T>& x) const { return bessel_k<T>(T(1.5)).mean_excess(x); }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  static double_double<T> bounded(const double_double<T>& r2) {
    const T most = square(largest_slope<T>());
    return {minimum(r2.high, most), low_where(r2.high <= most, r2)};
  }
  // y - log(1 + y) for y >= 0, where it cancels by its series: log(1 + y) = 2 atanh(s).
  static T less_log1p(const T& y) {
    const T s = y / (T(2) + y), s2 = s * s;
    T series(0);
    for (int k = 25; k >= 3; k -= 2) series = s2 * series + T(1.0 / k);
    return select(y < T(0.5), T(s * (y - T(2) * s2 * series)), T(y - log1p(y)));
  }
  // Half of y with y - log(1 + y) = depth. It is concave against log depth, and y > sqrt(2 depth), y > depth.
  static T radius_at_depth(const T& depth) {
    const T start = sqrt(T(2) * depth) + depth;
    const T y = iterate(30, start, start > T(0), [&](const T& now) {
      const T change = (depth - less_log1p(now)) * (T(1) + now) / now,
              next = maximum(T(now + change), T(T(0.25) * now));
      return iteration{next, abs(change) > T(single ? 1e-4 : 1e-9) * now};
    });
    return T(0.5) * y;
  }
};

static_assert(radial_family<exponential<float>> && radial_family<exponential<double>>);

}  // namespace microfacet
