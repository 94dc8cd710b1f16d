// Erfc slopes: Beckmann whose roughness is uniform in (0, 1), so that its density is a complementary error function.
//
//   P22(r2)         = erfc(r)/(2 sqrt(pi) r),  r^2 = r2          infinite at 0
//   survival(r2)    = sqrt(pi) ierfc(r)
//   P2(t)           = E_1(t^2)/(2 sqrt(pi))                      infinite at 0
//   slope_sf(t)     = (erfc t - t E_1(t^2)/sqrt(pi))/2
//   mean_excess(x) = (-2 x erfc x + (exp(-x^2) + x^2 E_1(x^2))/sqrt(pi))/4
//
// Beyond 1/4 the last two are means of positive terms, n = 1 and 2: with q^2 = t^2 + s,
//
//   exp(-t^2)/(2 sqrt(pi)) int exp(-s) (s/(q + t))^n/(n! q^2) ds
//
// d'Eon's notebook "Erfc NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/approx/exponential_mean.hpp"
#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/erf.hpp"
#include "microfacet/special/exponential_integral.hpp"

namespace microfacet {

template <class T>
class erfc : public radial_defaults<T, part::P22_by_slope | part::direct_radius, of_all> {
 public:
  static constexpr std::string_view name = "erfc";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool tables_alone = true;

  T P22(const double_double<T>& r2) const { return density(T(sqrt(r2.high)), r2, T(1)); }
  T P22_of_slope(const T& r) const { return density(r, slope<T>(r).squared, T(1)); }
  T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    const double_double<T> r2 = quotient(h2, two_prod(z, z), reciprocal);
    return density(T(sqrt(r2.high)), r2, T(square(reciprocal)));
  }
  T survival(const double_double<T>& r2) const {
    return times_exp_minus(T(T(sqrt_pi) * ierfc_scaled(T(sqrt(minimum(r2.high, T(most)))))), r2);
  }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // Newton's method: below the median on log(1 - survival) against log r, beyond on log(survival) against r^2.
  T radius(const T& xi) const {
    const T inner = maximum(xi, smallest<T>()), rest = T(1) - xi;
    const auto lower = xi < T(0.5);
    const T target = log(select(lower, inner, rest));
    const T start = select(lower, T(inner * T(0.8)), T(sqrt(T(0.05) - T(0.8) * target)));
    const T r = iterate(40, start, start == start, [&](const T& now) {
      const slope<T> at(now);
      const T below = over_radius(at), beyond = survival(at.squared);
      const T above = times_exp_minus(T(T(sqrt_pi) * erfc_scaled(now)), at.squared);  // -d survival/dr
      const T left = (target - log(now) - log(below)) * below / above;
      const T right = (log(beyond) - target) * beyond * T(2) * now / above;
      const T next = select(lower, T(now * exp(minimum(maximum(left, T(-2)), T(2)))),
                            T(sqrt(maximum(T(now * now + right), T(T(0.25) * now * now)))));
      return iteration{next, abs(next - now) > T(single ? 1e-4 : 1e-9) * now};
    });
    return select(xi == T(0), T(0), select(lower, T(inner / over_radius(slope<T>(r))), r));
  }
  T P2(const slope<T>& t) const {
    const slope<T> x(abs(t.value), t.squared);
    return select(x.value.high == T(0), infinite<T>(), e1(x, T(0.5 / sqrt_pi)));
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) {
      return select_lazy(
          x.value.high < T(0.25),
          [&] {
            const T at = minimum(x.value.high, T(0.25));
            return T(T(0.5) * (decayed(erfc_scaled(at), x) - at * e1(x, T(1 / sqrt_pi))));
          },
          [&] { return mean(x, T(0.5 / sqrt_pi), [](const T& part) { return part; }); });
    });
  }
  T mean_excess(const slope<T>& x) const {
    return select_lazy(
        x.value.high < T(0.25),
        [&] {
          const T at = minimum(x.value.high, T(0.25)), squared = at * at;
          return T(decayed(T(T(0.25 / sqrt_pi) - T(0.5) * at * erfc_scaled(at)), x) +
                   squared * e1(x, T(0.25 / sqrt_pi)));
        },
        [&] { return mean(x, T(0.25 / sqrt_pi), [](const T& part) { return square(part); }); });
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double most = 1e3;  // of r2: beyond, exp(-r2) is nothing

  static T decayed(const T& factor, const slope<T>& x) { return times_exp_minus(factor, x.squared); }
  static T density(const T& r, const double_double<T>& r2, const T& factor) {
    const T at = minimum(maximum(r, smallest<T>()), T(most));
    const T value = times_exp_minus(T(T(0.5 / sqrt_pi) * factor * (erfc_scaled(at) / at)), r2);
    return select(r == T(0), infinite<T>(), value);
  }
  // (1 - survival)/r
  static T over_radius(const slope<T>& r) {
    const T at = minimum(r.value.high, T(most));
    return multiply_add(at, expm1_over(T(-at * at)), decayed(T(T(sqrt_pi) * erfc_scaled(at)), r));
  }
  static T e1(const slope<T>& x, const T& factor) {
    return exponential_integral::e1(T(T(2) * log(maximum(x.value.high, smallest<T>()))), x.squared, factor);
  }
  // exp(-x^2) factor int exp(-s) of(s/(q + x))/q^2 ds
  template <class Function>
  static T mean(const slope<T>& x, const T& factor, const Function& of) {
    const T at = minimum(maximum(x.value.high, T(0.25)), T(most)), squared = at * at;
    const T terms = exponential_mean<T>([&](const T& s) {
      const T q2 = squared + s;
      return T(of(T(s / (sqrt(q2) + at))) / q2);
    });
    return decayed(T(factor * terms), x);
  }
};

static_assert(radial_family<erfc<float>> && radial_family<erfc<double>>);

}  // namespace microfacet
