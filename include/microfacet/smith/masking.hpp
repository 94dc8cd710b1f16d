// Projected area, Smith's Lambda and masking of any family, in standard space, from slope_excess alone.
//
// With c = cos and s = sin of the stretched direction and J = slope_excess: the microfacets project the area
// sigma(c, s) = E[max(0, c - s slope)] = max(c, 0) + s J(|c|/s), on the whole sphere (Heitz 2014; Smith
// 1967).
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet {

// s J(|c|/s), the area seen from below: sigma(-|c|, s). At s = 0 it is 0.
template <class T, class Family>
T sigma_below(const Family& family, const T& c, const twofold<T>& s2) {
  if constexpr (requires { family.sigma_below(c, s2.high); }) {
    return family.sigma_below(c, s2.sum());
  } else {
    // Beyond the largest slope, and at s = 0, nothing is left.
    const T s2_sum = s2.sum(), least_ratio = T(1) / square(largest_slope<T>());
    const auto inside = s2_sum > multiply_add(T(c * c), least_ratio, smallest<T>());
    const T divisor = select(inside, s2_sum, T(1)), reciprocal = T(1) / divisor, s = sqrt(divisor);
    const twofold<T> x2 = quotient(exact_product(c, c), twofold<T>(divisor, (s2.high - divisor) + s2.low), reciprocal);
    const T below = s * family.slope_excess(slope<T>::of_square(T(abs(c) * s * reciprocal), x2));
    return select(inside, below, T(below * T(0)));
  }
}

template <class T, class Family>
T sigma(const Family& family, const T& c, const twofold<T>& s2) {
  return maximum(c, T(0)) + sigma_below(family, c, s2);
}

// sigma(c)/c - 1 = sigma(-c)/c for c > 0; Lambda(-c) = -1 - Lambda(c); infinite at c = 0.
template <class T, class Family>
T Lambda(const Family& family, const T& c, const twofold<T>& s2) {
  const T below = sigma_below(family, c, s2);
  const T ratio = below / abs(c);
  return select(c < T(0), T(T(-1) - ratio), ratio);
}

// c/sigma(c) for c > 0, else 0.
template <class T, class Family>
T G1(const Family& family, const T& c, const twofold<T>& s2) {
  const T area = sigma(family, c, s2);
  return select(c > T(0), T(c / area), T(area * T(0)));
}

// Height-correlated masking and shadowing (Heitz 2014) of reflection, and of transmission its Beta form, for
// Lambda_i = Lambda(wi) with wi.z > 0, Lambda_o = Lambda(|wo.z|).
template <class T, class Mask>
T G2_correlated(const T& lambda_i, const T& lambda_o, const Mask& transmitted) {
  const T reflected = T(1) / (T(1) + lambda_i + lambda_o);
  const auto through = [&] {
    return beta_one_plus(T(minimum(lambda_i, T(1e30))), T(minimum(lambda_o, T(1e30))));
  };
  return choose(transmitted, through, [&] { return reflected; });
}

}  // namespace microfacet
