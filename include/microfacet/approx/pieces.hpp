// Where the pieces of a table end: what both ways of placing them share.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "microfacet/approx/interpolant.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet::detail {

template <class Table>
class pieces {
 protected:
  using T = typename Table::real;
  static constexpr std::size_t nodes = Table::terms + 1;
  using polynomial = interpolant<T, nodes>;
  static constexpr double tiny = static_cast<double>((std::numeric_limits<T>::min)()),
                          largest_number = static_cast<double>((std::numeric_limits<T>::max)());

  pieces(const sampled_function& sample, const fit_range& range) : sample_(sample), range_(range) {}

  // Nothing where f is not positive.
  void add(const polynomial& p) {
    const bool met = p.excess < 1e30;
    const auto powers = p.powers();
    table_.centre[count_] = static_cast<T>(p.centre);
    table_.twice_value[count_] = met ? static_cast<T>(2 * p.reference * std::exp(powers[0])) : T(0);
    for (std::size_t k = 0; k < Table::terms; ++k)
      table_.coefficient[k][count_] = static_cast<T>(powers[k + 1]);
    halves_[count_++] = met ? p.half : 0;
  }
  // The power of x that f is from high_ on, or nothing where f has ended.
  void add_end() {
    if (!goes_on_) return;
    table_.centre[count_] = static_cast<T>(high_);  // on the grid
    table_.twice_value[count_] = static_cast<T>(2 * end_value_);
    table_.coefficient[0][count_] = static_cast<T>(power_);
  }

  sampled_function sample_;
  fit_range range_;
  Table table_;
  double low_ = 0, high_ = 0, power_ = 0, end_value_ = 0;
  bool goes_on_ = false;
  std::size_t count_ = 0;
  std::array<double, Table::most_pieces> halves_{};
};

}  // namespace microfacet::detail
