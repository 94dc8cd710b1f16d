// Builds a piecewise table from a function that is given in double precision: piece after piece from the left,
// each as wide as Chebyshev interpolation of log f reaches the precision wanted (Trefethen, Approximation
// Theory and Approximation Practice, 2013), and measures what was reached.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/core/math.hpp"
#include "microfacet/core/piecewise.hpp"

namespace microfacet {

namespace detail {

// cos(pi k/(2 n)) for k < 4 n.
template <std::size_t N>
constexpr std::array<double, 4 * N> quarter_waves() {
  std::array<double, 4 * N> table{};
  for (std::size_t k = 0; k < 4 * N; ++k) {
    // cos is even about 0 and odd about pi/2: an argument in [0, pi/2], and Taylor's series there.
    const std::size_t j = k <= 2 * N ? k : 4 * N - k, i = j <= N ? j : 2 * N - j;
    const double x = 0.5 * pi * static_cast<double>(i) / static_cast<double>(N), x2 = x * x;
    double sum = 1;
    for (int m = 26; m > 0; m -= 2) sum = 1 - sum * x2 / (m * (m - 1));
    table[k] = i == N ? 0 : j <= N ? sum : -sum;
  }
  return table;
}

}  // namespace detail

// What is asked of a table: where f is to be met, from exp(lower) to exp(upper) or to where f falls below
// `least`; what it is before, f(0); and the relative error of interpolation that counts as none.
struct fit_range {
  double lower, upper, at_zero, least;
};

template <class T>
struct fit_precision;
template <>
struct fit_precision<float> {
  static constexpr double error = 6e-8, far = 2e-6, central = 20, swing = 2.5, far_swing = 20, rounding = 0, grid = 0x1p16;
};
template <>
struct fit_precision<double> {
  static constexpr double error = 5e-15, far = 1e-13, central = 50, swing = 30, far_swing = 300, rounding = 2.5e-16, grid = 0x1p40;
};

// Sample: sample(L, f, n) stores f(exp(L[i])) for i < n <= 32.
template <class Table, class Sample>
class piecewise_fit {
  using T = typename Table::real;
  static constexpr std::size_t nodes = Table::terms + 1;
  using limits = fit_precision<T>;

 public:
  piecewise_fit(const Sample& sample, const fit_range& range) : sample_(sample), range_(range) {}

  Table operator()() {
    const double end = last(), first = range_.lower;
    clear();
    count_ = 0;
    if (std::isinf(range_.at_zero) || range_.at_zero == 0) add_end(first - 1, range_.at_zero);
    double from = first, width = (end - first) / 4;
    table_.error = 0;
    while (from < end) {
      if (count_ == Table::pieces) {
        table_.error = inf;
        break;
      }
      const bool reached = widest(from, end, width);
      if (!reached) { table_.error = inf; break; }
      accept();
      from = fit_.centre + fit_.half;
      if (end - from < 4 / limits::grid) break;
    }
    if (end < range_.upper && count_ < Table::pieces) add_end(end, 0);
    table_.lower = static_cast<T>(std::exp(first) * 0.5);
    table_.upper = static_cast<T>(std::exp(end < range_.upper ? end + 1 : end));
    return table_;
  }
  int evaluations = 0;


 private:
  struct interpolant {
    double centre = 0, half = 0, reference = 1, excess = inf;
    std::array<double, nodes> chebyshev{};
  };
  void clear() {
    table_.start.fill(static_cast<T>(inf));
    table_.centre.fill(T(0)), table_.twice_value.fill(T(0));
    for (auto& row : table_.coefficient) row.fill(T(0));
  }

  void sample(const double* at, double* f, int n) {
    sample_(at, f, n);
    evaluations += n;
  }

  // The last L with f above the least value that counts: by sections, all points of one at a time.
  double last() {
    constexpr int points = 16;
    double low = range_.lower, high = range_.upper;
    for (int round = 0; round < 6; ++round) {
      std::array<double, points> at, f;
      for (int i = 0; i < points; ++i) at[i] = low + (high - low) * (i + 1) / points;
      sample(at.data(), f.data(), points);
      const auto below = std::find_if(f.begin(), f.end(), [this](double v) { return !(v >= range_.least); });
      if (below == f.end()) return high;
      const auto i = static_cast<std::size_t>(below - f.begin());
      high = at[i];
      if (i > 0) low = at[i - 1];
    }
    return low;
  }

  // The widest piece from a on that is met, or nearly: a few steps of a secant in the order of convergence.
  bool widest(double a, double end, double& width) {
    interpolant met;
    double failed = 2 * (end - a);
    for (int tries = 0; tries < 40; ++tries) {
      interpolate(a, std::min(a + width, end));
      const double growth = 0.98 * std::pow(std::max(fit_.excess, 1e-30), -1.0 / nodes), now = 2 * fit_.half;
      if (fit_.excess <= 1) {
        met = fit_;
        width = std::min(now * std::min(growth, 5.0), 0.5 * (now + failed));
      } else {
        failed = now;
        width = std::max(now * std::clamp(growth, 0.15, 0.95), met.half + 0.5 * now);
      }
      const double least = 2 * met.half;
      if (met.excess <= 1 && (a + least >= end || width < 1.2 * least || failed < 1.4 * least)) break;
    }
    fit_ = met;
    width = 2 * met.half;
    return met.excess <= 1;
  }

  // Interpolates on [a, b].
  void interpolate(double a, double b) {
    static constexpr auto waves = detail::quarter_waves<nodes>();
    fit_.centre = std::round(0.5 * (a + b) * limits::grid) / limits::grid;
    fit_.half = fit_.centre - a;
    for (std::size_t j = 0; j < nodes; ++j) at_[j] = fit_.centre + fit_.half * waves[2 * j + 1];
    sample(at_.data(), f_.data(), static_cast<int>(nodes));
    fit_.reference = f_[nodes / 2];
    std::array<double, nodes> t;
    double swing = 0;
    for (std::size_t j = 0; j < nodes; ++j) {
      t[j] = std::log(f_[j] / fit_.reference);
      swing = std::max(swing, std::abs(t[j]));
    }
    for (std::size_t k = 0; k < nodes; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < nodes; ++j) sum += t[j] * waves[k * (2 * j + 1) % (4 * nodes)];
      fit_.chebyshev[k] = sum * (k == 0 ? 1.0 : 2.0) / static_cast<double>(nodes);
    }
    const bool far = std::min(std::abs(std::log(f_[0])), std::abs(std::log(f_[nodes - 1]))) > limits::central;
    const double last = std::max(std::abs(fit_.chebyshev[nodes - 1]), 0.2 * std::abs(fit_.chebyshev[nodes - 2]));
    const double wide = std::pow(swing / (far ? limits::far_swing : limits::swing), static_cast<double>(nodes));
    const double allowed = (far ? limits::far : limits::error) + limits::rounding * swing;
    fit_.excess = std::max(last / allowed, wide);
    if (!(fit_.excess < inf)) fit_.excess = 1e30;
  }

  // T_k as sums of powers, times the coefficients, in units of L.
  void accept() {
    std::array<double, nodes> sum{}, before{}, now{}, next{};
    before[0] = 1, now[1] = 1;
    sum[0] = fit_.chebyshev[0], sum[1] = fit_.chebyshev[1];
    for (std::size_t k = 2; k < nodes; ++k) {
      next[0] = -before[0];
      for (std::size_t i = 1; i <= k; ++i) next[i] = 2 * now[i - 1] - before[i];
      before = now, now = next;
      for (std::size_t i = 0; i <= k; ++i) sum[i] += fit_.chebyshev[k] * now[i];
    }
    const std::size_t i = count_++;
    table_.start[i] = static_cast<T>(std::exp(fit_.centre - fit_.half));
    table_.centre[i] = static_cast<T>(fit_.centre);
    table_.twice_value[i] = static_cast<T>(2 * fit_.reference * std::exp(sum[0]));
    double scale = 1;
    for (std::size_t k = 0; k < Table::terms; ++k)
      table_.coefficient[k][i] = static_cast<T>(sum[k + 1] * (scale /= fit_.half));
  }

  // Where f is 0 or infinite: exp(10.6) times the largest number overflows.
  void add_end(double from, double value) {
    const std::size_t i = count_++;
    table_.start[i] = static_cast<T>(std::exp(from));
    table_.centre[i] = static_cast<T>(std::round(from - 1));
    table_.twice_value[i] = value > 0 ? std::numeric_limits<T>::max() : T(0);
    table_.coefficient[0][i] = value > 0 ? T(10.6) : T(0);
  }

  const Sample& sample_;
  fit_range range_;
  Table table_;
  std::size_t count_ = 0;
  interpolant fit_;
  std::array<double, nodes> at_{}, f_{};
};

}  // namespace microfacet
