// 1 - h_a(y)/Gamma(a) (special/bessel.hpp) with full relative accuracy for small y.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/special/bessel.hpp"

namespace microfacet::bessel {

// For large a and y^2 < a, where the terms of the other solution are far below rounding: sum of
// -(-y^2)^k/(k! (a - 1)...(a - k)) over k >= 1 (DLMF 10.25.2, 10.27.4).
template <class T>
T complement_of_large_order(const T& a, const T& y) {
  T term(-1), sum(0);
  for (int k = 1; k <= 18; ++k) {
    term = term * (-y * y) / (T(k) * (a - T(k)));
    sum = sum + term;
  }
  return sum;
}

// It falls from order to order by y^2 h_{a-1}/Gamma(a + 1), so that positive terms lead to a large one. `k`
// are the neighbours of a at y.
template <class T>
T complement(const T& a, const T& y, const neighbours<T>& k) {
  constexpr int large = 30;
  const T steps = floor(maximum(T(T(large + 1) - a), T(0)));
  T below = k.below, at = k.at, above = k.above, sum(0);
  for (int j = 0; j <= large; ++j) {
    const auto climbing = T(j) < steps;
    if (!any_lane(climbing)) break;
    const T order = a + T(j + 1), lower = y * (y * at) / order;
    const T upper = (order * above + lower) / (order + T(1));
    sum = select(climbing, T(sum + below), sum), below = select(climbing, lower, below);
    at = select(climbing, above, at), above = select(climbing, upper, above);
  }
  const T order = a + steps, scale = square(k.decay);
  const auto by_series = y * y < order;
  const T rest = complement_of_large_order(order, T(select(by_series, y, T(1))));
  return select(by_series, T(scale * sum + rest), T(T(1) - scale * (a * k.at)));
}

}  // namespace microfacet::bessel
