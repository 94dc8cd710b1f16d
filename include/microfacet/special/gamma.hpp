// Ratios of Gamma functions that stay accurate to rounding where the functions themselves overflow.
#pragma once

#include <array>

#include "microfacet/core/chebyshev.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/coefficients.hpp"

namespace microfacet {

// 1/Gamma(1 + mu) for |mu| <= 1/2 as even + odd: its two parts serve Temme's K_nu without cancellation.
template <class T>
struct reciprocal_gamma {
  T even, odd;  // 1/Gamma(1 + mu) = even + mu odd, 1/Gamma(1 - mu) = even - mu odd

  explicit reciprocal_gamma(const T& mu)
      : even(polynomial(coefficients::reciprocal_gamma_even, T(mu * mu))),
        odd(polynomial(coefficients::reciprocal_gamma_odd, T(mu * mu))) {}
};

// Gamma(k + 1/2)/(Gamma(k) sqrt(k)), which tends to 1 for large k; k > 0.
// Shifted up by n, where the expansion in 1/(k - 1/4)^2 (Tricomi and Erdelyi 1951) holds to rounding.
template <class T>
T gamma_half_step(const T& k) {
  constexpr int shift = 12;
  constexpr std::array<double, 7> series{1.0,
                                         1.0 / 64,
                                         -19.0 / 8192,
                                         631.0 / 524288,
                                         -174317.0 / 134217728,
                                         20491783.0 / 8589934592.0,
                                         -7334801895.0 / 1099511627776.0};
  T numerator(1), denominator(1);
  for (int i = 0; i < shift; ++i) {
    // (k + i)/(k + i + 1/2), with both products scaled so that they neither overflow nor underflow.
    const T scale = T(1) / (k + T(shift));
    numerator = numerator * ((k + T(i)) * scale);
    denominator = denominator * ((k + T(i + 0.5)) * scale);
  }
  const T w = k + T(shift - 0.25);
  return numerator / denominator * polynomial(series, T(T(1) / (w * w))) * sqrt(w / k);
}

namespace detail {
// log Gamma(x) - (x - 1/2) log(x) + x - log(2 pi)/2 for x >= 10: Stirling's series.
template <class T>
T stirling_remainder(const T& x) {
  constexpr std::array<double, 7> series{1.0 / 12,   -1.0 / 360,      1.0 / 1260, -1.0 / 1680,
                                         1.0 / 1188, -691.0 / 360360, 1.0 / 156};
  return polynomial(series, T(T(1) / (x * x))) / x;
}
}  // namespace detail

// Euler's Beta function B(1 + a, 1 + b) for a, b >= 0, also where one of them is huge: Stirling's formula for
// p + n, q + n with its large terms cancelled by hand, and the recurrence back to p, q.
template <class T>
T beta_one_plus(const T& a, const T& b) {
  constexpr int shift = 9;
  T p = T(1) + maximum(a, b), q = T(1) + minimum(a, b), sum = p + q, log_ratio(0);
  for (int i = 0; i < shift; ++i) {
    log_ratio = log_ratio + log(((sum + T(2 * i)) / (p + T(i))) * ((sum + T(2 * i + 1)) / (q + T(i))));
  }
  p = p + T(shift), q = q + T(shift), sum = p + q;
  const T remainder =
      detail::stirling_remainder(p) + detail::stirling_remainder(q) - detail::stirling_remainder(sum);
  return exp(log_ratio + T(0.91893853320467274178) - (p - T(0.5)) * log1p(q / p) + q * log(q / sum) -
             T(0.5) * log(q) + remainder);
}

}  // namespace microfacet
