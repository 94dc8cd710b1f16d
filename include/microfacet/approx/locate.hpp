// How a table of pieces finds the one that an x > 0 belongs to: by its leading bits, or by a search.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// Few pieces that end where the leading bits of x change, at powers of two or halves between them: a map from
// those bits gives the piece. Up to 16 pieces are looked up from half of each row, and their numbers take 4
// bits each in the map, else 8.
template <class T>
struct by_map {
  static constexpr bool searches = false;
  static constexpr std::size_t most_pieces = 32;
  using bits_type = integer_of<T>;

  static constexpr std::size_t words = 128 / sizeof(T);
  static constexpr int bits_of_number(bool few) { return few ? 4 : 8; }
  static constexpr std::size_t cells(bool few) {
    return words * sizeof(T) * 8 / static_cast<std::size_t>(bits_of_number(few));
  }

  // The piece of each cell, by its number mod cells: k >> shift, k = bits(x) - base, above the base, and
  // below it, where all is smoother, k >> (shift + coarser).
  static constexpr int coarser = 6;
  std::array<bits_type, words> map{};
  bits_type base{};
  int shift = std::numeric_limits<T>::digits - 1;
  bool few = true;
  T last{1};  // an x in the last cell: what lies beyond belongs to it

  // The number of the piece in its lowest bits, for N pieces.
  template <std::size_t N, class R>
  MICROFACET_INLINE elementary::integers<R> piece(const R& x) const {
    using integers = elementary::integers<R>;
    using elementary::bits;
    constexpr int number = bits_of_number(N < most_pieces) == 4 ? 2 : 3,
                  word = (sizeof(T) == 4 ? 5 : 6) - number;
    const integers fine =
                       elementary::wrapping_difference(integers(bits(minimum(x, R(last)))), integers(base)),
                   k = larger(fine, integers(fine >> coarser));
    const integers at = integers(k >> (shift - number)) & integers(((1 << word) - 1) << number);
    return shift_right(lookup<words>(map, integers(k >> (shift + word))), at);
  }

  // A cell's piece and its first x, for the builder.
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
  MICROFACET_INLINE static bits_type larger(bits_type a, bits_type b) { return a > b ? a : b; }
  template <class Integer>
  MICROFACET_INLINE static Integer larger(const Integer& a, const Integer& b) {
    return select(a > b, a, b);
  }
};

// Many short pieces that end anywhere, found by bisection: for functions that are smooth only piecewise, as
// interpolated samples are. Pieces: a power of two.
template <class T, std::size_t Pieces>
struct by_search {
  static constexpr bool searches = true;
  static constexpr std::size_t most_pieces = Pieces;

  static_assert(Pieces >= 128);
  static constexpr std::size_t together = Pieces / 32;  // pieces of a group

  // The x from which on a piece holds, ascending; the first is not looked at, unused ones are the largest.
  alignas(64) std::array<T, Pieces> start{};
  alignas(64) std::array<T, 32> group{};  // where each group starts: few enough for registers
  bool few = false;                       // at most half of the pieces are in use

  void place_groups() {
    for (std::size_t k = 0; k < group.size(); ++k) group[k] = start[together * k];
  }

  template <std::size_t N, class R>
  MICROFACET_INLINE elementary::integers<R> piece(const R& x) const {
    using integers = elementary::integers<R>;
    integers k = after(x >= R(start[N / 2]), integers(0), integers(N / 2 / together));
    for (std::size_t step = N / 4 / together; step > 0; step /= 2) {
      const integers next = k + integers(step);
      k = after(x >= lookup<32>(group, next), k, next);
    }
    integers i = k << std::countr_zero(together);
    for (std::size_t step = together / 2; step > 0; step /= 2) {
      const integers next = i + integers(step);
      i = after(x >= lookup<N>(start, next), i, next);
    }
    return i;
  }

 private:
  template <class Integer>
  MICROFACET_INLINE static Integer after(bool passed, Integer i, Integer next) {
    return passed ? next : i;
  }
  template <class Mask, class Integer>
  MICROFACET_INLINE static Integer after(const Mask& passed, const Integer& i, const Integer& next) {
    return select(passed, next, i);
  }
};

}  // namespace microfacet
