// The regularised incomplete Gamma functions of order c, 0 < c <= 10, without the factors that callers share:
//
//   P(c, z) = z^c exp(-z)/Gamma(c + 1) S(z)    by the series of S, all of whose terms are positive (DLMF 8.11.4)
//   Q(c, z) = z^c exp(-z)/Gamma(c)/X(z)        by Legendre's continued fraction (DLMF 8.9.2)
//
// each on its side of z = c + 1.5.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::incomplete_gamma {

inline constexpr double largest_order = 10;

// Gamma(c + 1), climbing from the order nearest 0.
template <class T>
T gamma_one_plus(const T& c) {
  const T steps = floor(T(c + T(0.5))), mu = c - steps;
  const T product = accumulate(static_cast<int>(largest_order), T(1), [&](const term<T>& j, const T& now) {
    const T n = T(j.plus(1));
    return T(now * select(n <= steps, T(mu + n), T(1)));
  });
  return product / reciprocal_gamma<T>(mu).plus(mu);
}

template <class T>
auto is_near(const T& c, const T& z) {
  return z < c + T(1.5);
}

namespace detail {
inline constexpr std::size_t terms = 46, levels = 40;
// 1/terms, ... 1/2, 1, and levels, ... 2, 1.
inline constexpr auto inverse_downwards = [] {
  std::array<double, terms> values{};
  for (std::size_t i = 0; i < terms; ++i) values[i] = 1.0 / static_cast<double>(terms - i);
  return values;
}();
inline constexpr auto downwards = [] {
  std::array<double, levels> values{};
  for (std::size_t i = 0; i < levels; ++i) values[i] = static_cast<double>(levels - i);
  return values;
}();
}  // namespace detail

// S = 1 + z/(c + 1) (1 + z/(c + 2) (1 + ...)) for z <= c + 1.5, as one quotient.
template <class T>
T series(const T& c, const T& z) {
  using sums = std::array<T, 2>;
  const auto [numerator, denominator] =
      accumulate(static_cast<int>(detail::terms), sums{T(1), T(1)}, [&](const term<T>& i, const sums& now) {
        const T inverse = T(i.of(detail::inverse_downwards)), below = now[1] * multiply_add(c, inverse, T(1));
        return sums{multiply_add(T(z * inverse), now[0], below), below};
      });
  return numerator / denominator;
}

// X = z + (1 - c) X1/(X1 + 1), X1 = z + (2 - c) X2/(X2 + 2), ... for z >= c + 1.5; the last X solves its limit
// X^2 = z X + z n.
template <class T>
T fraction(const T& c, const T& z) {
  const T last = T(0.5) * (z + sqrt(z * (z + T(4.0 * (detail::levels + 1)))));
  return accumulate(static_cast<int>(detail::levels), last, [&](const term<T>& i, const T& now) {
    const T n = T(i.of(detail::downwards));
    return T(z + (n - c) * now / (now + n));
  });
}

}  // namespace microfacet::incomplete_gamma
