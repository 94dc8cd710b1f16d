// Slope marginals of the density exp(-r^g)/(pi Gamma(1 + 2/g)): with r^2 = t^2 + q^2 and E = r^g - t^g,
//
//   P2(t)          = int 2/q,  slope_sf(t) = int 2 atan(q/t),  mean_excess(t) = int 2 (q - t atan(q/t))
//
// over the density, exp(-t^g) exp(-E) d(r^2)/2. For g <= 1 the variable is E, in which the integrand is one
// exponential, for g > 1 it is q^2, in units of where E = 1 and stretched by the rise of E there, so that a steep
// edge is as wide as a slow fall. Of either v = log(variable) = s - exp(-s): the plain trapezoidal rule in s ends
// after 150 nodes, whatever t and g, and where t^g > 1/10 every other one of them suffices. The other variable is a
// difference of powers with an exponent of at least 1/2, by log1p and expm1 without cancellation.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/slope.hpp"
#include "microfacet/special/arc.hpp"

namespace microfacet::detail {

// Every other node, then those between them.
struct rule_of_powers {
  static constexpr std::size_t nodes = 150;
  static constexpr double first = -5.24, step = 0.07;
  std::array<double, nodes> log, weight;

  rule_of_powers() {
    for (std::size_t i = 0; i < nodes; ++i) {
      const std::size_t node = i < nodes / 2 ? 2 * i : 2 * i + 1 - nodes;
      const double s = first + step * static_cast<double>(node), e = std::exp(-s);
      log[i] = s - e, weight[i] = step * (1 + e);
    }
  }
};
inline const rule_of_powers the_rule_of_powers;

template <class T>
class generalised_exponential_marginal {
 public:
  // norm = 1/(pi Gamma(1 + 2/g)).
  generalised_exponential_marginal(const slope<T>& given, const T& g, const T& norm)
      : t_(minimum(maximum(given.value.high, T(single ? 1e-8 : 1e-17)), T(exp(T(T(1) / g) * T(log_most))))),
        t2_(t_ * t_),
        power_(pow(t_, g)),
        by_power_(g <= T(1)),
        exponent_(select(by_power_, T(T(2) / g), T(T(0.5) * g))),
        norm_(norm) {
    // Where E = 1 and, at least nearly, d log E/d log q^2 there.
    const auto apart = power_ > T(1e-4);
    const T change = (T(2) / g) * log1p(T(1) / select(apart, power_, T(1)));
    const T unit = select(apart, T(t2_ * expm1(change)), T(T(1) - t2_));
    const T rise = T(0.5) * g * select(apart, T((T(-1) - power_) * expm1(-change)), T(T(1) - t2_));
    inverse_rise_ = select(by_power_, T(1), T(T(1) / rise));
    log_unit_ = select(by_power_, T(0), log(select(by_power_, T(1), unit)));
    start_ = select(by_power_, power_, t2_), end_ = select(by_power_, t2_, power_);
  }

  T density() const {
    return integral([](const T& q, const T&) { return T(T(1) / q); });
  }
  T sf() const {
    return integral([this](const T& q, const T& r) { return arc<T>(t_, q, r).angle; });
  }
  T excess() const {
    return integral([this](const T& q, const T& r) { return arc<T>(t_, q, r).excess; });
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double log_most = single ? 6.9 : 9.2;  // of t^g, where exp(-t^g) is nothing

  template <class Kernel>
  T integral(const Kernel& kernel) const {
    const auto& rule = the_rule_of_powers;
    const auto coarse = power_ > T(0.1);
    const T count = select(coarse, T(double(rule_of_powers::nodes / 2)), T(double(rule_of_powers::nodes)));
    const T sum =
        accumulate(static_cast<int>(rule_of_powers::nodes), count, T(0), [&](const term<T>& i, const T& now) {
          const T log_variable = multiply_add(T(i.of(rule.log)), inverse_rise_, log_unit_);
          const T variable = maximum(T(exp(log_variable)), smallest<T>());
          const auto beyond = variable > start_;
          const T larger = select(beyond, variable, start_), smaller = select(beyond, start_, variable);
          const T growth = expm1(exponent_ * log1p(smaller / larger));
          const T base = select(beyond, T(exp(exponent_ * log_variable)), end_);
          const T other = multiply_add(base, growth, rounded(T(base - end_)));
          const T q2 = maximum(T(select(by_power_, other, variable)), smallest<T>()),
                  fall = select(by_power_, variable, other);
          const T r2 = t2_ + q2;
          // d(r^2) over the variable's change.
          const T stretch = select(by_power_, T(exponent_ * r2 / (start_ + variable)), T(1));
          const T mass = T(i.of(rule.weight)) * variable * stretch * exp(-fall);
          return T(now + mass * kernel(sqrt(q2), sqrt(r2)));
        });
    return times_exp_minus(T(norm_ * inverse_rise_ * (select(coarse, T(2), T(1)) * sum)),
                           double_double<T>(power_));
  }

  using mask = decltype(T() < T());
  T t_, t2_, power_;
  mask by_power_;
  T exponent_, norm_, inverse_rise_, log_unit_, start_, end_;
};

}  // namespace microfacet::detail
