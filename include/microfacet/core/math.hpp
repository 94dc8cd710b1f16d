// The scalar contract: what a type T must offer to run through the kernels, and what built-in types offer.
//
// A kernel calls mathematics unqualified (exp(x), sqrt(x)), so that float and double find <cmath> through the
// using-declarations below and any other scalar (a SIMD batch, an automatic-differentiation number, a Dr.Jit
// array, an arbitrary-precision number) finds its own functions by argument-dependent lookup. There is no
// `if` on a T: comparisons give masks, combined with &, | and !, and select(mask, a, b) chooses lane by lane.
// any_lane(mask) may end a bounded loop early or skip a branch that no lane takes (select_lazy); it never
// changes a result beyond rounding.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>
#include <type_traits>

#include "microfacet/core/compiler.hpp"

namespace microfacet {

using std::abs;
using std::exp;
using std::expm1;
using std::floor;
using std::log;
using std::log1p;
using std::pow;
using std::sqrt;

inline constexpr double pi = std::numbers::pi;
inline constexpr double sqrt_pi = 1.7724538509055160273;  // sqrt(pi)
// By their bits, for compilers warn of the names under -ffinite-math-only.
inline constexpr double inf = std::bit_cast<double>(std::uint64_t{0x7ff} << 52),
                        not_a_number = std::bit_cast<double>(std::uint64_t{0xfff} << 51);

template <class T>
using integer_of = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

template <std::floating_point T>
constexpr T select(bool mask, T a, T b) {
  return mask ? a : b;
}
constexpr bool any_lane(bool mask) { return mask; }

// Names the floating-point type in which a T computes; specialise it for a scalar that is not itself one.
template <class T>
struct scalar_traits {
  using real = T;
};

template <class T>
T nan() {
  return T(static_cast<typename scalar_traits<T>::real>(not_a_number));
}

// Gives the smallest normal number: a floor for arguments of log and of divisions.
template <class T>
T smallest() {
  return T((std::numeric_limits<typename scalar_traits<T>::real>::min)());
}

template <class T>
T largest() {
  return T((std::numeric_limits<typename scalar_traits<T>::real>::max)());
}

// Bounds arguments that are squared, then multiplied by a few numbers: the square is finite.
template <class T>
T largest_slope() {
  return T(1e-5) / sqrt(smallest<T>());
}

// The larger and the smaller of two numbers; a nan in the first argument stays.
template <class T>
MICROFACET_INLINE T maximum(const T& a, const T& b) {
  return select(a < b, b, a);
}
template <class T>
MICROFACET_INLINE T minimum(const T& a, const T& b) {
  return select(a > b, b, a);
}

// Selects between two computations and leaves one out where no lane needs it.
template <class Mask, class Taken, class Other>
auto select_lazy(const Mask& mask, const Taken& taken, const Other& other) {
  if (!any_lane(mask)) return other();
  if (!any_lane(!mask)) return taken();
  return select(mask, taken(), other());
}

// Keeps the rounding of x where it is part of the result: no flag lets a compiler regroup across it. Packs
// round every operation so.
template <class T>
MICROFACET_INLINE T rounded(T x) {
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double>) MICROFACET_HOLD(x);
  return x;
}

// Makes infinity by overflow: under -ffinite-math-only compilers assume that a written infinity never occurs.
// For the same reason x <= largest<T>() stands for x < inf.
template <class T>
MICROFACET_INLINE T infinite() {
  return rounded(T(T(2) * largest<T>()));
}

template <class T>
MICROFACET_INLINE T square(const T& x) {
  return x * x;
}

// Gives a * b + c, rounded once where the hardware does it.
template <class T>
MICROFACET_INLINE T multiply_add(const T& a, const T& b, const T& c) {
  if constexpr (MICROFACET_FUSED && std::is_floating_point_v<T>) {
    return rounded(std::fma(a, b, c));
  } else {
    return rounded(T(a * b + c));
  }
}

// Whether a T records what is done with it, to be computed elsewhere (record/): then short code is better, roundings are
// no part of a result, and nan, which means nothing to a compiler that may assume there is none, is the caller's to give.
template <class T>
inline constexpr bool records = false;

// Gives x where the condition holds and nan elsewhere: so a parameter outside its domain turns its lane into
// nan.
template <class T, class Mask>
MICROFACET_INLINE T nan_unless(const Mask& condition, const T& x) {
  if constexpr (records<T>) {
    return x;
  } else {
    return select(condition, x, nan<T>());
  }
}

// (exp(x) - 1)/x and log(1 + x)/x, and at x = 0 their limits, with the right slope for numbers that carry
// derivatives.
template <class T>
T expm1_over(const T& x) {
  const auto zero = x == T(0);
  return select(zero, T(T(1) + T(0.5) * x), expm1(x) / select(zero, T(1), x));
}
// exp(x) - 1 - x, by its series near 0, where the difference cancels.
template <class T>
T expm1_less(const T& x) {
  const auto by_series = abs(x) < T(0.3);
  const T inside = select(by_series, x, T(0));
  T series(1);
  for (int k = 13; k >= 3; --k) series = T(1) + series * inside / T(k);
  return select(by_series, T(T(0.5) * inside * inside * series), T(expm1(x) - x));
}
template <class T>
T log1p_over(const T& x) {
  const auto zero = x == T(0);
  return select(zero, T(T(1) - T(0.5) * x), log1p(x) / select(zero, T(1), x));
}

// Describes a parameter of a family: its name and the open interval in which the family is defined.
struct parameter {
  std::string_view name;
  double lower;  // for every quantity
  double upper;
  double density_lower;  // for the density and its slope marginals alone, where that is wider
};

// Roughness. In this interval its square stays a normal number, and so do the products from which results are
// made; in a narrower format than double the interval is that of all normal numbers.
inline constexpr parameter roughness{"alpha", 1e-101, 1e101, 1e-101};

// Gives x inside the interval of a parameter and nan outside.
template <class T>
MICROFACET_INLINE T inside(const parameter& domain, const T& x) {
  return nan_unless((x > T(domain.density_lower)) & (x < T(domain.upper)), x);
}

// Computing times 2^lift what a later factor raises lets it underflow only where the result does.
template <class T>
inline constexpr int lift = sizeof(typename scalar_traits<T>::real) == 4 ? 56 : 350;
template <class T>
MICROFACET_INLINE T lifted(const T& x) {
  return x * T(std::ldexp(1.0, lift<T>));
}
template <class T>
MICROFACET_INLINE T lowered(const T& x) {
  return x * T(std::ldexp(1.0, -lift<T>));
}

}  // namespace microfacet
