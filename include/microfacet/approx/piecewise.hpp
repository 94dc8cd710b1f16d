// A positive function of x > 0 as piecewise polynomials of log f in log x. In these variables a power law is
// straight, and what lies between two power laws is smooth: few pieces reach from the least number to the
// largest. In each, f = f(centre) exp(v p(v)), v = log x - centre, so that nothing large is ever rounded: an
// f of 1e-300 keeps its digits.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "microfacet/approx/locate.hpp"
#include "microfacet/approx/log_ratio.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// Terms: coefficients of p. Location: by_map or by_search.
template <class T, std::size_t Terms, class Location = by_map<T>>
struct piecewise : Location {
  static_assert(Terms >= 4);
  static constexpr std::size_t most_pieces = Location::most_pieces, terms = Terms;
  using real = T;
  using row = std::array<T, most_pieces>;

  alignas(64) row centre{};  // log x with so few digits that n ln2_high - centre is exact
  row twice_value{};         // 2 f(centre)
  std::array<row, Terms> coefficient{};
  T lower{1}, at_zero{};  // below `lower`, a normal number, f is at_zero
  double error = largest<double>(),
         far_error = error;  // largest relative errors found, near f = 1 and far from it

  // nan everywhere: a function that could not be met.
  static piecewise zero_or_nan() {
    piecewise none;
    none.twice_value.fill(nan<T>());
    none.at_zero = nan<T>();
    return none;
  }

  // What the leading bits of 0, inf and nan give is finite, or left out.
  template <class R>
  MICROFACET_INLINE R operator()(const double_double<R>& x) const {
    const R f = this->few ? value<most_pieces / 2>(x) : value<most_pieces>(x);
    return select(x.high >= R(lower), f, R(R(at_zero) + (x.high - x.high)));
  }
  // f(x^2), also where x^2 is no normal number: the first piece, which the map leaves out, holds there.
  template <class R>
  MICROFACET_INLINE R of_root(const R& x) const
    requires(!Location::searches)
  {
    const double_double<R> x2 = two_prod(x, x);
    const R inside = minimum(maximum(x, smallest<R>()), R(1)),
            v = log_ratio<2>(inside, absent(), R(centre[0]));
    const R first_piece = of_piece<most_pieces / 2>(v, elementary::integers<R>(0));
    const R f = select(x2.high >= R(lower), (*this)(x2), first_piece);
    return select(x >= smallest<R>(), f, R(R(at_zero) + (x - x)));
  }
  // f in piece i of the first N, at log x - centre: abs(v p(v)) < 700 in float64, 30 in float32, so that no
  // power of two overflows.
  template <std::size_t N, class R>
  MICROFACET_INLINE R of_piece(const R& v, const elementary::integers<R>& i) const {
    using format = elementary::format<R>;
    const auto c = [&](std::size_t k) { return lookup<N>(coefficient[k], i); };
    // Far out on a power law exp(t) is zero; its exponent must not leave the format.
    const R t = maximum(R(v * interleaved<Terms>(c, v)), R(format::least));
    const R twice = lookup<N>(twice_value, i);
    if constexpr (!elementary::has_lanes<R>) {
      return R(0.5) * twice * exp(t);
    } else {
      return times_half_exp(twice, t);
    }
  }

 private:
  template <class R>
  MICROFACET_INLINE static R times_half_exp(const R& twice, const R& t) {
    using format = elementary::format<R>;
    using integers = elementary::integers<R>;
    using elementary::bits;
    using elementary::from_bits;
    const R shifted = multiply_add(t, R(std::numbers::log2e), R(format::round)),
            n = rounded(R(shifted - R(format::round)));
    const R r = multiply_add(n, R(-std::numbers::ln2), t);
    const R excess = multiply_add(
        R(r * r), interleaved<format::exp.size()>([](std::size_t k) { return R(format::exp[k]); }, r), r);
    const R power = from_bits(
        elementary::wrapping_sum(integers(bits(shifted) << format::mantissa), integers(format::half)), t);
    const R scale = twice * power;
    // Next to the smallest number a product that is rounded on its own would be flushed to zero.
    return MICROFACET_FUSED ? multiply_add(scale, excess, scale) : R(scale * R(R(1) + excess));
  }
  template <std::size_t N, class R>
  MICROFACET_INLINE R value(const double_double<R>& x) const {
    // Infinity would lie far beyond the last piece, with a low that is nan.
    constexpr T most = (std::numeric_limits<T>::max)() / 4;
    const auto finite = x.high < R(most);
    const R high = select(finite, x.high, R(most));
    const elementary::integers<R> i = this->template piece<N>(high);
    // Without fused operations the low of a product with a factor of nearly the largest number is nan.
    const auto low = [&] {
      if constexpr (MICROFACET_FUSED || one_number<R>) {
        return low_where(finite, x);
      } else {
        return low_where(finite & (x.low == x.low), x);
      }
    };
    return of_piece<N>(log_ratio<1>(high, low(), lookup<N>(centre, i)), i);
  }
};

}  // namespace microfacet
