// Complementary error function and its integral, scaled by exp(x^2) so that the far tail keeps its relative
// accuracy: erfc(x) = exp(-x^2) erfc_scaled(x), ierfc(x) = exp(-x^2) ierfc_scaled(x), for x >= 0. Each is one
// rational function with positive coefficients: no term cancels.
#pragma once

#include <utility>

#include "microfacet/core/chebyshev.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/coefficients.hpp"

namespace microfacet {

namespace detail {
// Beyond it exp(-x^2) is zero, and the powers of x stay finite.
template <class T>
T where_erfc_lives(const T& x) {
  return minimum(x, T(sizeof(typename scalar_traits<T>::real) == 4 ? 10 : 28));
}
}  // namespace detail

template <class T>
MICROFACET_INLINE T erfc_scaled(const T& x_argument) {
  using namespace coefficients;
  const T x = detail::where_erfc_lives(x_argument);
  return polynomial(by_precision<T>(erfc_numerator_32, erfc_numerator_64), x) /
         polynomial(by_precision<T>(erfc_denominator_32, erfc_denominator_64), x);
}

// exp(x^2) int_x^inf erfc(t) dt, as numerator and denominator.
template <class T>
MICROFACET_INLINE std::pair<T, T> ierfc_scaled_fraction(const T& x_argument) {
  using namespace coefficients;
  const T x = detail::where_erfc_lives(x_argument);
  return {polynomial(by_precision<T>(ierfc_numerator_32, ierfc_numerator_64), x),
          polynomial(by_precision<T>(ierfc_denominator_32, ierfc_denominator_64), x)};
}
template <class T>
MICROFACET_INLINE T ierfc_scaled(const T& x) {
  const auto [numerator, denominator] = ierfc_scaled_fraction(x);
  return numerator / denominator;
}

}  // namespace microfacet
