// The one-dimensional variance-gamma density P2(t) = 2 |t|^nu K_nu(2|t|)/(sqrt(pi) Gamma(a)), nu = a - 1/2,
// and its tails: a Gaussian whose variance m/2 has m distributed as Gamma(a, 1).
//
// The tails climb with the density from 0 < a <= 1, by positive terms (P2'_{a+1} = -2t P2_a/a, and P2_{a+1} -
// P2_a = P2''_{a+1}/4 integrated twice):
//
//   sf_{a+1} = sf_a + t P2_a/(2a),   excess_{a+1} = excess_a + P2_{a+1}/4
#pragma once

#include <array>
#include <type_traits>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/special/bessel.hpp"
#include "microfacet/special/coefficients/variance_gamma_excess.hpp"
#include "microfacet/special/coefficients/variance_gamma_tail.hpp"
#include "microfacet/special/erf.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::variance_gamma {

// P2(t) for t > 0.
template <class T>
T density(const T& a, const double_double<T>& t) {
  const bessel::neighbours<T> k = bessel::orders(T(a - T(0.5)), t);
  return T(1 / sqrt_pi) * gamma_half_step(a) * sqrt(a) * k.at * k.decay * k.decay;
}

namespace detail {

// sum_n w^n/((5/2)_n (b)_n) for w <= 1/16.
template <class T>
T centre_series(const T& w, const T& b) {
  T numerator(1), denominator(1);
  for (int n = 5; n >= 0; --n) {
    denominator = denominator * (b + T(n));
    numerator = multiply_add(T(w * T(1 / (n + 2.5))), numerator, denominator);
  }
  return numerator / denominator;
}

// Pr(slope > t) for t <= 1/4 and a <= 1/8, where it may be far below 1/2: 1/2 less both power series of the
// density (DLMF 10.27.4, 10.25.2) integrated, the leading term of one of which is exp(a G(a)) t^(2a)/2.
template <class T>
T tail_of_small_order(const T& a, const T& t) {
  using namespace coefficients;
  const T g = polynomial(by_precision<T>(variance_gamma_centre_32, variance_gamma_centre_64), a);
  const T lost = T(-0.5) * expm1(a * (g + T(2) * log(t))), w = t * t;  // 1/2 less that term
  // sum_n a/(a + n) w^n/(n! (a + 1/2)_n) and sum_n w^n/((2n + 1) n! (3/2 - a)_n), n >= 1
  T even(0), even_denominator(1), odd(0), odd_denominator(1);
  for (int n = 7; n > 0; --n) {
    even = w * multiply_add(a + T(n), even, T(a * even_denominator));
    even_denominator = even_denominator * (T(n) * (T(n - 0.5) + a) * (T(n) + a));
    odd = w * multiply_add(T(1.0 / (2 * n + 1)), odd_denominator, odd);
    odd_denominator = odd_denominator * (T(n) * (T(n + 0.5) - a));
  }
  const T rise = T(1 / sqrt_pi) * gamma_half_step(a) * sqrt(a) / (T(0.5) - a);
  return lost - (T(0.5) - lost) * (even / even_denominator) + t * rise * (T(1) + odd / odd_denominator);
}

// 1/sqrt(pi) over Gamma(a) and Gamma(a + 1), 0 < a <= 1.
template <class T>
struct inverse_gammas {
  T at, above;

  explicit inverse_gammas(const T& a) {
    const auto low = a <= T(0.5);
    const T mu = select(low, a, T(a - T(1)));
    const T value = T(1 / sqrt_pi) * reciprocal_gamma<T>(mu).plus(mu);
    at = select(low, T(a * value), value), above = select(low, value, T(value / a));
  }
};

// Each tail over exp(-2t), 0 < a <= 1: for t >= 1/4 (over t^(a-1), too), for t <= 1/4, and what a step up
// adds, from rungs times gamma.at/4.
template <class T>
struct sf {
  static T outer(const T& t, const T& mu, const inverse_gammas<T>& gamma) {
    using namespace coefficients;
    return T(sqrt_pi) * gamma.at *
           polynomial(by_precision<T>(variance_gamma_tail_32, variance_gamma_tail_64), t, mu);
  }
  // 1/2 less the closed form t (K_mu L_{mu-1} + L_mu K_{mu-1})(2t), mu = a - 1/2, with modified Struve
  // functions L (DLMF 10.43.2), in which every term is positive.
  static T inner(const T& a, const T& t, const bessel::ladder<T>& k, const inverse_gammas<T>& gamma,
                 const T& decay) {
    const auto of_small_order = a <= T(0.125);
    const T half = T(0.5) / square(decay);
    return select_lazy(
        of_small_order,
        [&] { return T(2) * half * tail_of_small_order(T(select(of_small_order, a, T(0.125))), t); },
        [&] {
          const T w = t * t, third = w * T(1 / 1.5);
          const T lower = a + third * centre_series(w, T(a + T(1)));
          const T upper = T(1) + third / (a + T(1)) * centre_series(w, T(a + T(2)));
          return maximum(T(half - t * gamma.above * (k.at * lower + k.below * upper)), T(0));
        });
  }
  template <class Constant>
  static T added(const T& t, const T& at, const T&, const Constant& inverse) {
    return t * (at * T(Constant(2) * inverse));
  }
};
template <class T>
struct excess {
  static T outer(const T& t, const T& mu, const inverse_gammas<T>& gamma) {
    using namespace coefficients;
    const auto& table = by_precision<T>(variance_gamma_excess_32, variance_gamma_excess_64);
    return T(sqrt_pi) * gamma.at * polynomial(table, t, mu);
  }
  // int_t^inf y P2(y) dy less t Pr(slope > t).
  static T inner(const T& a, const T& t, const bessel::ladder<T>& k, const inverse_gammas<T>& gamma,
                 const T& decay) {
    return maximum(T(T(0.5) * gamma.at * k.above - t * sf<T>::inner(a, t, k, gamma, decay)), T(0));
  }
  template <class Constant>
  static T added(const T&, const T&, const T& above, const Constant&) {
    return above;
  }
};

template <template <class> class Tail, class T>
T climbing(const T& a, const double_double<T>& t) {
  bessel::ladder<T> k(T(a - T(0.5)), t.high);
  const T first = maximum(T(a - k.steps), smallest<T>());
  const inverse_gammas<T> gamma(first);
  const auto distant = bessel::is_far(k.y);
  const T start = select_lazy(
      distant,
      [&] {
        return T(k.lead * Tail<T>::outer(bessel::far_variable(T(select(distant, k.y, T(1)))), k.mu, gamma));
      },
      [&] {
        const T inside = select(distant, T(0.25), k.y);
        return Tail<T>::inner(first, inside, k, gamma, T(exp(-inside)));
      });
  k.scale(T(0.25) * gamma.at);
  using sums = std::array<T, 2>;  // and Gamma(a)/Gamma(first)/steps!
  const auto [sum, factorial] =
      k.climb(sums{start, T(1)}, [&](const term<T>& j, const T& at, const T& above, const sums& now) {
        const auto inverse = j.inverse(1);
        const T order = multiply_add(first, T(inverse), T(j.plus(0) * inverse));
        return sums{multiply_add(order, now[0], Tail<T>::added(k.y, at, above, inverse)), T(now[1] * order)};
      });
  const T decay = k.decay(t);  // the tails fall about as the density does
  return sum * decay * (decay / factorial);
}

// For large a: averages of Beckmann's tails over the mixing variable m = m0 e^tau, relative to the same
// average of Beckmann's density, by the trapezoidal rule round the peak m0 of the weight.
template <template <class> class Tail, class T>
T averaged(const T& a, const T& t) {
  const T curvature = a * sqrt(T(1) + square(T(T(2) * t / a))), peak = T(0.5) * (a + curvature);
  const T spread = t * t / peak, root = sqrt(peak), step = T(0.5) / sqrt(curvature);
  using sums = std::array<T, 2>;
  const auto [all, all_density] = accumulate(37, sums{T(0), T(0)}, [&](const term<T>& j, const sums& now) {
    const T tau = T(j.plus(-18)) * step, sigma = root * exp(T(0.5) * tau), x = t / sigma;
    const T weight = exp(-peak * expm1_less(tau) - spread * expm1_less(T(-tau)));
    const T density_sum = now[1] + weight / sigma;
    if constexpr (std::is_same_v<Tail<T>, sf<T>>) {
      return sums{T(now[0] + weight * erfc_scaled(x)), density_sum};
    } else {
      return sums{T(now[0] + weight * sigma * ierfc_scaled(x)), density_sum};
    }
  });
  return T(0.5 * sqrt_pi) * density(a, double_double<T>(t)) * all / all_density;
}

template <template <class> class Tail, class T>
T tail(const T& a, const double_double<T>& t) {
  const auto large = a >= T(bessel::large_order<T>);
  return select_lazy(
      large, [&] { return averaged<Tail>(T(select(large, a, T(bessel::large_order<T>))), t.high); },
      [&] { return climbing<Tail>(T(select(large, T(1), a)), t); });
}

}  // namespace detail

// int_t^inf P2 and int_t^inf (y - t) P2(y) dy for t >= 0.
template <class T>
T sf(const T& a, const double_double<T>& t) {
  return minimum(detail::tail<detail::sf>(a, t), T(0.5));
}
template <class T>
T excess(const T& a, const double_double<T>& t) {
  return detail::tail<detail::excess>(a, t);
}

}  // namespace microfacet::variance_gamma
