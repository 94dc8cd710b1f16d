// Polynomials, and Chebyshev series by Clenshaw's recurrence.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/core/math.hpp"

namespace microfacet {

// Chooses the coefficients that suit the numbers of which a T is made.
template <class T, class Single, class Double>
constexpr const auto& by_precision(const Single& single, const Double& precise) {
  if constexpr (sizeof(typename scalar_traits<T>::real) == 4) {
    return single;
  } else {
    return precise;
  }
}

// sum_k c[k] T_k(x), x in [-1, 1], with c[0] taken whole.
template <class T, class Real, std::size_t N>
MICROFACET_INLINE T chebyshev(const std::array<Real, N>& c, const T& x) {
  const T x2 = x + x;
  T b0(0), b1(0);
  for (std::size_t k = N - 1; k > 0; --k) {
    const T b2 = b1;
    b1 = b0;
    b0 = multiply_add(x2, b1, T(T(c[k]) - b2));
  }
  return multiply_add(x, b0, T(T(c[0]) - b1));
}

// sum_{k >= First} c[k] x^(k - First).
template <std::size_t First = 0, class T, class Real, std::size_t N>
MICROFACET_INLINE T polynomial(const std::array<Real, N>& c, const T& x) {
  T sum = T(c[N - 1]);
  for (std::size_t k = N - 1; k > First; --k) sum = multiply_add(sum, x, T(c[k - 1]));
  return sum;
}

}  // namespace microfacet
