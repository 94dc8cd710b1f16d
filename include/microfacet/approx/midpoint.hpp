// Gauss and Chebyshev's rule for integrands that are analytic but for square roots at both ends of an
// interval: the midpoint rule in theta, where c = sin^2(theta/2). It converges like rho^(-2n), rho being the
// sum of the semi-axes of the largest ellipse of analyticity about the interval [-1, 1] (Trefethen and
// Weideman, SIAM Review 56, 2014).
#pragma once

#include <array>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

inline constexpr int most_node_pairs = 240;  // of the longest interval that GTR has

// int_0^1 f(c) dc by 2 `pairs` nodes (each lane has its own number, 2 at least): pair(c, 1 - c) = f(c) + f(1
// - c).
template <class T, class Pair>
T integral_between_roots(const Pair& pair, const T& pairs) {
  // theta/2 starts at pi/(8 pairs) and advances by twice that: a rotation. Taylor's series for angles below
  // 0.2.
  const T first = T(pi / 8) / pairs, square_of_first = first * first;
  T sine(1), cosine(1);
  for (int n = 6; n > 0; --n) {
    sine = T(1) - sine * square_of_first * T(1.0 / (2 * n * (2 * n + 1)));
    cosine = T(1) - cosine * square_of_first * T(1.0 / (2 * n * (2 * n - 1)));
  }
  sine = sine * first;
  const T turn_sine = T(2) * sine * cosine, less = T(2) * sine * sine;  // 1 - cosine of the turn
  using states = std::array<T, 3>;
  const auto turn = [&](const term<T>&, const states& now) {
    const auto& [sum, s, c] = now;
    const T part = pair(T(s * s), T(c * c)) * (s * c), rise = c * turn_sine - s * less;
    return states{T(sum + part), T(s + rise), T(c - (c * less + s * turn_sine))};
  };
  return T(4) * first * accumulate(most_node_pairs, pairs, states{T(0), sine, cosine}, turn)[0];
}

}  // namespace microfacet
