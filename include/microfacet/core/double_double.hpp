// Numbers as the unevaluated sum of two: exponents need more digits than their results, since exp(-r) carries
// the rounding of r times r (Dekker, Numerische Mathematik 18, 1971; Ogita, Rump and Oishi, SIAM J. Sci.
// Comput. 26, 2005). A T becomes a double_double by itself; one whose products are not known exactly keeps low = 0.
// `high` alone is the number to a few roundings. Beside an infinite high, low is nan: exp and log_double_double
// know that.
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
struct double_double {
  T high, low;

  MICROFACET_INLINE double_double(const T& value) : high(value), low(T(0)) {}
  MICROFACET_INLINE double_double(const T& h, const T& l) : high(rounded(h)), low(rounded(l)) {}

  friend double_double operator-(const double_double& a) { return {-a.high, -a.low}; }
  MICROFACET_INLINE friend double_double operator*(const T& power_of_two, const double_double& a) {
    return {power_of_two * a.high, power_of_two * a.low};
  }
  MICROFACET_INLINE friend double_double operator*(const double_double& a, const double_double& b) {
    const T p = rounded(T(a.high * b.high));
    return {p, multiply_add(a.high, b.low, multiply_add(a.low, b.high, two_prod_error(a.high, b.high, p)))};
  }
};

template <class T>
MICROFACET_INLINE double_double<T> two_prod(const T& a, const T& b) {
  const T p = rounded(T(a * b));
  return {p, two_prod_error(a, b, p)};
}

// a - b * c where b * c is a rounded: without error.
template <class T>
MICROFACET_INLINE T residual(const T& a, const T& b, const T& c) {
  if constexpr (MICROFACET_FUSED) {
    return multiply_add(T(-b), c, a);
  } else {
    const T p = rounded(T(b * c));
    return rounded(T(a - p)) - two_prod_error(b, c, p);
  }
}

// Of |a| >= |b|, and of any two.
template <class T>
MICROFACET_INLINE double_double<T> fast_two_sum(const T& a, const T& b) {
  const T s = rounded(T(a + b));
  return {s, b - rounded(T(s - a))};
}
template <class T>
MICROFACET_INLINE double_double<T> two_sum(const T& a, const T& b) {
  const T s = rounded(T(a + b)), t = rounded(T(s - a));
  return {s, rounded(T(a - rounded(T(s - t)))) + rounded(T(b - t))};
}

template <class T>
MICROFACET_INLINE double_double<T> operator+(const double_double<T>& a, const double_double<T>& b) {
  const double_double<T> sum = two_sum(a.high, b.high);
  return {sum.high, sum.low + (a.low + b.low)};
}

// a/b, given 1/b.high.
template <class T>
MICROFACET_INLINE double_double<T> quotient(const double_double<T>& a, const double_double<T>& b,
                                            const T& reciprocal) {
  const T q = rounded(T(a.high * reciprocal));
  const T rest = residual(a.high, q, b.high) + multiply_add(T(-q), b.low, a.low);
  return {q, rest * reciprocal};
}
template <class T>
MICROFACET_INLINE double_double<T> quotient(const double_double<T>& a, const double_double<T>& b) {
  return quotient(a, b, T(T(1) / b.high));
}

template <class T>
MICROFACET_INLINE double_double<T> sqrt(const double_double<T>& a) {
  const T root = sqrt(a.high);
  return {root, T(0.5) * (residual(a.high, root, root) + a.low) / root};
}

// log(a) of a positive a; a scalar of another kind than elementary.hpp knows loses what its log rounds.
template <class T>
MICROFACET_INLINE double_double<T> log_double_double(const double_double<T>& a) {
  if constexpr (elementary::has_lanes<T>) {
    const elementary::logarithm<T> l = elementary::log(a.high, a.low);
    return {l.high, l.low};
  } else {
    const T correction = a.low / a.high;
    return two_sum(T(log(a.high)), T(select(abs(correction) < T(1), correction, T(0))));
  }
}

template <class T>
MICROFACET_INLINE double_double<T> log1p_double_double(const double_double<T>& a) {
  const double_double<T> sum = two_sum(T(1), a.high);
  return log_double_double(double_double<T>(sum.high, T(sum.low + a.low)));
}

template <class T, class Mask>
MICROFACET_INLINE double_double<T> select(const Mask& mask, const double_double<T>& a,
                                          const double_double<T>& b) {
  return {select(mask, a.high, b.high), select(mask, a.low, b.low)};
}

template <class T>
MICROFACET_INLINE double_double<T> abs(const double_double<T>& a) {
  const auto negative = a.high < T(0);
  return {select(negative, -a.high, a.high), select(negative, -a.low, a.low)};
}

template <class T>
MICROFACET_INLINE double_double<T> square(const double_double<T>& a) {
  return a * a;
}

// 2^Bias exp(x): the bias keeps what a large factor then lifts from being flushed to zero.
template <int Bias = 0, class T>
MICROFACET_INLINE T exp(const double_double<T>& x) {
  if constexpr (elementary::has_lanes<T>) {
    return elementary::exp<Bias>(x.high, x.low);
  } else {
    const T e = T(std::ldexp(1.0, Bias)) * exp(x.high);
    return select(abs(x.low) < T(1), T(e + e * x.low), e);
  }
}

}  // namespace microfacet
