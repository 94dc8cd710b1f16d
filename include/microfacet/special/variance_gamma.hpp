// Tails of the one-dimensional variance-gamma density P2(t) = 2 |t|^nu K_nu(2|t|)/(sqrt(pi) Gamma(a)),
// nu = a - 1/2: a Gaussian whose variance m/2 has m distributed as Gamma(a, 1).
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/special/bessel.hpp"
#include "microfacet/special/erf.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::variance_gamma {

using microfacet::select;

template <class T>
struct tail_pair {
  T sf, excess;  // int_t^inf P2, int_t^inf (y - t) P2(y) dy
};

template <class T, class Mask>
tail_pair<T> select(const Mask& mask, const tail_pair<T>& a, const tail_pair<T>& b) {
  return {select(mask, a.sf, b.sf), select(mask, a.excess, b.excess)};
}

// P2(t) from the orders nu - 1, nu, nu + 1 at t.
template <class T>
T density(const T& a, const bessel::neighbours<T>& k) {
  return exp(bessel::log_unscaled(T(gamma_half_step(a) * sqrt(a) / T(sqrt_pi) * k.at), k.exponent));
}

// Where the mixture integral takes over from the closed form.
template <class T>
auto in_tail(const T& a, const T& t) {
  return t * t > T(0.49) * a;
}

// Closed form for the centre: 1/2 - sf = t (K_nu L_{nu-1} + L_nu K_{nu-1})(2t) with modified Struve functions
// L (DLMF 10.43.2), in which every term is positive; excess = int_t^inf y P2 - t sf, the first of these in
// K_{nu+1}.
template <class T>
tail_pair<T> centre(const T& a, const T& t, const bessel::neighbours<T>& k) {
  const T t2 = t * t;
  T lower_term(1), upper_term(1), lower(1), upper(1);
  for (int n = 0; n < 60; ++n) {
    const T factor = t2 / T(n + 1.5);
    lower_term = lower_term * (factor / (a + T(n)));
    upper_term = upper_term * (factor / (a + T(n + 1)));
    const T next_lower = lower + lower_term, next_upper = upper + upper_term;
    if (!any((next_lower != lower) | (next_upper != upper))) break;
    lower = next_lower, upper = next_upper;
  }
  const T scale = exp(k.exponent) * gamma_half_step(a) * sqrt(a) / T(sqrt_pi);
  const T sf = T(0.5) - scale * t * (k.at * lower + k.below * upper / a);
  return {sf, T(0.5) * scale * (a + T(0.5)) * k.above - t * sf};
}

// For the tail: averages of Beckmann's tails over the mixing variable m = m0 e^tau, relative to the same
// average of Beckmann's density, by the trapezoidal rule round the peak m0 of the weight.
template <class T>
tail_pair<T> tail(const T& a, const T& density, const T& t) {
  constexpr int most = 400;
  const T curvature = sqrt(a * a + T(4) * t * t), peak = T(0.5) * (a + curvature);
  const T spread = t * t / peak, root = sqrt(peak);
  const T step = minimum(T(0.2), T(T(0.5) / sqrt(curvature)));
  T sum_density(0), sum_sf(0), sum_excess(0);
  for (const double sign : {1.0, -1.0}) {
    for (int j = sign > 0 ? 0 : 1; j < most; ++j) {
      const T tau = T(sign * j) * step;
      const T exponent = -peak * expm1_less(tau) - spread * expm1_less(T(-tau));
      const auto counts = exponent > T(-42);
      if (!any(counts)) break;
      const T weight = select(counts, exp(maximum(exponent, T(-80))), T(0));
      const T sigma = root * exp(T(0.5) * tau), x = t / sigma;
      sum_density = sum_density + weight / sigma;
      sum_sf = sum_sf + weight * erfc_scaled(x);
      sum_excess = sum_excess + weight * sigma * ierfc_scaled(x);
    }
  }
  const T scale = density * T(0.5 * sqrt_pi) / sum_density;
  return {scale * sum_sf, scale * sum_excess};
}

template <class T>
tail_pair<T> tails(const T& a, const T& t) {
  const bessel::neighbours<T> k = bessel::orders(T(a - T(0.5)), t);
  const auto far = in_tail(a, t);
  return choose(
      far, [&] { return tail(a, density(a, k), T(select(far, t, sqrt(a)))); },
      [&] { return centre(a, T(select(far, T(T(0.1) * sqrt(a)), t)), k); });
}

}  // namespace microfacet::variance_gamma
