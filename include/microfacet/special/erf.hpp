// Complementary error function and its integral, scaled by exp(x^2) so that the far tail keeps its relative
// accuracy: erfc(x) = exp(-x^2) erfc_scaled(x), ierfc(x) = exp(-x^2) ierfc_scaled(x), for x >= 0. Each is one
// rational function with positive coefficients: no term cancels.
#pragma once

#include <utility>

#include "microfacet/core/logarithms.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/special/coefficients/erfc_inverse.hpp"
#include "microfacet/special/coefficients/special.hpp"

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

// t with erfc(t)/2 = v, v in (0, 1). t^2 over l = -log(4v(1 - v)) is smooth in l, from pi/4 to 1; in double
// precision one step of Halley's method on the logarithm follows.
template <class T>
MICROFACET_INLINE T erfc_inverse_of_half(const T& v) {
  using namespace coefficients;
  const T rest = T(1) - v, less = minimum(v, rest), middle = T(1) - T(2) * less, one = T(1) - middle * middle;
  const auto tail = less < T(0.25);
  const T product = select(tail, T(T(4) * less * (T(1) - less)), one);
  const T low = select(tail, T(0), T((T(1) - one) - middle * middle));
  const T l = maximum(T(-log_double_double(double_double<T>(product, low)).high), T(0));
  T t = sqrt(l * polynomial(by_precision<T>(erfc_inverse_numerator_32, erfc_inverse_numerator_64), l) /
             polynomial(by_precision<T>(erfc_inverse_denominator_32, erfc_inverse_denominator_64), l));
  if constexpr (sizeof(typename scalar_traits<T>::real) == 8) {
    const T above = erfc_scaled(t);  // over 2/sqrt(pi) times the density
    const T r = log(T(0.5) * above / less) - t * t;
    t = t + r * above * T(0.5 * sqrt_pi) / (T(1) - r * (above * t * T(0.5 * sqrt_pi) - T(0.5)));
  }
  return select(v < rest, t, T(-t));
}

// t with t = v ierfc(t)/2, v > 0, for float32: to 5e-7. Infinity counts as the largest number.
template <class T>
MICROFACET_INLINE T ierfc_quotient_inverse(const T& v) {
  using namespace coefficients;
  const T l = log1p(minimum(v, largest<T>()));
  return l * polynomial(ierfc_inverse_numerator_32, l) / polynomial(ierfc_inverse_denominator_32, l);
}

}  // namespace microfacet
