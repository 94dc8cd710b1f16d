// What the lanes of a batch are compared by.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "microfacet/core/elementary.hpp"

namespace lanes {

// To the accuracy contract in double, to a few roundings of the exponents in float; nan, infinity and zero
// alike.
template <class T>
bool near(T a, T b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  const T most = std::numeric_limits<T>::max(), least = sizeof(T) == 4 ? T(1e-30) : T(1e-300);
  if (std::abs(b) < least) return std::abs(a) < 2 * least;
  return a == b ||
         (std::abs(b) < most && std::abs(a - b) <= (sizeof(T) == 4 ? T(2e-5) : T(1e-13)) * std::abs(b));
}

template <class T>
bool same_bits(T a, T b) {
  return std::isnan(a) ? std::isnan(b) : microfacet::elementary::bits(a) == microfacet::elementary::bits(b);
}

// Arguments for all lanes, turned so that every value meets every other one in some batch.
template <class Batch, class T>
Batch deal(const std::vector<T>& values, std::size_t first) {
  Batch b(T(0));
  for (int i = 0; i < Batch::size; ++i)
    b.set(i, values[(first + static_cast<std::size_t>(i) * (1 + first / values.size())) % values.size()]);
  return b;
}

}  // namespace lanes
