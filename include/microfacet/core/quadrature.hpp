// The trapezoidal rule for positive analytic integrands on the line, which converges exponentially
// (Trefethen and Weideman, SIAM Review 56, 2014).
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet {

// int_0^inf f(t) dt of an even f that falls like exp(-t) from `bend` on and whose singularities lie off the
// line, none beyond `bend`. The odd map t = y + 2 exp(-bend) sinh(y) makes that fall doubly exponential.
template <class T, class Integrand>
T trapezoid_even(const Integrand& f, const T& step, const T& bend) {
  constexpr int most = 4000;
  const T fold = exp(-bend);
  T sum = T(0.5) * (T(1) + T(2) * fold) * f(T(0));
  for (int j = 1; j < most; ++j) {
    const T y = T(j) * step;
    const auto inside = y < bend + T(4.2);
    if (!any(inside)) break;
    const T grow = exp(minimum(y, T(bend + T(4.2))) - bend), shrink = square(fold) / grow;
    const T term = f(T(y + grow - shrink)) * (T(1) + grow + shrink);
    sum = select(inside, T(sum + term), sum);
  }
  return step * sum;
}

}  // namespace microfacet
