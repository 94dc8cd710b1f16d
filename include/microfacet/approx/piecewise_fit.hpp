// Builds a piecewise table from a function in double precision, in bounded work, and measures it between the
// nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "microfacet/approx/pieces_by_halving.hpp"
#include "microfacet/approx/pieces_on_cells.hpp"
#include "microfacet/approx/piecewise.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// `sample` outlives the fit.
template <class Table>
class piecewise_fit
    : std::conditional_t<Table::searches, detail::pieces_by_halving<Table>, detail::pieces_on_cells<Table>> {
  using base =
      std::conditional_t<Table::searches, detail::pieces_by_halving<Table>, detail::pieces_on_cells<Table>>;
  using base::count_, base::end_value_, base::goes_on_, base::high_, base::low_, base::power_, base::range_,
      base::sample_, base::table_, base::tiny;
  using typename base::polynomial, typename base::T;

 public:
  piecewise_fit(const sampled_function& sample, const fit_range& range) : base(sample, range) {}

  // What can't be met at all is nan, with an infinite error.
  Table operator()() {
    if (!find_ends() || !this->place()) return Table::zero_or_nan();
    this->add_end();
    table_.lower = (std::max)(table_.lower, (std::numeric_limits<T>::min)());
    table_.at_zero = static_cast<T>(range_.at_zero);
    table_.error = table_.far_error = 0;
    std::size_t measured = 0;
    for (std::size_t i = 0; i < count_; ++i) measured += measure(i);
    return measured > 0 ? table_ : Table::zero_or_nan();
  }

 private:
  bool find_ends() {
    constexpr double most = 0.01 * base::largest_number;
    const auto in_range = [this](double, double f) { return f >= range_.least && f <= most; };
    double middle;
    sample_(&range_.inside, &middle, 1);
    if (!elementary::is_number(middle) || !in_range(range_.inside, middle)) return false;
    // A search finds an edge that a density has to all digits, for pieces end anywhere.
    constexpr int rounds = Table::searches ? 13 : 4;
    low_ = reach(sample_, range_.inside, range_.roots ? 2 * range_.lower : range_.lower, rounds, in_range);
    high_ = reach(sample_, range_.inside, range_.upper, rounds, in_range);
    goes_on_ = high_ >= range_.upper;
    if (goes_on_) find_power();
    return high_ > low_;
  }
  // Moves the upper end to where f is a power of x from there on.
  void find_power() {
    const double width = (std::min)(8.0, 0.47 * (range_.upper - range_.inside));
    std::array<double, 2> at{range_.upper - width, range_.upper}, f;
    sample_(at.data(), f.data(), 2);
    power_ = std::log(f[1] / f[0]) / width;
    const double high = reach(sample_, range_.upper, range_.inside, 4, [&](double L, double value) {
      const double swing = std::log(value / f[1]);
      return std::abs(swing - power_ * (L - range_.upper)) <=
             polynomial::allowed(value, swing, range_.central);
    });
    at = {(std::min)(std::ceil(high), polynomial::on_grid(range_.upper)), range_.upper};
    sample_(at.data(), f.data(), 2);
    high_ = at[0], end_value_ = f[0];
    if (at[1] > at[0]) power_ = std::log(f[1] / f[0]) / (at[1] - at[0]);
  }

  // The table as it is used, half way between the nodes; how many values were compared.
  std::size_t measure(std::size_t i) {
    constexpr std::size_t points = base::nodes / 2;
    std::size_t measured = 0;
    const bool root = range_.roots && i == 0;
    std::array<double, points> at, f;
    for (std::size_t k = 0; k < points; ++k)
      at[k] = static_cast<double>(table_.centre[i]) + this->halves_[i] * polynomial::waves[4 * k + 2];
    sample_(at.data(), f.data(), points);
    for (std::size_t k = 0; k < points; ++k) {
      const double x = elementary::exp(root ? 0.5 * at[k] : at[k]);
      const T high = static_cast<T>(x), low = static_cast<T>(x - static_cast<double>(high));
      if (high < (root ? (std::numeric_limits<T>::min)() : table_.lower)) continue;
      if (f[k] < 4 * tiny) continue;
      const auto got = static_cast<double>(value(root, high, low));
      const double error = std::abs(got / f[k] - 1);
      double& most = std::abs(std::log(f[k])) > range_.central ? table_.far_error : table_.error;
      most = elementary::is_number(error) ? (std::max)(most, error) : largest<double>();
      ++measured;
    }
    return measured;
  }

  T value(bool root, const T& high, const T& low) const {
    if constexpr (!Table::searches)
      if (root) return table_.of_root(high);
    return table_(double_double<T>(high, low));
  }
};

}  // namespace microfacet
