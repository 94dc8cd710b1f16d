// Builds a piecewise table from a function in double precision: piece after piece from the left, each over as
// many cells as Chebyshev interpolation of log f reaches the precision wanted (Trefethen, Approximation
// Theory and Approximation Practice, 2013). Then the table itself is measured between the nodes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

#include "microfacet/approx/interpolant.hpp"
#include "microfacet/approx/piecewise.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// `sample` outlives the fit.
template <class Table>
class piecewise_fit {
  using T = typename Table::real;
  using bits_type = typename Table::bits_type;
  using polynomial = interpolant<T, Table::terms + 1>;
  static constexpr std::size_t nodes = Table::terms + 1;
  static constexpr double tolerated = 6;  // excess, which may be rounding, of a piece of one cell
  static constexpr int most_fits = 700;   // functions that can be met take half of that

 public:
  piecewise_fit(const sampled_function& sample, const fit_range& range) : sample_(sample), range_(range) {}

  // What does not reach the precision wanted with the pieces there are is nan, with an infinite error.
  Table operator()() {
    constexpr int octave = std::numeric_limits<T>::digits - 1;
    const double lowest = range_.roots ? 2 * range_.lower : range_.lower;
    const auto in_range = [this](double, double f) { return f >= range_.least && f <= most(); };
    double middle;
    sample_(&range_.inside, &middle, 1);
    if (!elementary::is_number(middle) || !in_range(range_.inside, middle)) return Table::zero_or_nan();
    low_ = reach(sample_, range_.inside, lowest, in_range);
    high_ = reach(sample_, range_.inside, range_.upper, in_range);
    goes_on_ = high_ >= range_.upper;
    if (goes_on_) find_power();
    for (const bool few : {true, false}) {
      for (int shift = octave - 2; shift <= octave + 1; ++shift) {
        if (!pieces(few, shift)) continue;
        table_.error = table_.far_error = 0;
        std::size_t measured = 0;
        for (std::size_t i = 0; i < count_; ++i) measured += measure(i);
        return measured > 0 ? table_ : Table::zero_or_nan();
      }
    }
    return Table::zero_or_nan();
  }

 private:
  static double most() { return 0.01 * static_cast<double>((std::numeric_limits<T>::max)()); }

  bool pieces(bool few, int shift) {
    table_ = Table();
    table_.few = few, table_.shift = shift;
    table_.at_zero = static_cast<T>(range_.at_zero);
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

    double from = low_;
    if (range_.roots) {
      if (!accept(polynomial::fit(sample_, low_, range_.lower, range_.central))) return false;
      from = range_.lower;
    }
    table_.lower = (std::max)(static_cast<T>(std::exp(from)), (std::numeric_limits<T>::min)());
    for (std::ptrdiff_t cell = first_cell(from, coarse, below); cell < below;) {
      const std::size_t number = count_;
      const std::ptrdiff_t n = widest(cell, below, from);
      if (n == 0 || !accept(met_)) return false;
      for (const std::ptrdiff_t to = cell + n; cell < to; ++cell) table_.set(cell, number);
      from = edge(cell);
    }
    if (count_ == pieces_at_most()) return false;
    for (std::ptrdiff_t cell = below; cell < fine; ++cell) table_.set(cell, count_);
    if (goes_on_) {
      table_.centre[count_] = static_cast<T>(high_);
      table_.twice_value[count_] = static_cast<T>(2 * end_value_);
      table_.coefficient[0][count_] = static_cast<T>(power_);
    }
    return true;
  }
  std::size_t pieces_at_most() const { return table_.few ? Table::most_pieces / 2 : Table::most_pieces; }
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
      const polynomial now = polynomial::fit(sample_, from, edge(cell + n), range_.central);
      const double excess = (std::max)(now.excess, now.wide), width = 2 * now.half;
      const double growth = 0.97 * std::pow((std::max)(excess, 1e-30), -1.0 / nodes);
      const auto in_cells = [&](double factor) {
        std::ptrdiff_t k = n;
        if (factor > 1)
          while (k < most && edge(cell + k + 1) <= from + factor * width) ++k;
        else
          while (k > 1 && edge(cell + k) > from + factor * width) --k;
        return k;
      };
      if (excess <= 1 || (n == 1 && excess <= tolerated)) {
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

  bool accept(const polynomial& p) {
    if (!(p.excess <= tolerated) || count_ == pieces_at_most()) return false;
    const auto powers = p.powers();
    table_.centre[count_] = static_cast<T>(p.centre);
    table_.twice_value[count_] = static_cast<T>(2 * p.reference * std::exp(powers[0]));
    for (std::size_t k = 0; k < Table::terms; ++k)
      table_.coefficient[k][count_] = static_cast<T>(powers[k + 1]);
    halves_[count_++] = p.half;
    return true;
  }

  // Moves the upper end to where f is a power of x from there on.
  void find_power() {
    std::array<double, 2> at{range_.upper - 8, range_.upper}, f;
    sample_(at.data(), f.data(), 2);
    power_ = std::log(f[1] / f[0]) / 8;
    const double high = reach(sample_, range_.upper, range_.inside, [&](double L, double value) {
      const double swing = std::log(value / f[1]);
      return std::abs(swing - power_ * (L - range_.upper)) <=
             polynomial::allowed(value, swing, range_.central);
    });
    at = {std::ceil(high), range_.upper};
    sample_(at.data(), f.data(), 2);
    high_ = at[0], end_value_ = f[0];
    if (at[1] > at[0]) power_ = std::log(f[1] / f[0]) / (at[1] - at[0]);
  }

  // The table as it is used, half way between the nodes; how many values were compared.
  std::size_t measure(std::size_t i) {
    constexpr std::size_t points = nodes / 2;
    std::size_t measured = 0;
    const bool root = range_.roots && i == 0;
    std::array<double, points> at, f;
    for (std::size_t k = 0; k < points; ++k)
      at[k] = static_cast<double>(table_.centre[i]) + halves_[i] * polynomial::waves[4 * k + 2];
    sample_(at.data(), f.data(), points);
    for (std::size_t k = 0; k < points; ++k) {
      const double x = elementary::exp(root ? 0.5 * at[k] : at[k]);
      const T high = static_cast<T>(x), low = static_cast<T>(x - static_cast<double>(high));
      if (high < (root ? (std::numeric_limits<T>::min)() : table_.lower)) continue;
      if (f[k] < 4 * static_cast<double>((std::numeric_limits<T>::min)())) continue;
      const auto got = static_cast<double>(root ? table_.of_root(high) : table_(double_double<T>(high, low)));
      const double error = std::abs(got / f[k] - 1);
      double& most = std::abs(std::log(f[k])) > range_.central ? table_.far_error : table_.error;
      most = elementary::is_number(error) ? (std::max)(most, error) : largest<double>();
      ++measured;
    }
    return measured;
  }

  sampled_function sample_;
  fit_range range_;
  Table table_;
  polynomial met_;
  std::array<double, Table::most_pieces> halves_{};
  double low_ = 0, high_ = 0, power_ = 0, end_value_ = 0;
  bool goes_on_ = false;
  std::size_t count_ = 0;
  std::ptrdiff_t guess_ = 1, fits_ = 0;
};

}  // namespace microfacet
