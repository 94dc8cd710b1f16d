// Floating-point numbers as bits, of a float, a double or the lanes of a pack of either.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "microfacet/core/elementary_coefficients.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"

namespace microfacet {

namespace elementary {

// A long double is none: like any other scalar it goes the way without bits.
template <class R>
inline constexpr bool has_lanes = std::is_same_v<R, float> || std::is_same_v<R, double>;

template <class R>
struct integers_of {
  using type = integer_of<R>;
};

template <std::floating_point T>
integer_of<T> bits(T x) {
  return std::bit_cast<integer_of<T>>(x);
}
template <std::floating_point T>
T from_bits(integer_of<T> i, T) {
  return std::bit_cast<T>(i);
}

// Bits of numbers without a meaning here (negative ones in log, say) may leave the range of a signed integer.
template <class Integer>
MICROFACET_INLINE Integer wrapping_sum(const Integer& a, const Integer& b) {
  if constexpr (std::is_integral_v<Integer>) {
    using bits = std::make_unsigned_t<Integer>;
    return static_cast<Integer>(static_cast<bits>(a) + static_cast<bits>(b));
  } else {
    return a + b;
  }
}
template <class Integer>
MICROFACET_INLINE Integer wrapping_difference(const Integer& a, const Integer& b) {
  if constexpr (std::is_integral_v<Integer>) {
    using bits = std::make_unsigned_t<Integer>;
    return static_cast<Integer>(static_cast<bits>(a) - static_cast<bits>(b));
  } else {
    return a - b;
  }
}

#if MICROFACET_VECTOR_EXTENSIONS
template <class T, std::size_t B, int K>
inline constexpr bool has_lanes<pack<T, B, K>> = std::is_floating_point_v<T>;
template <class T, std::size_t B, int K>
struct integers_of<pack<T, B, K>> {
  using type = typename pack<T, B, K>::integers;
};
#endif

// Of P in exp(r) = 1 + r + r^2 P(r), the coefficients of -P(-r).
template <class Real, std::size_t N>
constexpr std::array<Real, N> negated_of_negative(std::array<Real, N> c) {
  for (std::size_t k = 0; k < N; k += 2) c[k] = -c[k];
  return c;
}

// The numbers that depend on the format of a lane.
template <class Real>
struct format_of_lane {
  static_assert(sizeof(Real) == 0, "samples are drawn in float or double, or in packs of them");
};
template <>
struct format_of_lane<float> {
  static constexpr int mantissa = 23;
  static constexpr std::int32_t half = 0x3f000000, sqrt_half = 0x3f3504f3;
  static constexpr std::int32_t magnitude = 0x7fffffff, exponent = 0x7f800000,
                                half_of_lower = 0x800;  // of 12 bits
  static constexpr float round = 0x1.8p23f;  // adding it rounds to an integer, which the low bits then hold
  static constexpr float ln2_high = 0x1.63p-1f, ln2_low = -0x1.bd0106p-13f;  // n ln2_high is exact
  static constexpr float least = -86.6f, most = 88.722839f;                  // arguments of exp
  static constexpr float zero_beyond = 172;  // where the largest factor of exp(-x) leaves nothing
  static constexpr auto& exp = coefficients::exp_32;
  static constexpr auto minus_exp_of_minus = negated_of_negative(coefficients::exp_32);
  static constexpr auto& log = coefficients::log_32;
  static constexpr auto& sin = coefficients::sin_32;
  static constexpr auto& cos = coefficients::cos_32;
};
template <>
struct format_of_lane<double> {
  static constexpr int mantissa = 52;
  static constexpr std::int64_t half = 0x3fe0000000000000, sqrt_half = 0x3fe6a09e667f3bcd;
  static constexpr std::int64_t magnitude = 0x7fffffffffffffff, exponent = 0x7ff0000000000000;
  static constexpr std::int64_t half_of_lower = 0x4000000;  // of 27 bits
  static constexpr double round = 0x1.8p52;
  static constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;
  static constexpr double least = -707.7, most = 709.78271289338397;
  static constexpr double zero_beyond = 1403;
  static constexpr auto& exp = coefficients::exp_64;
  static constexpr auto minus_exp_of_minus = negated_of_negative(coefficients::exp_64);
  static constexpr auto& log = coefficients::log_64;
  static constexpr auto& sin = coefficients::sin_64;
  static constexpr auto& cos = coefficients::cos_64;
};
template <class R>
using format = format_of_lane<typename scalar_traits<R>::real>;
template <class R>
using integers = typename integers_of<R>::type;

// Whether x is no nan, for numbers that must not follow one: under -ffinite-math-only comparisons may take it
// for anything.
template <class R>
auto is_number(const R& x) {
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
  if constexpr (has_lanes<R>) {
    return integers<R>(bits(x) & integers<R>(format<R>::magnitude)) <= integers<R>(format<R>::exponent);
  } else {
    return x == x;
  }
#else
  return x == x;
#endif
}

inline bool is_positive_number(double x) { return is_number(x) && x > 0 && x <= largest<double>(); }

// The power of two at or below a positive x, by which a multiplication is exact; 1 for a scalar without bits.
template <class R>
MICROFACET_INLINE R power_of_two(const R& x) {
  if constexpr (has_lanes<R>) {
    return from_bits(integers<R>(bits(x) & integers<R>(format<R>::exponent)), x);
  } else {
    return R(1);
  }
}
// That at or below the root of x.
template <class R>
MICROFACET_INLINE R power_of_two_of_root(const R& x) {
  if constexpr (has_lanes<R>) {
    return power_of_two(from_bits(wrapping_sum(integers<R>(bits(x) >> 1), integers<R>(bits(R(1)) >> 1)), x));
  } else {
    return R(1);
  }
}

}  // namespace elementary
}  // namespace microfacet
