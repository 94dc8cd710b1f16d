// Complementary error function and its integral, scaled by exp(x^2) so that the far tail keeps its relative
// accuracy: erfc(x) = exp(-x^2) erfc_scaled(x), ierfc(x) = exp(-x^2) ierfc_scaled(x), for x >= 0.
#pragma once

#include "microfacet/core/chebyshev.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/coefficients.hpp"

namespace microfacet {

namespace detail {
// The half line x >= 0 on [-1, 1], as (x - k)/(x + k) = 1 - 2 k/(x + k), which is 1 at infinity.
template <class T>
T half_line(const T& x) {
  const T k(3.75);
  return T(1) - (k + k) / (x + k);
}
}  // namespace detail

template <class T>
T erfc_scaled(const T& x) {
  return chebyshev(coefficients::erfc_scaled, detail::half_line(x)) / (T(1) + T(2) * x);
}

// exp(x^2) int_x^inf erfc(t) dt.
template <class T>
T ierfc_scaled(const T& x) {
  const T w = T(1) / (T(1) + T(2) * x);
  return chebyshev(coefficients::ierfc_scaled, detail::half_line(x)) * w * w;
}

}  // namespace microfacet
