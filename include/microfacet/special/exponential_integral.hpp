// The exponential integrals E_n(y) = int_1^inf exp(-y v)/v^n dv, n = 1 and 2: near 0 by the entire function Ein, beyond
// as exp(-y) times a mean of positive terms. gamma is Euler's constant.
//
//   E_1(y) = Ein(y) - gamma - log y         = exp(-y) int exp(-s)/(y + s) ds
//   E_2(y) = exp(-y) - y E_1(y)             = exp(-y) int exp(-s) s/(y + s) ds
//
// The logarithm of y is an argument, for the square of a small slope may be too small to have one.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "microfacet/approx/exponential_mean.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"

namespace microfacet::exponential_integral {

namespace detail {
inline constexpr auto ein = [] {  // Ein(y)/y
  std::array<double, 13> c{};
  double factorial = 1;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double n = static_cast<double>(k) + 1;
    factorial *= n, c[k] = (k % 2 == 0 ? 1 : -1) / (n * factorial);
  }
  return c;
}();
}  // namespace detail

// Below, less_log serves, beyond the mean, to rounding; either does up to a factor of four.
inline constexpr double meeting = 0.25;

// y in the mean, up to where exp(-y) is nothing.
template <class T>
T within_mean(const T& y) {
  return minimum(maximum(y, T(meeting)), T(1e3));
}

// E_1(y) + log y, y at most 1/4.
template <class T>
T less_log(const T& y) {
  return multiply_add(minimum(y, T(meeting)), polynomial(detail::ein, minimum(y, T(meeting))),
                      T(-std::numbers::egamma));
}
template <class T>
T e1_near(const T& log_y, const T& y) {
  return less_log(y) - log_y;
}

// factor E_1(y)
template <class T>
T e1(const T& log_y, const double_double<T>& y, const T& factor = T(1)) {
  return select_lazy(
      y.high < T(meeting), [&] { return T(factor * e1_near(log_y, y.high)); },
      [&] {
        const T at = within_mean(y.high);
        return times_exp_minus(
            T(factor * exponential_mean<T>([&](const T& s) { return T(T(1) / (at + s)); })), y);
      });
}
template <class T>
T e1(const double_double<T>& y, const T& factor = T(1)) {
  return e1(T(log(maximum(y.high, smallest<T>()))), y, factor);
}

// 1 - E_2(y), y below 1/4.
template <class T>
T within_e2(const T& log_y, const T& y) {
  return y * e1_near(log_y, y) - expm1(-y);
}
template <class T>
T e2(const double_double<T>& y) {
  return select_lazy(
      y.high < T(meeting),
      [&] { return T(T(1) - within_e2(T(log(maximum(y.high, smallest<T>()))), y.high)); },
      [&] {
        const T at = within_mean(y.high);
        return times_exp_minus(exponential_mean<T>([&](const T& s) { return T(s / (at + s)); }), y);
      });
}

}  // namespace microfacet::exponential_integral
