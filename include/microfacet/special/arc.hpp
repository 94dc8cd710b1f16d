// What of a circle of slopes of radius r lies beyond t: with q^2 = r^2 - t^2 and the angle of half the arc,
// atan(q/t), its mean excess over t is (q - t angle)/pi. Both are sums of positive terms for 0 <= t <= r: with
// tan(angle/2) = h and tan(angle/4) = u,
//
//   q - t angle = h^3 (t + r) + 2 t (h - atan h),   h - atan h = u^3 (1 + sqrt(1 + h^2)) + 2 (u - atan u).
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
struct arc {
  T angle, excess;

  arc(const T& t, const T& q, const T& r) {
    const T h = q / (t + r), root = sqrt(T(1) + h * h), u = h / (T(1) + root), u2 = u * u;
    T series(0);  // of (u - atan u)/u^3, for u <= tan(pi/8)
    for (int k = sizeof(typename scalar_traits<T>::real) == 4 ? 9 : 20; k >= 0; --k)
      series = multiply_add(T(-u2), series, T(1.0 / (2 * k + 3)));
    const T rest = u * u2 * multiply_add(T(2), series, T(T(1) + root));
    angle = T(2) * (h - rest);
    excess = h * h * h * (t + r) + T(2) * t * rest;
  }
};

}  // namespace microfacet
