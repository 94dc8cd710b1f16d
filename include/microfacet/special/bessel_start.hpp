// K_mu(2y) and its neighbours for |mu| <= 1/2, by polynomials of two variables (tools/derive_bessel.py).
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/special/bivariate.hpp"
#include "microfacet/special/coefficients/bessel.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::bessel {

using microfacet::select;

// 2 sqrt(y) exp(2y) times y K_{mu-1}(2y), K_mu(2y), y K_{mu+1}(2y).
template <class T>
struct start {
  T below, at, above;
};

template <class T, class Mask>
start<T> select(const Mask& mask, const start<T>& a, const start<T>& b) {
  return {select(mask, a.below, b.below), select(mask, a.at, b.at), select(mask, a.above, b.above)};
}

// Where the two forms of the start meet.
template <class T>
auto is_far(const T& y) {
  return y >= T(0.25);
}
template <class T>
T far_variable(const T& y) {
  const T root = T(2) * sqrt(y);
  return (T(3) - root) / (T(1) + root);
}

// For y <= 1/4, from I_{+-mu} and I_{+-(mu+1)}, split into parts even and odd in mu (N. M. Temme, J. Comput.
// Phys. 19, 1975); power = y^mu.
template <class T>
start<T> start_inside(const T& mu, const T& y, const T& power, const reciprocal_gamma<T>& gamma) {
  using namespace coefficients;
  const T w = y * y, v = mu * mu, u = w - T(1.0 / 32);
  const T f_even =
      gamma.even + w * polynomial(by_precision<T>(bessel_near_f_even_32, bessel_near_f_even_64), u, v);
  const T f_odd =
      gamma.odd + w * polynomial(by_precision<T>(bessel_near_f_odd_32, bessel_near_f_odd_64), u, v);
  const T g_even = polynomial(by_precision<T>(bessel_near_g_even_32, bessel_near_g_even_64), u, v);
  const T g_odd = polynomial(by_precision<T>(bessel_near_g_odd_32, bessel_near_g_odd_64), u, v);
  // sinh(mu log y)/mu and cosh(mu log y)
  const T log_y = log(y), x = mu * log_y, inverse = T(1) / power;
  const auto by_series = abs(x) < T(0.5);
  const T sinh = select(by_series, T(log_y * inverse * expm1_over(T(select(by_series, T(T(2) * x), T(0))))),
                        T(T(0.5) * (power - inverse) / select(by_series, T(1), mu)));
  const T cosh = T(0.5) * (power + inverse);
  const T common = w * (g_even * sinh + g_odd * cosh);
  // Gamma(1 + mu) Gamma(1 - mu) = pi mu/sin(pi mu)
  const T scale = T(2) * sqrt(y) * exp(T(2) * y) / (gamma.plus(mu) * gamma.minus(mu));
  return {scale * (T(0.5) * power * (f_even + mu * f_odd) + common), -scale * (f_even * sinh + f_odd * cosh),
          scale * (T(0.5) * inverse * (f_even - mu * f_odd) + common)};
}

// For y >= 1/4, from K_mu and its derivative.
template <class T>
start<T> start_outside(const T& mu, const T& y) {
  using namespace coefficients;
  const T t = far_variable(y), v = mu * mu;
  const T at = polynomial(by_precision<T>(bessel_far_32, bessel_far_64), t, v);
  const T slope = y * polynomial(by_precision<T>(bessel_far_slope_32, bessel_far_slope_64), t, v);
  const T half = T(0.5) * mu * at;
  return {slope - half, at, slope + half};
}

}  // namespace microfacet::bessel
