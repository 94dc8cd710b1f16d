// Piece after piece from the left, each over as many cells of a map as Chebyshev interpolation of log f reaches
// the precision wanted (Trefethen, Approximation Theory and Approximation Practice, 2013).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/pieces.hpp"

namespace microfacet::detail {

template <class Table>
class pieces_on_cells : protected pieces<Table> {
 protected:
  using base = pieces<Table>;
  using base::count_, base::high_, base::low_, base::range_, base::sample_, base::table_, base::pieces;
  using typename base::polynomial, typename base::T;
  using bits_type = typename Table::bits_type;
  static constexpr int most_fits = 700;  // functions that can be met take half of that

  // Whether the pieces there are reach the precision wanted.
  bool place() {
    const int rounds = range_.any ? 3 : 1;
    for (int round = 0; round < rounds; ++round, wanted_ *= 30) {
      fits_ = 0;
      for (const bool few : {true, false})
        for (int shift = octave - 2; shift <= octave + 1; ++shift)
          if (place(few, shift)) return true;
      for (int shift = octave - 3; shift >= octave - 5; --shift)
        if (place(false, shift)) return true;
    }
    return false;
  }

 private:
  bool place(bool few, int shift) {
    table_ = Table();
    table_.few = few, table_.shift = shift;
    count_ = 0, guess_ = 1;
    // The last cell begins where the pieces end, unless there are more cells than numbers below.
    const bits_type least = std::bit_cast<bits_type>((std::numeric_limits<T>::min)());
    const bits_type end = std::bit_cast<bits_type>(static_cast<T>(std::exp(high_)));
    const auto in_cells = [](bits_type n, int width) { return static_cast<std::ptrdiff_t>(n >> width); };
    const std::ptrdiff_t coarse = in_cells(end, shift + Table::coarser) + 1;
    const std::ptrdiff_t fine = static_cast<std::ptrdiff_t>(Table::cells(few)) - coarse;
    if (fine < 8) return false;
    const std::ptrdiff_t below = (std::min)(fine - 1, in_cells(end - least, shift));
    table_.base = end - (static_cast<bits_type>(below) << shift);
    table_.last = static_cast<T>(std::exp((std::min)(high_ + 0.1, sizeof(T) == 4 ? 88.0 : 709.0)));
    // Narrow cells end before.
    if (shift < octave - 2) table_.last = std::bit_cast<T>(end + (bits_type(1) << (shift - 1)));

    double from = low_;
    if (range_.roots) {
      if (!accept(polynomial::fit(sample_, low_, range_.lower, range_))) return false;
      from = range_.lower;
    }
    table_.lower = static_cast<T>(std::exp(from));
    for (std::ptrdiff_t cell = first_cell(from, coarse, below); cell < below;) {
      const std::size_t number = count_;
      const std::ptrdiff_t n = widest(cell, below, from);
      if (n == 0 || !accept(met_)) return false;
      for (const std::ptrdiff_t to = cell + n; cell < to; ++cell) table_.set(cell, number);
      from = edge(cell);
    }
    if (count_ == pieces_at_most()) return false;
    for (std::ptrdiff_t cell = below; cell < fine; ++cell) table_.set(cell, count_);
    return true;
  }
  std::size_t pieces_at_most() const { return table_.few ? Table::most_pieces / 2 : Table::most_pieces; }
  bool accept(const polynomial& p) {
    if (!(p.excess <= tolerated * wanted_) || count_ == pieces_at_most()) return false;
    this->add(p);
    return true;
  }
  double edge(std::ptrdiff_t cell) const { return std::log(static_cast<double>(table_.start(cell))); }
  // The cell in which exp(from) lies: the first whose end lies beyond, or `end`.
  std::ptrdiff_t first_cell(double from, std::ptrdiff_t coarse, std::ptrdiff_t end) const {
    std::ptrdiff_t cell = -coarse;
    while (cell < end && (!(table_.start(cell + 1) > 0) || edge(cell + 1) <= from + 1e-3)) ++cell;
    return cell;
  }

  // How many cells from `cell` on the widest piece that is met takes, nearly: the order of convergence
  // predicts it, and where rounding hides that, doubling and halving find it.
  std::ptrdiff_t widest(std::ptrdiff_t cell, std::ptrdiff_t end, double from) {
    const std::ptrdiff_t most = end - cell;
    std::ptrdiff_t met = 0, failed = most + 1, n = std::clamp<std::ptrdiff_t>(guess_, 1, most);
    while (n > met && n < failed && fits_ < most_fits) {
      ++fits_;
      const polynomial now = polynomial::fit(sample_, from, edge(cell + n), range_);
      const double excess = (std::max)(now.excess, now.wide), width = 2 * now.half;
      const double growth = 0.97 * std::pow((std::max)(excess, 1e-30), -1.0 / base::nodes);
      const auto in_cells = [&](double factor) {
        std::ptrdiff_t k = n;
        if (factor > 1)
          while (k < most && edge(cell + k + 1) <= from + factor * width) ++k;
        else
          while (k > 1 && edge(cell + k) > from + factor * width) --k;
        return k;
      };
      if (excess <= wanted_ || (n == 1 && excess <= tolerated * wanted_)) {
        met = n, met_ = now;
        const bool easy = excess < 0.5;
        n = (std::max)(in_cells(std::clamp(growth, easy ? 1.5 : 1.0, 6.0)), easy ? n + 1 : n);
        n = (std::min)({n, most, (met + failed) / 2});
      } else {
        failed = n;
        n = (std::max)(in_cells(std::clamp(growth, 0.2, 1.0)), (met + n) / 2);
        if (n == failed) --n;
      }
      if (met > 0 && failed - met <= 1 + met / 8) break;
    }
    return guess_ = met;
  }

  static constexpr int octave = std::numeric_limits<T>::digits - 1;
  static constexpr double tolerated = 6;  // excess, which may be rounding, of a piece of one cell
  double wanted_ = 1;                     // excess of others
  polynomial met_;
  std::ptrdiff_t guess_ = 1, fits_ = 0;
};

}  // namespace microfacet::detail
