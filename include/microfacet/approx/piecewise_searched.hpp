// A positive function of x > 0 as many short pieces, polynomials of log f in log x, found by bisection: for
// functions that are smooth only piecewise, as interpolated samples are. In each, f = f(centre) exp(v p(v)),
// v = log x - centre, so that nothing large is ever rounded.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/approx/log_ratio.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"

namespace microfacet {

// Pieces: a power of two. Terms: coefficients of p.
template <class T, std::size_t Pieces, std::size_t Terms>
struct piecewise_searched {
  static_assert(Terms >= 3);
  static constexpr std::size_t pieces = Pieces, terms = Terms;
  using real = T;
  using row = std::array<T, Pieces>;

  alignas(64)
      row start{};  // x from which on a piece holds, ascending; start[0] is not looked at, unused the largest
  row centre{};     // log x with so few digits that n ln2_high - centre is exact
  row twice_value{};  // 2 f(centre)
  std::array<row, Terms> coefficient{};
  T lower{1}, upper{1};  // normal numbers: f(0) below the one, f(upper) above the other
  T at_zero{};
  double error = largest<double>(),
         far_error = error;  // largest relative errors found, near f = 1 and far from it
  bool few = false;          // at most half of the pieces are in use

  template <class R>
  MICROFACET_INLINE R operator()(const double_double<R>& x) const {
    const R inside = minimum(maximum(x.high, R(lower)), R(upper));
    const auto low = low_where(x.high < R(upper), x);  // of 1e200 it would be the larger part of `inside`
    const R f = few ? value<Pieces / 2>(inside, low) : value<Pieces>(inside, low);
    return select(x.high < R(lower), R(at_zero), f);
  }

 private:
  template <std::size_t N, class R, class Low>
  MICROFACET_INLINE R value(const R& x, const Low& low) const {
    const elementary::integers<R> i = piece<N>(x);
    return polynomial_of<N>(log_ratio<1>(x, low, lookup<N>(centre, i)), i);
  }

  template <std::size_t N, class R>
  MICROFACET_INLINE R polynomial_of(const R& v, const elementary::integers<R>& i) const {
    // Even and odd powers apart: two chains of half the length.
    constexpr std::size_t last_even = (Terms - 1) / 2 * 2, last_odd = Terms / 2 * 2 - 1;
    const R v2 = v * v;
    R even = lookup<N>(coefficient[last_even], i), odd = lookup<N>(coefficient[last_odd], i);
    for (std::size_t k = last_even; k >= 2; k -= 2)
      even = multiply_add(even, v2, lookup<N>(coefficient[k - 2], i));
    for (std::size_t k = last_odd; k >= 3; k -= 2)
      odd = multiply_add(odd, v2, lookup<N>(coefficient[k - 2], i));
    // Far out on a power law exp(t) is zero; its exponent must not leave the format.
    const R t = maximum(R(v * multiply_add(odd, v, even)), R(elementary::format<R>::least));
    const elementary::reduced<R> e = elementary::reduce(t);
    const R scale = lookup<N>(twice_value, i) * e.power;
    return multiply_add(scale, e.expm1_part, scale);
  }

  template <std::size_t N, class R>
  MICROFACET_INLINE elementary::integers<R> piece(const R& x) const {
    using integers = elementary::integers<R>;
    integers i = after(x >= R(start[N / 2]), integers(0), integers(N / 2));
    for (std::size_t step = N / 4; step > 0; step /= 2) {
      const integers next = i + integers(step);
      i = after(x >= lookup<N>(start, next), i, next);
    }
    return i;
  }
  template <class Integer>
  MICROFACET_INLINE static Integer after(bool passed, Integer i, Integer next) {
    return passed ? next : i;
  }
#if MICROFACET_VECTOR_EXTENSIONS
  template <class Integer>
  MICROFACET_INLINE static Integer after(const Integer& passed, const Integer& i, const Integer& next) {
    return select(passed, next, i);
  }
#endif
};

}  // namespace microfacet
