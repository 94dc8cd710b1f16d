// Logarithms with the digits that an exponent needs.
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"

namespace microfacet {

// log(a) of a positive a; a scalar of another kind than elementary.hpp knows loses what its log rounds.
template <class T>
MICROFACET_INLINE double_double<T> log_double_double(const double_double<T>& a) {
  if constexpr (elementary::has_lanes<T>) {
    const elementary::logarithm<T> l = elementary::log(a.high, a.low);
    return {l.high, l.low};
  } else if constexpr (one_number<T>) {
    return T(log(a.high));
  } else {
    const T correction = a.low / a.high;
    return two_sum(T(log(a.high)), T(select(abs(correction) < T(1), correction, T(0))));
  }
}

// log(a + b) to rounding, also where the sum is next to 1.
template <class T>
MICROFACET_INLINE T log_of_sum(const T& a, const T& b) {
  const T s = rounded(T(a + b));
  if constexpr (elementary::has_lanes<T>) {
    return elementary::log(s, two_sum_error(a, b, s)).high;
  } else {
    return log_double_double(two_sum(a, b)).high;
  }
}

template <class T>
MICROFACET_INLINE double_double<T> log1p_double_double(const double_double<T>& a) {
  if constexpr (one_number<T> && elementary::has_lanes<T>) {
    return elementary::log1p(a.high);
  } else if constexpr (one_number<T>) {
    return T(log1p(a.high));
  }
  const double_double<T> sum = two_sum(T(1), a.high);
  return log_double_double(double_double<T>(sum.high, T(low_of(sum) + low_of(a))));
}

template <class T>
struct log_of_quotient {
  double_double<T> log;  // log(1 + a/b), with the digits that an exponent needs
  T reciprocal;          // 1/(a + b)
};

// log(1 + a/b) and 1/(a + b) by one division, for a >= 0 and a normal b > 0, a/b finite. (a + b)/b = 2^n (1 +
// s)/(1 - s), and |s| <= 1/5 as n follows from the bits of the two. Both are divided by the power of two in b
// first, so that no product leaves the format.
template <class T>
MICROFACET_INLINE log_of_quotient<T> log1p_of_quotient(const double_double<T>& a_argument,
                                                       const double_double<T>& b_argument) {
  if constexpr (elementary::has_lanes<T>) {
    using namespace elementary;
    using f = format<T>;
    using integers = elementary::integers<T>;
    const integers one = bits(T(1)),
                   half(integer_of<typename scalar_traits<T>::real>(1) << (f::mantissa - 1));
    const T unit = from_bits(
        wrapping_difference(integers(one + one), integers(bits(power_of_two(b_argument.high)))), T());
    const double_double<T> a = scaled(unit, a_argument), b = scaled(unit, b_argument);
    const T sum = rounded(T(a.high + b.high));
    const integers distance = wrapping_difference(integers(bits(sum)), integers(bits(b.high)));
    const integers n = wrapping_sum(distance, half) >> f::mantissa;
    const T power = from_bits(wrapping_difference(one, integers(n << f::mantissa)), sum);  // 2^-n
    const T real_n = rounded(T(from_bits(wrapping_sum(integers(bits(T(f::round))), n), sum) - T(f::round)));
    // 2^-n (a + b) - b, which is a itself where n = 0, and 2^-n (a + b) + b
    const T less = rounded(T(power - T(1)));
    double_double<T> difference(multiply_add(power, a.high, rounded(T(less * b.high))));
    double_double<T> total(rounded(T(difference.high + T(2) * b.high)));
    if constexpr (!one_number<T>) {
      difference = scaled(power, a) + less * b;
      const double_double<T> high = fast_two_sum(T(T(2) * b.high), difference.high);
      total = {high.high, high.low + (difference.low + T(2) * b.low)};
    }
    const T inverse = T(1) / (total.high * sum);
    const double_double<T> s = quotient(difference, total, T(sum * inverse));
    const auto& R = by_precision<T>(coefficients::log_of_quotient_32, coefficients::log_of_quotient_64);
    const T s2 = s.high * s.high, rest = s.high * s2 * polynomial(R, s2);
    const double_double<T> head = fast_two_sum(T(real_n * T(f::ln2_high)), T(T(2) * s.high));
    const T tail = multiply_add(real_n, T(f::ln2_low), rest) + (low_of(head) + T(2) * low_of(s));
    return {fast_two_sum(head.high, tail), T(unit * (total.high * inverse))};
  } else {
    return {log1p_double_double(quotient(a_argument, b_argument)),
            T(T(1) / (a_argument.high + b_argument.high))};
  }
}

}  // namespace microfacet
