// Builds a piecewise table from a function that is given in double precision: piece after piece from the
// left, each as wide as Chebyshev interpolation of log f reaches the precision wanted (Trefethen,
// Approximation Theory and Approximation Practice, 2013). Then the table itself is measured between the
// nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

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

// Where f is to be met, in L = log x: pieces from `lower`, the first up to `first_end` if that is larger, to
// `upper`. Above, f goes on as a power of x; where it falls below `least`, it ends. f(0) stands below
// `lower`.
struct fit_range {
  double lower, first_end, upper, at_zero, least;
};

// Relative errors of interpolation that count as none: near f = 1, where abs(log f) < central, and far from
// it. The polynomial itself is rounded by its swing, the largest abs(log(f/f(centre))).
template <class T>
struct fit_precision;
template <>
struct fit_precision<float> {
  static constexpr double error = 6e-8, far_error = 2e-6, central = 20, swing = 2.5, far_swing = 20,
                          rounding = 0;
  static constexpr double grid = 0x1p16;  // of centres
};
template <>
struct fit_precision<double> {
  static constexpr double error = 5e-15, far_error = 1e-13, central = 50, swing = 30, far_swing = 300;
  static constexpr double rounding = 2.5e-16, grid = 0x1p40;
};

// sample(L, f, n) stores f(exp(L[i])) for i < n <= 32.
template <class Table, class Sample>
class piecewise_fit {
  using T = typename Table::real;
  using limits = fit_precision<T>;
  static constexpr std::size_t nodes = Table::terms + 1;
  static constexpr auto waves = detail::quarter_waves<nodes>();

 public:
  piecewise_fit(const Sample& sample, const fit_range& range) : sample_(sample), range_(range) {}

  // What does not reach the precision wanted with the pieces there are has an infinite error.
  Table operator()() {
    const double end = reach(range_.first_end, range_.upper, [this](double f) { return f >= range_.least; });
    double from = reach(range_.first_end, range_.lower, [](double f) { return f >= 1e-300 && f <= 1e300; });
    double width = std::max(range_.first_end - from, 0.25 * (end - from));
    table_.start.fill(std::numeric_limits<T>::infinity());
    table_.error = table_.far_error = 0;
    while (end - from > 4 / limits::grid) {
      const bool first = range_.first_end - from > 4 / limits::grid;
      if (count_ + 1 == Table::pieces || !widest(from, first ? range_.first_end : end, width)) {
        table_.error = inf;
        break;
      }
      accept();
      from = met_.centre + met_.half;
      measure();
    }
    finish(end, from);
    return table_;
  }
  int evaluations = 0;

 private:
  struct interpolant {
    double centre = 0, half = 0, reference = 1, excess = inf;  // excess: error over what is allowed
    std::array<double, nodes> chebyshev{};
  };

  void sample(const double* at, double* f, std::size_t n) {
    sample_(at, f, static_cast<int>(n));
    evaluations += static_cast<int>(n);
  }

  // The last L up to which f is `inside`, if it is so at `from`: by sections, all points of one at a time.
  template <class Inside>
  double reach(double from, double to, const Inside& inside) {
    constexpr std::size_t points = 16;
    for (int round = 0; round < 4; ++round) {
      std::array<double, points> at, f;
      for (std::size_t i = 0; i < points; ++i)
        at[i] = from + (to - from) * static_cast<double>(i + 1) / points;
      sample(at.data(), f.data(), points);
      const auto i = static_cast<std::size_t>(std::find_if_not(f.begin(), f.end(), inside) - f.begin());
      if (i == points) return to;
      to = at[i];
      if (i > 0) from = at[i - 1];
    }
    return from;
  }

  // The widest piece from a on that is met, nearly: the order of convergence predicts it, and where rounding
  // hides that, doubling and halving find it.
  bool widest(double a, double end, double& width) {
    double failed = inf;
    met_ = interpolant();
    for (int tries = 0; tries < 40; ++tries) {
      const interpolant now = interpolate(a, std::min(a + width, end));
      const double growth = 0.97 * std::pow(std::max(now.excess, 1e-30), -1.0 / nodes), tried = 2 * now.half;
      if (now.excess <= 1) {
        met_ = now;
        width =
            std::min(tried * std::clamp(growth, now.excess < 0.3 ? 1.5 : 1.0, 6.0), 0.5 * (tried + failed));
      } else {
        failed = tried;
        width = std::max(tried * std::clamp(growth, 0.2, 0.9), 0.5 * (2 * met_.half + tried));
      }
      const double least = 2 * met_.half;
      if (met_.excess <= 1 && (a + least >= end || width < 1.15 * least)) break;
    }
    width = 2 * met_.half;
    return met_.excess <= 1;
  }

  interpolant interpolate(double a, double b) {
    interpolant p;
    p.centre = std::round(0.5 * (a + b) * limits::grid) / limits::grid;
    p.half = p.centre - a;
    std::array<double, nodes> at, f, t;
    for (std::size_t j = 0; j < nodes; ++j) at[j] = p.centre + p.half * waves[2 * j + 1];
    sample(at.data(), f.data(), nodes);
    p.reference = f[nodes / 2];
    double swing = 0;
    for (std::size_t j = 0; j < nodes; ++j) {
      t[j] = std::log(f[j] / p.reference);
      swing = std::max(swing, std::abs(t[j]));
    }
    for (std::size_t k = 0; k < nodes; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < nodes; ++j) sum += t[j] * waves[k * (2 * j + 1) % (4 * nodes)];
      p.chebyshev[k] = sum * (k == 0 ? 1.0 : 2.0) / static_cast<double>(nodes);
    }
    const bool far = is_far(f.front()) && is_far(f.back());
    const double rest = std::max(std::abs(p.chebyshev[nodes - 1]), 0.2 * std::abs(p.chebyshev[nodes - 2]));
    const double wide =
        std::pow(swing / (far ? limits::far_swing : limits::swing), static_cast<double>(nodes));
    const double allowed = (far ? limits::far_error : limits::error) + limits::rounding * swing;
    p.excess = std::max(rest / allowed, wide);
    if (!(p.excess < inf)) p.excess = 1e30;
    return p;
  }
  static bool is_far(double f) { return std::abs(std::log(f)) > limits::central; }

  // T_k as sums of powers, times the coefficients, in units of L.
  void accept() {
    std::array<double, nodes> sum{}, before{}, now{}, next{};
    before[0] = 1, now[1] = 1;
    sum[0] = met_.chebyshev[0], sum[1] = met_.chebyshev[1];
    for (std::size_t k = 2; k < nodes; ++k) {
      next[0] = -before[0];
      for (std::size_t i = 1; i <= k; ++i) next[i] = 2 * now[i - 1] - before[i];
      before = now, now = next;
      for (std::size_t i = 0; i <= k; ++i) sum[i] += met_.chebyshev[k] * now[i];
    }
    const std::size_t i = count_++;
    table_.start[i] = static_cast<T>(std::exp(met_.centre - met_.half));
    table_.centre[i] = static_cast<T>(met_.centre);
    table_.twice_value[i] = static_cast<T>(2 * met_.reference * std::exp(sum[0]));
    double scale = 1;
    for (std::size_t k = 0; k < Table::terms; ++k)
      table_.coefficient[k][i] = static_cast<T>(sum[k + 1] * (scale /= met_.half));
  }

  // The table as it is used, half way between the nodes.
  void measure() {
    table_.lower = table_.start[0];
    table_.upper = std::numeric_limits<T>::max();
    constexpr std::size_t points = nodes / 2;
    std::array<double, points> at, f;
    for (std::size_t i = 0; i < points; ++i) at[i] = met_.centre + met_.half * waves[4 * i + 2];
    sample(at.data(), f.data(), points);
    for (std::size_t i = 0; i < points; ++i) {
      const double x = elementary::exp(at[i]);
      if (x < std::numeric_limits<T>::min() || x > std::numeric_limits<T>::max()) continue;
      const T high = static_cast<T>(x);
      const double got = table_(twofold<T>(high, static_cast<T>(x - static_cast<double>(high))));
      const double error = std::abs(got / f[i] - 1);
      double& most = is_far(f[i]) ? table_.far_error : table_.error;
      if (!(error <= most)) most = error;
    }
  }

  // Beyond the last piece f is 0, or a power.
  void finish(double end, double from) {
    const bool vanishes = end < range_.upper;
    const std::size_t i = count_;
    if (i < Table::pieces) {
      const double centre = std::round(from * limits::grid) / limits::grid;
      table_.start[i] = static_cast<T>(std::exp(from));
      table_.centre[i] = static_cast<T>(centre);
      if (!vanishes) {
        std::array<double, 2> at{from - 8, centre}, f;
        sample(at.data(), f.data(), 2);
        table_.twice_value[i] = static_cast<T>(2 * f[1]);
        table_.coefficient[0][i] = static_cast<T>(std::log(f[1] / f[0]) / (at[1] - at[0]));
      }
    }
    table_.few = count_ < Table::pieces / 2;  // and what lies beyond the last
    table_.lower = std::max(table_.start[0], std::numeric_limits<T>::min());
    table_.upper = static_cast<T>(vanishes ? 4 * std::exp(end) : std::numeric_limits<T>::max());
    table_.at_zero = static_cast<T>(range_.at_zero);
  }

  const Sample& sample_;
  fit_range range_;
  Table table_;
  interpolant met_;
  std::size_t count_ = 0;
};

}  // namespace microfacet
