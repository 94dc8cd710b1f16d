// Ei slopes: Beckmann whose squared roughness is uniform in (0, 1), so that its density is an exponential integral.
//
//   P22(r2)         = E_1(r2)/pi                 infinite at 0
//   survival(r2)    = E_2(r2)
//   P2(t)           = 2 ierfc(t)
//   slope_sf(t)     = 2 i2erfc(t)                i_n erfc: the n-th integral of erfc
//   mean_excess(x) = 2 i3erfc(x)
//
// Beyond 1/4 the integrals of erfc are means of positive terms: with q^2 = t^2 + s,
//
//   i_n erfc(t) = exp(-t^2)/sqrt(pi) int exp(-s) (s/(q + t))^n/(n! q) ds
//
// d'Eon's notebook "Ei NDF".
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
class ei : public radial_defaults<T, part::P22_by_slope | part::direct_radius, of_all> {
 public:
  static constexpr std::string_view name = "ei";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool tables_alone = true;

  T P22(const double_double<T>& r2) const {
    return density(T(log(maximum(r2.high, smallest<T>()))), r2, T(1), r2.high);
  }
  T P22_of_slope(const T& r) const {
    return density(T(T(2) * log(maximum(r, smallest<T>()))), slope<T>(r).squared, T(1), r);
  }
  T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    const double_double<T> r2 = quotient(h2, two_prod(z, z), reciprocal);
    return density(T(log(maximum(r2.high, smallest<T>()))), r2, T(square(reciprocal)), r2.high);
  }
  T survival(const double_double<T>& r2) const { return exponential_integral::e2(r2); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // Newton's method for L = log r2: below the median on log(1 - survival) against L, beyond on log(survival) against r2.
  T radius(const T& xi) const {
    using namespace exponential_integral;
    const T inner = maximum(xi, smallest<T>()), rest = T(1) - xi;
    const auto lower = xi < T(0.5);
    const T target = log(select(lower, inner, rest));
    const T start = select(lower, T(target - log(T(T(1.5) - target))), T(log(T(0.4) - T(0.8) * target)));
    const T L = iterate(40, start, start == start, [&](const T& now) {
      const T y = exp(now), density = e1(now, double_double<T>(y));
      const T beyond = e2(double_double<T>(y));
      const T within = select(y < T(meeting), within_e2(now, y), T(T(1) - beyond));
      const T left = (target - log(within)) * within / (y * density);
      const T right = log1p(maximum(T((log(beyond) - target) * beyond / (y * density)), T(-0.5)));
      const T next = now + select(lower, minimum(maximum(left, T(-2)), T(2)), right);
      return iteration{next, abs(next - now) > T(single ? 1e-4 : 1e-9)};
    });
    // From 1 - survival = y (E_1(y) - expm1(-y)/y) the small radius has the digits of xi, not those of L.
    const T y = exp(L), by_series = sqrt(inner) / sqrt(T(e1_near(L, y) + expm1_over(T(-y))));
    return select(xi == T(0), T(0), select(lower & (y < T(meeting)), by_series, T(exp(T(0.5) * L))));
  }
  T P2(const slope<T>& t) const {
    const slope<T> x(abs(t.value), t.squared);
    return times_exp_minus(T(T(2) * ierfc_scaled(x.value.high)), x.squared);
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) {
      return tail(
          x, [](const T& at, const T& y) { return T((T(0.5) + y) * erfc_scaled(at) - at * T(1 / sqrt_pi)); },
          [](const T& part, const T& q) { return T(square(part) / q * T(1 / sqrt_pi)); });
    });
  }
  T mean_excess(const slope<T>& t) const {
    return tail(
        t,
        [](const T& at, const T& y) {
          return T((T(1) + y) * T(1 / (3 * sqrt_pi)) - at * (T(0.5) + y * T(1.0 / 3)) * erfc_scaled(at));
        },
        [](const T& part, const T& q) { return T(part * square(part) / q * T(1 / (3 * sqrt_pi))); });
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  // Of a slope r that is 0 where r2 and its logarithm are not to be asked.
  static T density(const T& log_r2, const double_double<T>& r2, const T& factor, const T& r) {
    return select(r == T(0), infinite<T>(), exponential_integral::e1(log_r2, r2, T(factor * T(1 / pi))));
  }
  // exp(-t^2) times a closed form at_origin(t, t^2), and beyond 1/4 times the mean of term(s/(q + t), q).
  template <class AtOrigin, class Term>
  static T tail(const slope<T>& t, const AtOrigin& at_origin, const Term& term) {
    const auto inside = t.value.high < T(0.25);
    const T factor = select_lazy(
        inside,
        [&] {
          const T at = minimum(t.value.high, T(0.25));
          return at_origin(at, T(at * at));
        },
        [&] {
          const T at = minimum(maximum(t.value.high, T(0.25)), T(30)), y = at * at;
          return exponential_mean<T>([&](const T& s) {
            const T q = sqrt(y + s);
            return term(T(s / (q + at)), q);
          });
        });
    return times_exp_minus(factor, t.squared);
  }
};

static_assert(radial_family<ei<float>> && radial_family<ei<double>>);

}  // namespace microfacet
