// Modified Bessel functions of the second kind of real order, in the form in which slopes need them.
//
//   h_nu(y) = 2 y^nu K_nu(2y) = int_0^inf m^(nu-1) exp(-m - y^2/m) dm
//
// is finite at y = 0 for nu > 0 (where it is Gamma(nu)) and obeys h_{nu+1} = nu h_nu + y^2 h_{nu-1}, all of
// whose terms are positive: three neighbouring orders, divided by Gamma(nu + 1), climb from |mu| <= 1/2
// without overflow or loss; from order 500 on they are Debye's expansion. Values come with a common exponent.
#pragma once

#include <cstddef>

#include "microfacet/core/chebyshev.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/coefficients.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::bessel {

using microfacet::select;

template <class T>
struct neighbours {  // times exp(exponent), which only the complement does without
  T below;           // y^2 h_{nu-1}/Gamma(nu + 1)
  T at;              // h_nu/Gamma(nu + 1)
  T above;           // h_{nu+1}/Gamma(nu + 2)
  T exponent;
  T complement_above;  // 1 - h_{nu+1}/Gamma(nu + 1), without cancellation for small y
};

template <class T>
struct start {
  neighbours<T> orders;
  T complement_second;  // 1 - h_{mu+2}/Gamma(mu + 2)
};

template <class T, class Mask>
neighbours<T> select(const Mask& mask, const neighbours<T>& a, const neighbours<T>& b) {
  return {select(mask, a.below, b.below), select(mask, a.at, b.at), select(mask, a.above, b.above),
          select(mask, a.exponent, b.exponent), select(mask, a.complement_above, b.complement_above)};
}

template <class T, class Mask>
start<T> select(const Mask& mask, const start<T>& a, const start<T>& b) {
  return {select(mask, a.orders, b.orders), select(mask, a.complement_second, b.complement_second)};
}

// Orders mu - 1, mu, mu + 1 for |mu| <= 1/2 and y <= 1: N. M. Temme, J. Comput. Phys. 19 (1975), multiplied
// by y^mu so that nothing overflows for small y.
template <class T>
start<T> temme(const T& mu, const T& y) {
  const reciprocal_gamma<T> rg(mu);
  const T plus = rg.even + mu * rg.odd, minus = rg.even - mu * rg.odd;  // 1/Gamma(1 +- mu)
  const T log_y = log(y), y2 = y * y;
  const T power = exp(T(2) * mu * log_y);  // y^(2 mu)
  T f = (T(-0.5) * rg.odd * (T(1) + power) - rg.even * log_y * expm1_over(T(T(2) * mu * log_y))) /
        (plus * minus);
  T p = T(0.5) / plus, q = T(0.5) * power / minus;
  const T p0 = p;
  // The terms of 1 - h_{mu+2}/Gamma(mu + 2), of which the first is y^2 p0/(1 + mu) since mu f = p - q
  // throughout.
  T second = y2 * p0 / (T(1) + mu);
  T c(1), sum = f, above(0), below = q;
  // A fixed number of terms, so that no lane depends on another: the last is below 1/(13!)^2.
  for (int i = 1; i <= 13; ++i) {
    const T f_before = f;
    f = (T(i) * f + p + q) / (T(i) * T(i) - mu * mu);
    p = p / (T(i) - mu);
    q = q / (T(i) + mu);
    c = c * y2 / T(i);
    if (i > 1) second = second + c * (T(i) * (f - f_before / (T(1) + mu)) - p);
    sum = sum + c * f;
    above = above + c * (p - T(i) * f);
    below = below + c * (q - T(i) * f);
  }
  const T scale = T(2) * exp(T(2) * y) * plus;
  return {{scale * below, scale * sum, scale * (p0 + above) / (T(1) + mu), T(-2) * y, -above / p0},
          second / p0};
}

// The same for y > 1, by the trapezoidal rule on K_mu(z) = int_0^inf exp(-z cosh t) cosh(mu t) dt in the
// variable s = sqrt(2z) sinh(t/2), in which the weight is exp(-s^2); the nearest singularity is at s = i
// sqrt(2z).
template <class T>
start<T> trapezoid(const T& mu, const T& y) {
  constexpr int nodes = 24;
  const T step = T(0.27);
  const T z = T(2) * y, root = sqrt(T(2) * z);
  T below(0), at(0), above(0);
  for (int j = 0; j < nodes; ++j) {
    const T s = step * T(j), w = s / root, cosh_half = sqrt(T(1) + w * w);
    const T half_t = log1p(T(w + w * w / (T(1) + cosh_half)));  // t/2 = asinh(w)
    const T weight = exp(-s * s) / (root * cosh_half) * T(j == 0 ? 0.5 : 1.0);
    const T g = exp(T(2) * mu * half_t), e = square(T(w + cosh_half));  // exp(mu t), exp(t)
    at = at + weight * (g + T(1) / g);
    above = above + weight * (g * e + T(1) / (g * e));
    below = below + weight * (e / g + g / e);
  }
  const reciprocal_gamma<T> rg(mu);
  const T plus = rg.even + mu * rg.odd;
  const T scale = T(2) * step * exp(mu * log(y)) * plus;
  const T above_gamma = scale * y * above;  // over Gamma(mu + 1)
  const T first = T(1) - exp(-z) * above_gamma;
  return {{scale * y * below, scale * at, above_gamma / (T(1) + mu), -z, first},
          first - exp(-z) * y * y * scale * at / (T(1) + mu)};
}

// Where Debye's expansion, of which the first term left out is 6 orders smaller, is good to rounding.
inline constexpr double large_order = 500;

// The smallest y that is told from 0: 1/y, the size of h_{-1/2}, must stay finite.
template <class T>
T least_argument() {
  return T(64) * smallest<T>();
}

// Orders below `large_order`: up the recurrence, one step for each unit of nu.
template <class T>
neighbours<T> climb(const T& nu, const T& y) {
  const T steps = floor(T(nu + T(0.5))), mu = nu - steps;
  const auto small = y <= T(1);
  const start<T> first = choose(
      small, [&] { return temme(mu, T(select(small, y, T(1)))); },
      [&] { return trapezoid(mu, T(select(small, T(1), y))); });
  neighbours<T> k = first.orders;
  const T unscale = exp(k.exponent);
  for (int j = 0; j <= static_cast<int>(large_order); ++j) {
    const auto climbing = T(j) < steps;
    if (!any(climbing)) break;
    const T order = mu + T(j);
    const T lower = y * (y * k.at) / (order + T(1));  // y^2 alone may underflow where y^2 h does not
    const T upper = ((order + T(1)) * k.above + lower) / (order + T(2));
    const T complement = j == 0 ? first.complement_second : T(k.complement_above - unscale * lower);
    k = select(climbing, neighbours<T>{lower, k.above, upper, k.exponent, complement}, k);
  }
  return k;
}

// Large orders: Debye's expansions of K_m and its derivative at m = nu - 1 (DLMF 10.41.4 and 10.41.6), with
// z = 2y/m; the Gamma function and the exponential cancel into exponent and Stirling's series.
template <class T>
neighbours<T> debye(const T& nu, const T& y) {
  const T m = nu - T(1), z = T(2) * y / m, root = sqrt(T(1) + z * z), p = T(1) / root;
  T u(0), v(0);
  for (std::size_t k = coefficients::debye_u.size(); k-- > 0;) {
    u = u * (-p / m) + polynomial(coefficients::debye_u[k], T(p * p));
    v = v * (-p / m) + polynomial(coefficients::debye_v[k], T(p * p));
  }
  const T rise = z * z / (T(1) + root);  // root - 1
  const T exponent = -m * (rise - log1p(T(0.5) * rise));
  const T stirling = exp((T(1) / (T(30) * m * m) - T(1)) / (T(12) * m));
  const T before = u * stirling / (m * sqrt(root));  // h_m/Gamma(m + 1)
  const T at = before * (m / (T(2) * nu)) * (T(1) + root * v / u), below = y * (y * before) / nu;
  const T above = (nu * at + below) / (nu + T(1));
  return {below, at, above, exponent, T(1) - exp(exponent) * (nu + T(1)) * above};
}

// h_nu and its neighbours for nu >= -1/2 and y >= 0, which counts as at least least_argument.
template <class T>
neighbours<T> orders(const T& nu, const T& y_argument) {
  const T y = maximum(y_argument, least_argument<T>());
  const auto large = nu >= T(large_order);
  return choose(
      large, [&] { return debye(T(select(large, nu, T(large_order))), y); },
      [&] { return climb(T(select(large, T(0), nu)), y); });
}

// 1 - h_a/Gamma(a) for a > 20 and y^2 < a, where the terms of the other solution are far below rounding: sum
// of -(-y^2)^k/(k! (a - 1)...(a - k)) over k >= 1 (DLMF 10.25.2, 10.27.4). The recurrence loses a factor of
// a.
template <class T>
T complement_of_large_order(const T& a, const T& y) {
  T term(-1), sum(0);
  for (int k = 1; k <= 18; ++k) {
    term = term * (-y * y) / (T(k) * (a - T(k)));
    sum = sum + term;
  }
  return sum;
}

// log(value exp(exponent)), which underflows only if the result does. A value that overflowed belongs to a
// result below exp(-700) for every order that climbs.
template <class T>
T log_unscaled(const T& value, const T& exponent) {
  return select(value == T(inf), T(-inf), T(log(value) + exponent));
}

}  // namespace microfacet::bessel
