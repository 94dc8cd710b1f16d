// A positive function of x > 0 as piecewise polynomials of log f in log x. In these variables a power law is
// straight, and all that lies between two power laws is smooth: few pieces reach from the least number to the
// largest. In each, f = f(centre) exp(v p(v)), v = log x - centre, so that nothing large is ever rounded: an f
// of 1e-300 keeps its digits.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/core/chebyshev.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"

namespace microfacet {

// Pieces: 16 or 32. Terms: coefficients of p.
template <class T, std::size_t Pieces, std::size_t Terms>
struct piecewise {
  static_assert(Terms >= 3);
  static constexpr std::size_t pieces = Pieces, terms = Terms;
  using real = T;
  using row = std::array<T, Pieces>;

  alignas(64) row start;  // of each piece but the first, ascending; unused ones infinite
  row centre;             // log x, with so few digits that n ln2_high - centre is exact
  row twice_value;        // 2 f(centre)
  std::array<row, Terms> coefficient;
  T lower, upper;  // positive and normal; beyond them f is constant
  double error;    // the largest relative error found; infinite where the pieces did not suffice

  template <class R>
  MICROFACET_INLINE R operator()(const twofold<R>& x) const {
    const R inside = minimum(maximum(x.high, R(lower)), R(upper));
    return value(inside, x.low, piece(inside));
  }
  // f(x), where even x^2 is below `lower`, of which f is a power.
  template <class R>
  MICROFACET_INLINE R operator()(const R& x) const {
    return (*this)(twofold<R>(x));
  }

 private:
  template <class R>
  MICROFACET_INLINE R value(const R& x, const R& low, const elementary::integers<R>& i) const {
    const R v = log_less(x, low, lookup(centre, i)), v2 = v * v;
    // Even and odd powers apart: two chains of half the length.
    constexpr std::size_t last_even = (Terms - 1) / 2 * 2, last_odd = Terms / 2 * 2 - 1;
    R even = lookup(coefficient[last_even], i), odd = lookup(coefficient[last_odd], i);
    for (std::size_t k = last_even; k >= 2; k -= 2) even = multiply_add(even, v2, lookup(coefficient[k - 2], i));
    for (std::size_t k = last_odd; k >= 3; k -= 2) odd = multiply_add(odd, v2, lookup(coefficient[k - 2], i));
    const elementary::reduced<R> e = elementary::reduce(R(v * multiply_add(odd, v, even)), R(0));
    const R scale = lookup(twice_value, i) * e.power;
    return multiply_add(scale, e.excess, scale);
  }

  // log(x + low) - centre, for x positive and normal.
  template <class R>
  MICROFACET_INLINE static R log_less(const R& x, const R& low, const R& centre) {
    using f = elementary::format<R>;
    using integers = elementary::integers<R>;
    const integers n = (bits_of(x) - integers(f::sqrt_half)) >> f::mantissa, shift = n << f::mantissa;
    const R m = of_bits(integers(bits_of(x) - shift), x), power = of_bits(integers(integers(bits_of(R(1))) - shift), x);
    const R real_n = of_bits(integers(integers(bits_of(R(f::round))) + n), x) - R(f::round);
    const R e = multiply_add(low, power, R(m - R(1))), s = e / (R(2) + e), s2 = s * s, half = R(0.5) * e * e;
    const R less = half - s * multiply_add(s2, polynomial(f::log, s2), half);
    return (multiply_add(real_n, R(f::ln2_high), R(-centre)) + e) - multiply_add(real_n, R(-f::ln2_low), less);
  }

  template <class R>
  MICROFACET_INLINE elementary::integers<R> piece(const R& x) const {
    using integers = elementary::integers<R>;
    integers i = after(x >= R(start[Pieces / 2]), integers(0), integers(Pieces / 2));
    for (std::size_t step = Pieces / 4; step > 0; step /= 2) {
      const integers next = i + integers(step);
      i = after(x >= lookup(start, next), i, next);
    }
    return i;
  }
  template <class R>
  MICROFACET_INLINE static auto bits_of(const R& x) { using elementary::bits; return bits(x); }
  template <class I, class R>
  MICROFACET_INLINE static R of_bits(const I& i, const R& x) { using elementary::from_bits; return from_bits(i, x); }
  template <class I>
  MICROFACET_INLINE static I after(bool passed, I i, I next) {
    return passed ? next : i;
  }
#if MICROFACET_VECTOR_EXTENSIONS
  template <class I>
  MICROFACET_INLINE static I after(const I& passed, const I& i, const I& next) {
    return select(passed, next, i);
  }
#endif
};

}  // namespace microfacet
