// Exponentials of numbers with float or double lanes (namespace elementary; core/elementary.hpp has the
// rest).
//
// Reductions after W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980.
#pragma once

#include <numbers>

#include "microfacet/core/format.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"
#include "microfacet/core/polynomial.hpp"

namespace microfacet {

// The low part of a number that has none: it adds nothing, at no cost.
struct absent {
  template <class T>
  MICROFACET_INLINE friend T operator+(const T& a, absent) {
    return a;
  }
};

namespace elementary {

// Reduces x + low = n ln 2 + rest and gives exp(rest) - 1 and 2^(n - 1), which is normal where exp(x) is.
template <class R>
struct reduced {
  R expm1_part, power;
};
template <class R, class Low = absent>
MICROFACET_INLINE reduced<R> reduce(const R& x, const Low& low = {}) {
  using f = format<R>;
  const R shifted = multiply_add(x, R(std::numbers::log2e), R(f::round));
  const R n = rounded(R(shifted - R(f::round)));
  const R rest = multiply_add(n, R(-f::ln2_low), R(multiply_add(n, R(-f::ln2_high), x))) + low;
  const R expm1_part = multiply_add(R(rest * rest), polynomial(f::exp, rest), rest);
  return {expm1_part,
          from_bits(wrapping_sum(integers<R>(bits(shifted) << f::mantissa), integers<R>(f::half)), x)};
}
// Gives exp(x + low) for any x, to 1 ulp; what lies below the normal numbers is zero.
template <class R, class Low = absent>
MICROFACET_INLINE R exp(const R& x, const Low& low = {}) {
  const reduced<R> e = reduce(x, low);
  const R value = multiply_add(R(2), e.expm1_part, R(2)) * e.power;
  return select(x < R(format<R>::least), R(0), select(x > R(format<R>::most), infinite<R>(), value));
}
template <class R>
MICROFACET_INLINE R expm1(const R& x) {
  const reduced<R> e = reduce(x);
  const R general = R(2) * multiply_add(e.power, e.expm1_part, rounded(R(e.power - R(0.5))));
  const R value = select(e.power == R(0.5), e.expm1_part, general);  // which may be tiny
  return select(x < R(format<R>::least), R(-1), select(x > R(format<R>::most), infinite<R>(), value));
}

// Multiplies by 2^n for a whole number n = shifted - round; what lies below the normal numbers is zero.
template <class R>
MICROFACET_INLINE R times_power(const R& value, const R& shifted) {
  using f = format<R>;
  if constexpr (requires { registers::times_power(value.v[0], value.v[0]); }) {
    const R n = shifted - R(f::round);
    return R::from([&](int k) { return registers::times_power(value.v[k], n.v[k]); });
  } else {
    // In two steps, since a power of two alone may leave the format; the shift drops the bits of `round`.
    const integers<R> n = bits(shifted), half = n >> 1, one = bits(R(1));
    const R first = from_bits(wrapping_sum(integers<R>(half << f::mantissa), one), value);
    const R second =
        from_bits(wrapping_sum(integers<R>(wrapping_difference(n, half) << f::mantissa), one), value);
    return rounded(R(value * first)) * second;
  }
}
// Gives factor exp(-(x + low)) for x >= 0 and factor < 2^119 (2^1000): scaled last, it underflows only where
// the result does. Error 1.5 ulp besides those of x.
template <class R, class Low = absent>
MICROFACET_INLINE R times_exp_minus(const R& factor, const R& x, const Low& low = {}) {
  using f = format<R>;
  const R shifted = multiply_add(x, R(-std::numbers::log2e), R(f::round)),
          n = rounded(R(shifted - R(f::round)));
  const R rest = multiply_add(n, R(f::ln2_low), R(multiply_add(n, R(f::ln2_high), x))) + low;
  // 1 - exp(-rest)
  const R lost = multiply_add(R(rest * rest), polynomial(f::minus_exp_of_minus, rest), rest);
  const R value = times_power(R(multiply_add(R(-lost), factor, factor)), shifted);
  return select(x > R(f::zero_beyond), R(0), value);
}

}  // namespace elementary

}  // namespace microfacet
