// Gauss and Legendre's rule on [-1, 1].
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/core/math.hpp"

namespace microfacet {

template <std::size_t N>
struct gauss_legendre {
  static constexpr std::size_t nodes = N;
  std::array<double, N> node, weight;

  // Newton's method on Legendre's polynomial, from Tricomi's approximation of its roots.
  gauss_legendre() {
    for (std::size_t j = 0; j < N; ++j) {
      const double n = N;
      double x = -std::cos(pi * (static_cast<double>(j) + 0.75) / (n + 0.5)), slope = 1;
      for (int i = 0; i < 8; ++i) {
        double before = 1, now = x;
        for (double k = 2; k <= n; ++k) {
          const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
          before = now, now = next;
        }
        slope = n * (before - x * now) / (1 - x * x);
        x -= now / slope;
      }
      node[j] = x, weight[j] = 2 / ((1 - x * x) * slope * slope);
    }
  }
};

}  // namespace microfacet
