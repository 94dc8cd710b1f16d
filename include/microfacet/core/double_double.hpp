// Numbers with the digits that an exponent needs: exp(-r) carries the rounding of r times r. In float32 they
// are the unevaluated sum of two (Dekker, Numerische Mathematik 18, 1971; Ogita, Rump and Oishi, SIAM J. Sci.
// Comput. 26, 2005). In float64 they are one, whose roundings leave exp its digits up to the largest
// exponent, 708; where something cancels, two_prod_error and two_sum_error say what is lost.
//
// A T becomes a double_double by itself; one whose products are not known exactly keeps low = 0. `high` alone
// is the number to a few roundings. Beside an infinite high, low is nan: exp and log_double_double know that.
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/exact_sums.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
inline constexpr bool one_number =
    records<T> || (elementary::has_lanes<T> && sizeof(typename scalar_traits<T>::real) == 8);

template <class T>
struct double_double {
  T high, low;

  MICROFACET_INLINE double_double(const T& value) : high(value), low(T(0)) {}
  MICROFACET_INLINE double_double(const T& h, const T& l) : high(rounded(h)), low(rounded(l)) {}
};

template <class T>
  requires one_number<T>
struct double_double<T> {
  T high;
  static constexpr absent low{};

  MICROFACET_INLINE double_double(const T& value) : high(value) {}
  template <class Low>
  MICROFACET_INLINE double_double(const T& h, const Low&) : high(h) {}
};

// The low part as a number.
template <class T>
MICROFACET_INLINE T low_of(const double_double<T>& a) {
  if constexpr (one_number<T>) {
    return T(0);
  } else {
    return a.low;
  }
}

// The low part where the condition holds, else 0.
template <class T, class Mask>
MICROFACET_INLINE auto low_where(const Mask& condition, const double_double<T>& a) {
  if constexpr (one_number<T>) {
    return a.low;
  } else {
    return select(condition, a.low, T(0));
  }
}

// a + b and a * b with what their roundings lose.
template <class T>
MICROFACET_INLINE double_double<T> two_sum(const T& a, const T& b) {
  const T s = rounded(T(a + b));
  if constexpr (one_number<T>) return s;
  return {s, two_sum_error(a, b, s)};
}
// The same for |a| >= |b|.
template <class T>
MICROFACET_INLINE double_double<T> fast_two_sum(const T& a, const T& b) {
  const T s = rounded(T(a + b));
  if constexpr (one_number<T>) return s;
  return {s, b - rounded(T(s - a))};
}
template <class T>
MICROFACET_INLINE double_double<T> two_prod(const T& a, const T& b) {
  const T p = rounded(T(a * b));
  if constexpr (one_number<T>) return p;
  return {p, two_prod_error(a, b, p)};
}

template <class T>
MICROFACET_INLINE double_double<T> operator-(const double_double<T>& a) {
  return {-a.high, -low_of(a)};
}
template <class T>
MICROFACET_INLINE double_double<T> operator+(const double_double<T>& a, const double_double<T>& b) {
  const double_double<T> sum = two_sum(a.high, b.high);
  return {sum.high, low_of(sum) + (low_of(a) + low_of(b))};
}
template <class T>
MICROFACET_INLINE double_double<T> operator*(const double_double<T>& a, const double_double<T>& b) {
  const T p = rounded(T(a.high * b.high));
  if constexpr (one_number<T>) return p;
  return {
      p, multiply_add(a.high, low_of(b), multiply_add(low_of(a), b.high, two_prod_error(a.high, b.high, p)))};
}
template <class T>
MICROFACET_INLINE double_double<T> operator*(const T& a, const double_double<T>& b) {
  const T p = rounded(T(a * b.high));
  if constexpr (one_number<T>) return p;
  return {p, multiply_add(a, low_of(b), two_prod_error(a, b.high, p))};
}
template <class T>
MICROFACET_INLINE double_double<T> square(const double_double<T>& a) {
  return a * a;
}
// Times a power of two, which is exact.
template <class T>
MICROFACET_INLINE double_double<T> scaled(const T& power_of_two, const double_double<T>& a) {
  return {power_of_two * a.high, power_of_two * low_of(a)};
}

// a/b, given 1/b.high.
template <class T>
MICROFACET_INLINE double_double<T> quotient(const double_double<T>& a, const double_double<T>& b,
                                            const T& reciprocal) {
  const T q = rounded(T(a.high * reciprocal));
  if constexpr (one_number<T>) return q;
  const T rest = residual(a.high, q, b.high) + multiply_add(T(-q), low_of(b), low_of(a));
  return {q, rest * reciprocal};
}
template <class T>
MICROFACET_INLINE double_double<T> quotient(const double_double<T>& a, const double_double<T>& b) {
  if constexpr (one_number<T>) return T(a.high / b.high);
  return quotient(a, b, T(T(1) / b.high));
}

template <class T>
MICROFACET_INLINE double_double<T> sqrt(const double_double<T>& a) {
  const T root = sqrt(a.high);
  if constexpr (one_number<T>) return root;
  return {root, T(0.5) * (residual(a.high, root, root) + low_of(a)) / root};
}

// a/sqrt(b), given the roundings of sqrt(b) and of its reciprocal.
template <class T>
MICROFACET_INLINE double_double<T> root_quotient(const T& a, const double_double<T>& b, const T& root,
                                                 const T& reciprocal) {
  if constexpr (one_number<T>) return a * reciprocal;
  const T rest = T(0.5) * ((residual(b.high, root, root) + low_of(b)) * reciprocal);
  return quotient(double_double<T>(a), double_double<T>(root, rest), reciprocal);
}

template <class T, class Mask>
MICROFACET_INLINE double_double<T> select(const Mask& mask, const double_double<T>& a,
                                          const double_double<T>& b) {
  if constexpr (one_number<T>) return select(mask, a.high, b.high);
  return {select(mask, a.high, b.high), select(mask, low_of(a), low_of(b))};
}

template <class T>
MICROFACET_INLINE double_double<T> abs(const double_double<T>& a) {
  return select(a.high < T(0), -a, a);
}

template <class T>
MICROFACET_INLINE T exp(const double_double<T>& x) {
  if constexpr (elementary::has_lanes<T>) {
    return elementary::exp(x.high, x.low);
  } else if constexpr (one_number<T>) {
    return exp(x.high);
  } else {
    const T e = exp(x.high);
    return select(abs(x.low) < T(1), T(e + e * x.low), e);
  }
}

// factor exp(-x) for x >= 0: a large factor keeps the exponential from being flushed to zero before the
// result is.
template <class T>
MICROFACET_INLINE T times_exp_minus(const T& factor, const double_double<T>& x) {
  if constexpr (elementary::has_lanes<T>) {
    return elementary::times_exp_minus(factor, x.high, x.low);
  } else {
    return factor * exp(-x);
  }
}

}  // namespace microfacet
