// Projected area, Smith's Lambda and masking of any family, in standard space, from slope_excess alone.
//
// With c = cos and s = sin of the stretched direction and J = slope_excess: the microfacets project the area
// sigma(c, s) = E[max(0, c - s slope)] = max(c, 0) + s J(|c|/s), on the whole sphere (Heitz 2014; Smith
// 1967).
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet {

// s J(|c|/s), the area seen from below: sigma(-|c|, s). At s = 0 it is 0.
template <class T, class Family>
T sigma_below(const Family& family, const T& c, const T& s) {
  return s * family.slope_excess(T(abs(c) / select(s > T(0), s, T(1))));
}

template <class T, class Family>
T sigma(const Family& family, const T& c, const T& s) {
  return maximum(c, T(0)) + sigma_below(family, c, s);
}

// sigma(c)/c - 1 = sigma(-c)/c for c > 0; Lambda(-c) = -1 - Lambda(c); infinite at c = 0.
template <class T, class Family>
T Lambda(const Family& family, const T& c, const T& s) {
  const T below = sigma_below(family, c, s);
  const T ratio = below / select(c == T(0), T(1), abs(c));
  return select(c == T(0), T(below + T(inf)), select(c > T(0), ratio, T(T(-1) - ratio)));
}

// c/sigma(c) for c > 0, else 0.
template <class T, class Family>
T G1(const Family& family, const T& c, const T& s) {
  const T area = sigma(family, c, s);
  return select(c > T(0), T(c / area), T(area * T(0)));
}

// Height-correlated masking and shadowing (Heitz 2014) of reflection, and of transmission its Beta form, for
// Lambda_i = Lambda(wi) with wi.z > 0, Lambda_o = Lambda(|wo.z|).
template <class T, class Mask>
T G2_correlated(const T& lambda_i, const T& lambda_o, const Mask& transmitted) {
  const T reflected = T(1) / (T(1) + lambda_i + lambda_o);
  const T finite_i = minimum(lambda_i, T(1e30)), finite_o = minimum(lambda_o, T(1e30));
  return select(transmitted, beta_one_plus(finite_i, finite_o), reflected);
}

}  // namespace microfacet
