// Projected area, Smith's Lambda and masking of any family, in standard space, from mean_excess alone.
//
// With c = cos and s = sin of the stretched direction and J = mean_excess: the microfacets project the area
// sigma(c, s) = E[max(0, c - s slope)] = max(c, 0) + s J(|c|/s), on the whole sphere (Heitz 2014; Smith
// 1967).
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet {

// s J(|c|/s), the area seen from below: sigma(-|c|, s); at s = 0 it is 0. As a fraction with a lifted
// numerator, so that each quantity divides once, and by what did not underflow. A family may state it as
// sigma_below, where it has it without the quotient |c|/s or lifts it before it underflows.
template <class T, class Family>
fraction<T> sigma_below(const Family& family, const T& c, const double_double<T>& s2) {
  if constexpr (scaled_sigma<Family>) {
    return family.sigma_below(c, s2);
  } else {
    // Beyond the largest slope, and at s = 0, nothing is left.
    const T least = multiply_add(T(c * c), T(T(1) / square(largest_slope<T>())), smallest<T>());
    const horizon<T> seen(c, s2, least);
    const T below = [&] {
      if constexpr (scaled_excess<Family>) {
        return family.mean_excess(seen.x, lifted(seen.s));
      } else {
        return T(lifted(T(family.mean_excess(seen.x))) * seen.s);
      }
    }();
    return {select(s2.high > least, below, T((below + s2.high) * T(0))), T(1)};
  }
}

template <class T, class Family>
T sigma(const Family& family, const T& c, const double_double<T>& s2) {
  const fraction<T> below = sigma_below(family, c, s2);
  return maximum(c, T(0)) + lowered(T(below.numerator / below.denominator));
}

// sigma(c)/c - 1 = sigma(-c)/c for c > 0; Lambda(-c) = -1 - Lambda(c); infinite at c = 0.
template <class T, class Family>
T Lambda(const Family& family, const T& c, const double_double<T>& s2) {
  const fraction<T> below = sigma_below(family, c, s2);
  const T ratio = below.numerator / (lifted(T(abs(c))) * below.denominator);
  return select(c < T(0), T(T(-1) - ratio), ratio);
}

// c/sigma(c) for c > 0, else 0.
template <class T, class Family>
T G1(const Family& family, const T& c, const double_double<T>& s2) {
  const fraction<T> below = sigma_below(family, c, s2);
  const T visible = lifted(c) * below.denominator, value = visible / (visible + below.numerator);
  return select(c > T(0), value, T((c + below.numerator) * T(0)));
}

// Height-correlated masking and shadowing (Heitz 2014) of reflection, and of transmission its Beta form, for
// Lambda_i = Lambda(wi) with wi.z > 0, Lambda_o = Lambda(|wo.z|).
template <class T, class Mask>
T G2_correlated(const T& lambda_i, const T& lambda_o, const Mask& transmitted) {
  const T reflected = T(1) / (T(1) + lambda_i + lambda_o);
  const auto through = [&] {
    return beta_one_plus(T(minimum(lambda_i, T(1e30))), T(minimum(lambda_o, T(1e30))));
  };
  return select_lazy(transmitted, through, [&] { return reflected; });
}

}  // namespace microfacet
