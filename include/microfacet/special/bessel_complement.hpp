// 1 - h_a(y)/Gamma(a) (special/bessel.hpp) with full relative accuracy for small y.
#pragma once

#include <array>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/bessel.hpp"

namespace microfacet::bessel {

// For large a and y^2 < a, where the terms of the other solution are far below rounding: sum of
// -(-y^2)^k/(k! (a - 1)...(a - k)) over k >= 1 (DLMF 10.25.2, 10.27.4).
template <class T>
T complement_of_large_order(const T& a, const T& y) {
  using sums = std::array<T, 2>;
  return accumulate(18, sums{T(0), T(-1)}, [&](const term<T>& n, const sums& now) {
    const T k = T(n.plus(1)), next = now[1] * (-y * y) / (k * (a - k));
    return sums{T(now[0] + next), next};
  })[0];
}

// It falls from order to order by y^2 h_{a-1}/Gamma(a + 1), so that positive terms lead to a large one. `k`
// are the neighbours of a at y.
template <class T>
T complement(const T& a, const T& y, const neighbours<T>& k) {
  constexpr int large = 30;
  const T steps = floor(maximum(T(T(large + 1) - a), T(0)));
  using rung = std::array<T, 4>;
  const rung from{T(0), k.below, k.at, k.above};
  const T sum = accumulate(large + 1, steps, from, [&](const term<T>& j, const rung& now) {
    const auto& [before, below, at, above] = now;
    const T order = a + T(j.plus(1)), lower = y * (y * at) / order;
    return rung{T(before + below), lower, above, T((order * above + lower) / (order + T(1)))};
  })[0];
  const T order = a + steps, scale = square(k.decay);
  const auto by_series = y * y < order;
  const T rest = complement_of_large_order(order, T(select(by_series, y, T(1))));
  return select(by_series, T(scale * sum + rest), T(T(1) - scale * (a * k.at)));
}

}  // namespace microfacet::bessel
