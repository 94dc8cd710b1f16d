// A positive function of x > 0 as piecewise polynomials of log f in log x. In these variables a power law is
// straight, and what lies between two power laws is smooth: few pieces reach from the least number to the
// largest. In each, f = f(centre) exp(v p(v)), v = log x - centre, so that nothing large is ever rounded: an
// f of 1e-300 keeps its digits. The piece of an x follows from its leading bits, without a search: pieces end
// where those change, at powers of two or halves between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "microfacet/approx/log_ratio.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// Terms: coefficients of p.
template <class T, std::size_t Terms>
struct piecewise {
  static_assert(Terms >= 4);
  static constexpr std::size_t most_pieces = 32, terms = Terms;
  using real = T;
  using bits_type = integer_of<T>;
  using row = std::array<T, most_pieces>;

  // Up to 16 pieces are looked up from half of each row, and their numbers take 4 bits each in the map,
  // else 8.
  static constexpr std::size_t words = 128 / sizeof(T);
  static constexpr int bits_of_number(bool few) { return few ? 4 : 8; }
  static constexpr std::size_t cells(bool few) {
    return words * sizeof(T) * 8 / static_cast<std::size_t>(bits_of_number(few));
  }

  alignas(64) row centre{};  // log x with so few digits that n ln2_high - centre is exact
  row twice_value{};         // 2 f(centre)
  std::array<row, Terms> coefficient{};
  // The piece of each cell, by its number mod cells: k >> shift, k = bits(x) - base, above the base, and
  // below it, where all is smoother, k >> (shift + coarser).
  static constexpr int coarser = 6;
  std::array<bits_type, words> map{};
  bits_type base{};
  int shift = std::numeric_limits<T>::digits - 1;
  bool few = true;
  T last{1};              // an x in the last cell: what lies beyond belongs to it
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

  // factor f(x), where the factor is large if f(x) underflows. What the leading bits of 0, inf and nan give
  // is finite, or left out.
  template <class R>
  MICROFACET_INLINE R operator()(const double_double<R>& x, const R& factor) const {
    const R f = few ? value<true>(x, factor) : value<false>(x, factor);
    return select(x.high >= R(lower), f, R(R(at_zero) * factor + (x.high - x.high)));
  }
  template <class R>
  MICROFACET_INLINE R operator()(const double_double<R>& x) const {
    const R f = few ? value<true>(x, R(1)) : value<false>(x, R(1));
    return select(x.high >= R(lower), f, R(R(at_zero) + (x.high - x.high)));
  }
  // f(x^2), also where x^2 is no normal number: the first piece, which the map leaves out, holds there.
  template <class R>
  MICROFACET_INLINE R of_root(const R& x) const {
    const double_double<R> x2 = two_prod(x, x);
    const R inside = minimum(maximum(x, smallest<R>()), R(1)),
            v = log_ratio<2>(inside, absent(), R(centre[0]));
    const R first_piece = polynomial_of<true>(v, elementary::integers<R>(0), R(1));
    const R f = select(x2.high >= R(lower), (*this)(x2), first_piece);
    return select(x >= smallest<R>(), f, R(R(at_zero) + (x - x)));
  }

  // A cell's piece and first x; for the builder.
  void set(std::ptrdiff_t cell, std::size_t number) {
    const std::size_t width = static_cast<std::size_t>(bits_of_number(few)), in_word = sizeof(T) * 8 / width;
    const std::size_t at = static_cast<std::size_t>(cell) % cells(few);
    using word = std::make_unsigned_t<bits_type>;
    word& w = reinterpret_cast<word&>(map[at / in_word]);
    w |= static_cast<word>(number) << at % in_word * width;
  }
  std::size_t piece_of_cell(std::size_t cell) const {
    const std::size_t width = static_cast<std::size_t>(bits_of_number(few)), in_word = sizeof(T) * 8 / width;
    const auto word = static_cast<std::make_unsigned_t<bits_type>>(map[cell / in_word]);
    return static_cast<std::size_t>(word >> cell % in_word * width) &
           (few ? most_pieces / 2 - 1 : most_pieces - 1);
  }
  T start(std::ptrdiff_t cell) const {
    // What leaves the format wraps round.
    using word = std::make_unsigned_t<bits_type>;
    const word width = word(1) << (cell < 0 ? shift + coarser : shift);
    return std::bit_cast<T>(static_cast<word>(static_cast<word>(base) + static_cast<word>(cell) * width));
  }

 private:
  template <bool Few, class R>
  MICROFACET_INLINE R value(const double_double<R>& x, const R& factor) const {
    // Infinity would lie far beyond the last piece, with a low that is nan.
    constexpr T most = (std::numeric_limits<T>::max)() / 4;
    const auto finite = x.high < R(most);
    const R high = select(finite, x.high, R(most));
    const elementary::integers<R> i = piece<Few>(high);
    const R v = log_ratio<1>(high, low_where(finite, x), lookup<pieces<Few>>(centre, i));
    return polynomial_of<Few>(v, i, factor);
  }
  template <bool Few>
  static constexpr std::size_t pieces = Few ? most_pieces / 2 : most_pieces;

  // The number of the piece in its lowest bits.
  template <bool Few, class R>
  MICROFACET_INLINE elementary::integers<R> piece(const R& x) const {
    using integers = elementary::integers<R>;
    using elementary::bits;
    constexpr int number = bits_of_number(Few) == 4 ? 2 : 3, word = (sizeof(T) == 4 ? 5 : 6) - number;
    const integers fine =
                       elementary::wrapping_difference(integers(bits(minimum(x, R(last)))), integers(base)),
                   k = larger(fine, integers(fine >> coarser));
    const integers at = integers(k >> (shift - number)) & integers(((1 << word) - 1) << number);
    return shift_right(lookup<words>(map, integers(k >> (shift + word))), at);
  }
  MICROFACET_INLINE static bits_type larger(bits_type a, bits_type b) { return a > b ? a : b; }
#if MICROFACET_VECTOR_EXTENSIONS
  template <class Integer>
  MICROFACET_INLINE static Integer larger(const Integer& a, const Integer& b) {
    return select(a > b, a, b);
  }
#endif

  // f(centre) exp(v p(v)): abs(v p(v)) < 700 in float64, 30 in float32, so that no power of two overflows.
  template <bool Few, class R>
  MICROFACET_INLINE R polynomial_of(const R& v, const elementary::integers<R>& i, const R& factor) const {
    using format = elementary::format<R>;
    using integers = elementary::integers<R>;
    using elementary::bits;
    using elementary::from_bits;
    const auto c = [&](std::size_t k) { return lookup<pieces<Few>>(coefficient[k], i); };
    // Far out on a power law exp(t) is zero; its exponent must not leave the format.
    const R t = maximum(R(v * interleaved<Terms>(c, v)), R(format::least));
    const R shifted = multiply_add(t, R(std::numbers::log2e), R(format::round)),
            n = rounded(R(shifted - R(format::round)));
    const R r = multiply_add(n, R(-std::numbers::ln2), t);
    const R excess = multiply_add(
        R(r * r), interleaved<format::exp.size()>([](std::size_t k) { return R(format::exp[k]); }, r), r);
    const R power = from_bits(
        elementary::wrapping_sum(integers(bits(shifted) << format::mantissa), integers(format::half)), t);
    const R scale = lookup<pieces<Few>>(twice_value, i) * factor * power;
    return multiply_add(scale, excess, scale);
  }
};

}  // namespace microfacet
