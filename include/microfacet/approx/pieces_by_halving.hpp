// The worst piece is halved until all reach the precision wanted or no piece is left: for functions that are
// smooth only piecewise, or noisy, this always ends with a table.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/pieces.hpp"

namespace microfacet::detail {

template <class Table>
class pieces_by_halving : protected pieces<Table> {
 protected:
  using base = pieces<Table>;
  using base::count_, base::high_, base::low_, base::range_, base::sample_, base::table_, base::pieces;
  using typename base::polynomial, typename base::T;
  static constexpr double narrowest = 256 / fit_precision<T>::grid + 1e-5;

  bool place() {
    std::size_t n = 0;
    worst_first_[n++] = fit(low_, high_);
    while (n + 1 < Table::most_pieces) {
      part& worst = *std::max_element(worst_first_.begin(), worst_first_.begin() + n,
                                      [](const part& a, const part& b) { return a.excess < b.excess; });
      // What takes many pieces is known to fewer digits than the format has, or not smooth.
      const double wanted = !range_.any || n < Table::most_pieces / 4 ? 1 : sizeof(T) == 4 ? 5 : 100;
      if (worst.excess <= wanted) break;
      const part whole = worst;
      part left = fit(whole.from, whole.fit.centre), right = fit(whole.fit.centre, whole.to);
      // Where neither half of a piece that is short, or nearly met, is better than the whole there is noise: not
      // worth a third try.
      const double least = (std::min)(left.excess, right.excess);
      const bool noisy = (least < 6 * wanted || left.fit.half < 0.01) && least > 0.6 * whole.excess;
      for (part* half : {&left, &right}) {
        half->stalls = noisy ? whole.stalls + 1 : 0;
        if (half->stalls > 2 || half->fit.half < narrowest) half->excess = 0;
      }
      worst = left, worst_first_[n++] = right;
    }
    std::sort(worst_first_.begin(), worst_first_.begin() + n,
              [](const part& a, const part& b) { return a.from < b.from; });
    table_ = Table();
    table_.start.fill((std::numeric_limits<T>::max)());
    for (std::size_t i = 0; i < n; ++i) {
      table_.start[i] = static_cast<T>(std::exp(worst_first_[i].from));
      this->add(worst_first_[i].fit);
    }
    table_.start[n] = static_cast<T>(std::exp(high_));
    table_.place_groups();
    table_.lower = table_.start[0];
    table_.few = n < Table::most_pieces / 2;
    return true;
  }

 private:
  struct part {
    polynomial fit;
    double from = 0, to = 0, excess = 0;
    int stalls = 0;
  };
  part fit(double from, double to) {
    // No node lies beyond the end, where the rounding of the centre would put one.
    const polynomial p = polynomial::fit(sample_, from, to - 1 / fit_precision<T>::grid, range_);
    return {p, from, to, (std::max)(p.excess, p.wide)};
  }

  std::array<part, Table::most_pieces> worst_first_;
};

}  // namespace microfacet::detail
