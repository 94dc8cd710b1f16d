// Modified Bessel functions of the second kind of real order, in the form in which slopes need them.
//
//   h_nu(y) = 2 y^nu K_nu(2y) = int_0^inf m^(nu-1) exp(-m - y^2/m) dm
//
// is finite at y = 0 for nu > 0 (where it is Gamma(nu)) and obeys h_{nu+1} = nu h_nu + y^2 h_{nu-1}, all of
// whose terms are positive: three neighbouring orders climb from |mu| <= 1/2, where they are polynomials of
// two variables (tools/derive_bessel.py), without loss; from order 400 on they are Debye's expansion.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/special/bessel_start.hpp"
#include "microfacet/special/coefficients/special.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::bessel {

using microfacet::select;

template <class T>
struct neighbours {  // times decay^2 = exp(exponent)
  T below;           // y^2 h_{nu-1}/Gamma(nu + 1)
  T at;              // h_nu/Gamma(nu + 1)
  T above;           // h_{nu+1}/Gamma(nu + 2)
  T exponent, decay;
};

template <class T, class Mask>
neighbours<T> select(const Mask& mask, const neighbours<T>& a, const neighbours<T>& b) {
  return {select(mask, a.below, b.below), select(mask, a.at, b.at), select(mask, a.above, b.above),
          select(mask, a.exponent, b.exponent), select(mask, a.decay, b.decay)};
}

// The smallest y that is told from 0: 1/y, the size of h_{-1/2}, must stay finite. The largest: beyond, every
// result is 0, and up to it no rung overflows.
template <class T>
T least_argument() {
  return T(64) * smallest<T>();
}
template <class T>
T clamped(const T& y, const T& order) {
  const T most = sizeof(typename scalar_traits<T>::real) == 4
                     ? T(select(order < T(12), T(1e3), T(90)))
                     : T(select(order < T(60), T(1e4),
                                minimum(T(T(400) + T(1.2) * order), T(T(600) + T(0.28) * order))));
  return minimum(maximum(y, least_argument<T>()), most);
}

// Orders nu = mu + steps below `large_order`, -1/2 < mu <= 1/2 (-1/2 only for nu = -1/2). Rung j is
// y^2 h_{mu+j-1}/(j + 1)!, h_{mu+j}/j! and h_{mu+j+1}/(j + 1)!, over exp(-2y): nothing over- or underflows.
template <class T>
inline constexpr double large_order =
    by_precision<T>(40.0F, 400.0);  // in float, larger ones overflow far out

template <class T>
struct ladder {
  T y, steps, mu;
  reciprocal_gamma<T> gamma;
  T lead;  // y^(mu-1/2)
  T below, at, above;

  ladder(const T& nu, const T& y_argument)
      : y(clamped(y_argument, T(maximum(nu, T(0))))),
        steps(maximum(T(-floor(T(T(0.5) - nu))), T(0))),
        mu(nu - steps),
        gamma(mu),
        lead(pow(y, mu) / sqrt(y)) {
    const auto distant = is_far(y);
    const start<T> first = select_lazy(
        distant, [&] { return start_outside(mu, T(select(distant, y, T(1)))); },
        [&] {
          const T inside = select(distant, T(0.25), y);
          return start_inside(mu, inside, T(select(distant, T(1), lead) * sqrt(inside)), gamma);
        });
    at = first.at * lead, below = first.below * lead, above = first.above * lead;
  }

  // Multiplies all rungs.
  void scale(const T& factor) { below = below * factor, at = at * factor, above = above * factor; }

  // Up to nu, with carried = rung(term j, h_{mu+j}/j!, h_{mu+j+1}/(j + 1)!, carried) before each step from j. A
  // lane that has arrived stays.
  template <std::size_t N, class Rung>
  MICROFACET_INLINE std::array<T, N> climb(const std::array<T, N>& carried, const Rung& rung) {
    using states = std::array<T, N + 3>;
    using constant = typename term<T>::constant;
    states all{below, at, above};
    std::copy(carried.begin(), carried.end(), all.begin() + 3);
    all =
        accumulate<2>(static_cast<int>(large_order<T>), steps, all, [&](const term<T>& j, const states& now) {
          const auto inverse = j.inverse(1), next = j.inverse(2);
          const T c = now[1], d = now[2];
          std::array<T, N> more;
          std::copy(now.begin() + 3, now.end(), more.begin());
          more = rung(j, c, d, more);
          const T lower = (y * c) * (y * T(inverse * next));  // the square of y alone may underflow
          const T upper = multiply_add(multiply_add(mu, T(next), T(constant(1) - next)), d, lower);
          states then{lower, d, upper};
          std::copy(more.begin(), more.end(), then.begin() + 3);
          return then;
        });
    below = all[0], at = all[1], above = all[2];
    std::array<T, N> last;
    std::copy(all.begin() + 3, all.end(), last.begin());
    return last;
  }
  // exp(-y), changed so that its square corrects h for y.low: h' = -2y h_{nu-1}.
  T decay(const double_double<T>& exact) const {
    const T e = exp(-exact.high), slope = (steps + T(1)) * (below / at / y);
    if constexpr (one_number<T>) return e;
    const T low =
        select(abs(low_of(exact)) < exact.high, low_of(exact), T(0));  // nothing corrects 0 and infinity
    return e - e * (low * slope);
  }
};

template <class T>
neighbours<T> climb(const T& nu, const double_double<T>& y) {
  ladder<T> l(nu, y.high);
  // Gamma(nu + 1)/Gamma(mu + 1)/steps!
  const auto [factorial] =
      l.climb(std::array{T(1)}, [&](const term<T>& j, const T&, const T&, const std::array<T, 1>& now) {
        return std::array{T(now[0] * multiply_add(l.mu, T(j.inverse(1)), T(1)))};
      });
  const T factor = l.gamma.plus(l.mu) / factorial, next = (l.steps + T(1)) * factor;
  return {l.below * next, l.at * factor, l.above * next / (nu + T(1)), T(T(-2) * y.high), l.decay(y)};
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
  return {below, at, (nu * at + below) / (nu + T(1)), exponent, exp(T(0.5) * exponent)};
}

// h_nu and its neighbours for nu >= -1/2.
template <class T>
neighbours<T> orders(const T& nu, const double_double<T>& y) {
  const auto large = nu >= T(large_order<T>);
  return select_lazy(
      large,
      [&] {
        const T inside = minimum(maximum(y.high, least_argument<T>()), largest_slope<T>());
        return debye(T(select(large, nu, T(large_order<T>))), inside);
      },
      [&] { return climb(T(select(large, T(0), nu)), y); });
}

}  // namespace microfacet::bessel
