// Sums of Chebyshev series by Clenshaw's recurrence.
#pragma once

#include <array>
#include <cstddef>

namespace microfacet {

// sum_k c[k] T_k(x), x in [-1, 1], with c[0] taken whole.
template <class T, std::size_t N>
T chebyshev(const std::array<double, N>& c, const T& x) {
  const T x2 = x + x;
  T b0(0), b1(0);
  for (std::size_t k = N - 1; k > 0; --k) {
    const T b2 = b1;
    b1 = b0;
    b0 = x2 * b1 - b2 + T(c[k]);
  }
  return x * b0 - b1 + T(c[0]);
}

// sum_k c[k] x^k.
template <class T, std::size_t N>
T polynomial(const std::array<double, N>& c, const T& x) {
  T sum = T(c[N - 1]);
  for (std::size_t k = N - 1; k > 0; --k) sum = sum * x + T(c[k - 1]);
  return sum;
}

}  // namespace microfacet
