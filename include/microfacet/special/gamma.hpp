// Ratios of Gamma functions that stay accurate to rounding where the functions themselves overflow.
#pragma once

#include <array>

#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/special/coefficients/special.hpp"
#include "microfacet/special/coefficients/student.hpp"

namespace microfacet {

// 1/Gamma(1 + mu) for |mu| <= 1/2 as even + odd: its two parts serve Temme's K_nu without cancellation.
template <class T>
struct reciprocal_gamma {
  T even, odd;  // 1/Gamma(1 + mu) = even + mu odd, 1/Gamma(1 - mu) = even - mu odd

  explicit reciprocal_gamma(const T& mu)
      : even(polynomial(coefficients::reciprocal_gamma_even, T(mu * mu))),
        odd(polynomial(coefficients::reciprocal_gamma_odd, T(mu * mu))) {}
  T plus(const T& mu) const { return multiply_add(mu, odd, even); }
  T minus(const T& mu) const { return multiply_add(-mu, odd, even); }
};

// Gamma(k + 1/2)/(Gamma(k) sqrt(k)), which tends to 1 for large k: of 1/k where k >= half_step_shift, and of
// any k > 0 from k + half_step_shift down the recurrence.
inline constexpr int half_step_shift = 10;

template <class T>
T half_step_of_large(const T& inverse_k) {
  return polynomial(by_precision<T>(coefficients::gamma_half_step_32, coefficients::gamma_half_step_64),
                    inverse_k);
}

template <class T>
T gamma_half_step(const T& k) {
  // The factors k + i and k + i + 1/2 over k + shift, so that no product over- or underflows.
  const T inverse = T(1) / (k + T(half_step_shift)), first = k * inverse;
  T numerator(1), denominator = (k + T(0.5)) * inverse;
  for (int i = 1; i < half_step_shift; ++i) {
    numerator = numerator * ((k + T(i)) * inverse);
    denominator = denominator * ((k + T(i + 0.5)) * inverse);
  }
  return half_step_of_large(inverse) * numerator * sqrt(first) / denominator;
}

namespace detail {
// log Gamma(x) - (x - 1/2) log(x) + x - log(2 pi)/2 for x >= 10 (float32: 3): Stirling's series.
template <class T>
T stirling_remainder(const T& x) {
  constexpr std::array<double, 4> few{1.0 / 12, -1.0 / 360, 1.0 / 1260, -1.0 / 1680};
  constexpr std::array<double, 7> series{1.0 / 12,   -1.0 / 360,      1.0 / 1260, -1.0 / 1680,
                                         1.0 / 1188, -691.0 / 360360, 1.0 / 156};
  return polynomial(by_precision<T>(few, series), T(T(1) / (x * x))) / x;
}
}  // namespace detail

// Euler's Beta function B(1 + a, 1 + b) for a, b >= 0, also where one of them is huge, up to 1e30: Stirling's
// formula for p + n, q + n with its large terms cancelled by hand, and the recurrence back to p, q.
template <class T>
T beta_one_plus(const T& a, const T& b) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  constexpr int shift = single ? 2 : 9, together = single ? 1 : 3;  // factors whose product stays finite
  T p = T(1) + maximum(a, b), q = T(1) + minimum(a, b), sum = p + q, log_ratio(0);
  for (int first = 0; first < shift; first += together) {
    T ratio(1);
    for (int i = first; i < first + together; ++i)
      ratio = ratio * (((sum + T(2 * i)) / (p + T(i))) * ((sum + T(2 * i + 1)) / (q + T(i))));
    log_ratio = log_ratio + log(ratio);
  }
  p = p + T(shift), q = q + T(shift), sum = p + q;
  const T remainder =
      detail::stirling_remainder(p) + detail::stirling_remainder(q) - detail::stirling_remainder(sum);
  return exp(log_ratio + T(0.91893853320467274178) - (p - T(0.5)) * log1p(q / p) + q * log(q / sum) -
             T(0.5) * log(q) + remainder);
}

}  // namespace microfacet
