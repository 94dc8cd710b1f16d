// Gauss and Chebyshev's rule for integrands that are analytic but for square roots at both ends of an
// interval: the midpoint rule in theta, where c = sin^2(theta/2). It converges like rho^(-2n), rho being the
// sum of the semi-axes of the largest ellipse of analyticity about the interval [-1, 1] (Trefethen and
// Weideman, SIAM Review 56, 2014).
#pragma once

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
  T sum(0);
  for (int j = 0; j < most_node_pairs; ++j) {
    const auto inside = T(j) < pairs;
    if (!any_lane(inside)) break;
    const T term = pair(T(sine * sine), T(cosine * cosine)) * (sine * cosine);
    sum = select(inside, T(sum + term), sum);
    const T rise = cosine * turn_sine - sine * less;
    cosine = cosine - (cosine * less + sine * turn_sine), sine = sine + rise;
  }
  return T(4) * first * sum;
}

}  // namespace microfacet
