// Integrals against exp(-s), of functions that decide on the way where they vary: f is analytic in log s for |Im log s|
// < pi, as functions of s + y are for any y > 0.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

namespace detail {

// The trapezoidal rule in v, s = exp(v - exp(-v)/2), from s = 1e-34 to 42.
template <bool single>
struct exponential_rule {
  static constexpr std::size_t size = single ? 29 : 57;
  std::array<double, size> node{}, weight{};

  exponential_rule() {
    constexpr double first = -5, step = (single ? 2 : 1) * 0x5p-5;
    for (std::size_t i = 0; i < size; ++i) {
      const double v = first + step * static_cast<double>(i), bend = 0.5 * std::exp(-v);
      node[i] = std::exp(v - bend), weight[i] = step * node[i] * (1 + bend) * std::exp(-node[i]);
    }
  }
};
template <bool single>
inline const exponential_rule<single> the_exponential_rule;

}  // namespace detail

// int_0^inf exp(-s) f(s) ds for positive f, to a few roundings (4e-9 in float). f may be singular at s = 0 like s^(-1/2),
// and at s = -y, y >= 1/16.
template <class T, class Function>
T exponential_mean(const Function& f) {
  const auto& rule = detail::the_exponential_rule<sizeof(typename scalar_traits<T>::real) == 4>;
  return accumulate(static_cast<int>(rule.size), T(0), [&](const term<T>& i, const T& sum) {
    return T(sum + T(i.of(rule.weight)) * f(T(i.of(rule.node))));
  });
}

}  // namespace microfacet
