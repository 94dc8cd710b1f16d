// Slope marginals of GTR (special/gtr_marginal.hpp) for alpha > 1 and large gamma, where survival is 1 to
// rounding on all circles that reach hardly beyond the slope x: on one of radius r with L = log((alpha^2 +
// r^2)/(1 + r^2)) it is 1 - exp(-|g| L). What lies beyond x on a circle has a closed form, of which the
// marginals are means with the weight |g| exp(-|g| L): with rho^2 = r^2 - x^2,
//
//   mean_excess(x) = mean (rho - x acos(x/r))/pi,  slope_sf(x) = mean acos(x/r)/pi,  P2(x) = mean 1/(pi rho)
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/approx/gauss.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet::detail {

// Gauss' rule for the mean, in s = sqrt(|g| L), in which it is analytic: s^2, and the weights over pi.
template <std::size_t Nodes>
struct rule_of_circles {
  std::array<double, Nodes> square, weight;

  // exp(-end^2) is nothing.
  explicit rule_of_circles(double end) {
    const gauss_legendre<Nodes> rule;
    for (std::size_t i = 0; i < Nodes; ++i) {
      const double s = 0.5 * end * (1 + rule.node[i]);
      square[i] = s * s, weight[i] = end * rule.weight[i] * s * std::exp(-s * s) / pi;
    }
  }
};
template <bool single>
inline const rule_of_circles<single ? 14 : 28> the_rule_of_circles(single ? 4.5 : 6.4);

template <class T>
class gtr_wide_circles {
 public:
  // amplitude^2 = x^2 + 1, span = alpha^2 - 1, rate = |g|.
  gtr_wide_circles(const T& x, const T& amplitude, const T& span, const T& rate)
      : x_(x), amplitude2_(square(amplitude)), span_(span), inverse_rate_(T(1) / rate) {}

  // (1/pi) the mean of f(rho, acos(x/r)).
  template <class Function>
  T mean(const Function& f) const {
    const auto& rule = the_rule_of_circles<single>;
    return accumulate(static_cast<int>(rule.square.size()), T(0), [&](const term<T>& i, const T& sum) {
      const T rho2 =
          maximum(T(span_ / expm1(T(i.of(rule.square)) * inverse_rate_) - amplitude2_), smallest<T>());
      const T rho = sqrt(rho2), r = sqrt(rho2 + x_ * x_);
      return T(sum + T(i.of(rule.weight)) * f(rho, twice_arctangent(T(rho / (r + x_)))));
    });
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  // 2 atan(t) for 0 <= t <= 1, by the series for a quarter of the angle.
  static T twice_arctangent(const T& t) {
    const T half = t / (T(1) + sqrt(T(1) + t * t)), y = half / (T(1) + sqrt(T(1) + half * half)), y2 = y * y;
    T series(0);
    for (int k = 25; k >= 1; k -= 2) series = T(1.0 / k) - y2 * series;
    return T(8) * y * series;
  }

  T x_, amplitude2_, span_, inverse_rate_;
};

}  // namespace microfacet::detail
