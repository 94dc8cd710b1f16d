// Elementary functions of packs, from our own polynomials, so that a result is the same bits on every
// instruction set that rounds a * b + c once. They are written on any R with float or double lanes, float and
// double themselves included (namespace elementary), and found by argument-dependent lookup for a pack.
//
// Reductions after W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980. Below the
// normal numbers arguments and results count as zero.
#pragma once

#include "microfacet/core/exponential.hpp"
#include "microfacet/core/format.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"
#include "microfacet/core/polynomial.hpp"

namespace microfacet {

namespace elementary {

template <class R>
MICROFACET_INLINE R abs(const R& x) {
  return from_bits(integers<R>(bits(x) & integers<R>(format<R>::magnitude)), x);
}
// For |x| < 2^51 (float: 2^22).
template <class R>
MICROFACET_INLINE R round(const R& x) {
  return rounded(R(rounded(R(x + R(format<R>::round))) - R(format<R>::round)));
}
template <class R>
MICROFACET_INLINE R floor(const R& x) {
  const R nearest = elementary::round(x);
  return select(nearest > x, R(nearest - R(1)), nearest);
}

// a * b - p for p = a * b rounded: fused, or by splitting both factors (Dekker, Numer. Math. 18, 1971).
template <class R>
MICROFACET_INLINE R two_prod_error(const R& a, const R& b, const R& p) {
#if MICROFACET_FUSED
  return multiply_add(a, b, R(-p));
#else
  const auto upper = [](const R& x) {
    const integers<R> rounded = wrapping_sum(bits(x), integers<R>(format<R>::half_of_lower));
    return from_bits(integers<R>(rounded & integers<R>(~(2 * format<R>::half_of_lower - 1))), x);
  };
  const R a1 = upper(a), b1 = upper(b), a2 = a - a1, b2 = b - b1;
  return rounded(R(rounded(R(a1 * b1 - p)) + (a1 * b2 + a2 * b1))) + a2 * b2;
#endif
}

// Reduces x + low = 2^n (1 + e) for a positive x and |low| much below x, sqrt(1/2) <= 1 + e < sqrt(2), and
// gives log(1 + e) = e - less: less = e^2/2 - s (e^2/2 + s^2 R(s^2)), s = e/(2 + e), so that the rounding of
// s enters but once.
template <class R>
struct reduced_logarithm {
  R n, e, less;
};
template <class R, class Low = absent>
MICROFACET_INLINE reduced_logarithm<R> reduce_log(const R& x, const Low& low = {}) {
  using f = format<R>;
  const integers<R> n = wrapping_difference(bits(x), integers<R>(f::sqrt_half)) >> f::mantissa;
  const integers<R> shift = n << f::mantissa;
  const R m = from_bits(wrapping_difference(bits(x), shift), x);
  const R real_n = rounded(R(from_bits(wrapping_sum(integers<R>(bits(R(f::round))), n), x) - R(f::round)));
  R e = rounded(R(m - R(1)));
  if constexpr (!std::is_same_v<Low, absent>) {
    // 2^(1 - n), since n may be 1024
    const R power = from_bits(wrapping_difference(integers<R>(bits(R(2))), shift), x);
    e = multiply_add(R(R(0.5) * low), power, e);
  }
  const R s = e / (R(2) + e), s2 = s * s, half = R(0.5) * e * e;
  return {real_n, e, half - s * multiply_add(s2, polynomial(f::log, s2), half)};
}

// log(x + low) as the sum of two numbers, x + low >= 0: -inf below the normal numbers, nan below 0.
template <class R>
struct logarithm {
  R high, low;
};
template <class R, class Low>
MICROFACET_INLINE logarithm<R> log(const R& x, const Low& low) {
  using f = format<R>;
  const reduced_logarithm<R> l = reduce_log(x, low);
  const R tail = rounded(R(l.e - multiply_add(l.n, R(-f::ln2_low), l.less))), head = l.n * R(f::ln2_high);
  const R sum = rounded(R(head + tail));
  const R value = select(x <= largest<R>(), sum, x);
  const R below = select(x < R(0), nan<R>(), R(-infinite<R>()));
  return {select(x < smallest<R>(), below, value), rounded(R(tail - rounded(R(sum - head))))};
}
template <class R>
MICROFACET_INLINE R log(const R& x) {
  return elementary::log(x, absent{}).high;
}
template <class R>
MICROFACET_INLINE R log1p(const R& x) {
  const R one_more = rounded(R(R(1) + x)), t = rounded(R(one_more - R(1)));
  const R low = rounded(R(R(1) - rounded(R(one_more - t)))) + rounded(R(x - t));
  const R value = elementary::log(one_more, R(select(x <= largest<R>(), low, R(0)))).high;
  return select(abs(x) < R(0x1p-60), x, value);  // the least numbers lose their halves
}

// For x >= 0.
template <class R>
MICROFACET_INLINE R pow(const R& x, const R& y) {
  const logarithm<R> l = elementary::log(x, absent{});
  const R p = rounded(R(y * l.high));
  return elementary::exp(p, R(multiply_add(y, l.low, elementary::two_prod_error(y, l.high, p))));
}

// cos and sin of 2 pi x; a scalar may bring its own as circle_of_turns.
template <class R>
struct circle {
  R cosine, sine;
};
template <class R>
concept has_own_circle = requires(const R x) { circle_of_turns(x); };
template <class R>
MICROFACET_INLINE circle<R> cos_sin_of_turns(const R& x) {
  if constexpr (has_own_circle<R>) return circle_of_turns(x);
  using f = format<R>;
  const R shifted = rounded(R(x * R(4) + R(f::round))), nearest = rounded(R(shifted - R(f::round)));
  const R y = R(4) * x - nearest, y2 = y * y;
  // sin(pi y/2) with its first term last, so that its rounding is the only one that counts.
  const R s = multiply_add(y, R(f::sin[0]), R(y * y2 * polynomial<1>(f::sin, y2))),
          c = polynomial(f::cos, y2);
  const auto bit = [](int mask, const integers<R>& i) { return (i & integers<R>(mask)) != integers<R>(0); };
  const integers<R> quarter = bits(shifted);
  const auto swapped = bit(1, quarter), negative_sine = bit(2, quarter);
  const auto negative_cosine = bit(2, wrapping_sum(quarter, integers<R>(1)));
  const R cosine = select(swapped, s, c), sine = select(swapped, c, s);
  return {select(negative_cosine, R(-cosine), cosine), select(negative_sine, R(-sine), sine)};
}

}  // namespace elementary

// Zero for a scalar whose products are not known exactly.
template <class T>
MICROFACET_INLINE T two_prod_error(const T& a, const T& b, const T& p) {
  if constexpr (elementary::has_lanes<T>) {
    return elementary::two_prod_error(a, b, p);
  } else {
    return T(0);
  }
}

#if MICROFACET_VECTOR_EXTENSIONS
#define MICROFACET_OF_PACKS(NAME)                                \
  template <class T, std::size_t B, int K>                       \
  MICROFACET_INLINE pack<T, B, K> NAME(const pack<T, B, K>& x) { \
    return elementary::NAME(x);                                  \
  }
MICROFACET_OF_PACKS(abs)
MICROFACET_OF_PACKS(floor)
MICROFACET_OF_PACKS(exp)
MICROFACET_OF_PACKS(expm1)
MICROFACET_OF_PACKS(log)
MICROFACET_OF_PACKS(log1p)
#undef MICROFACET_OF_PACKS
template <class T, std::size_t B, int K>
MICROFACET_INLINE pack<T, B, K> pow(const pack<T, B, K>& x, const pack<T, B, K>& y) {
  return elementary::pow(x, y);
}
#endif

}  // namespace microfacet
