// Tables for functions that are smooth only piecewise, as interpolated samples are: many short pieces, and a
// fit that always ends. The worst piece is halved until all reach the precision wanted or no piece is left.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "microfacet/approx/interpolant.hpp"
#include "microfacet/approx/piecewise_searched.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
struct piecewise_many : piecewise_searched<T, 512, 8> {
  // nan everywhere: what a function that does not exist is.
  static piecewise_many zero_or_nan() {
    piecewise_many none;
    none.twice_value.fill(nan<T>());
    none.at_zero = nan<T>();
    return none;
  }
};

// Where f is to be met, in L = log x: from `lower` to `upper`, in two parts if `first_end` lies between.
// Above, f goes on as a power of x; where it falls below `least`, it ends. f(0) stands below `lower`.
struct piecewise_many_range {
  double lower, first_end, upper, at_zero, least;
};

template <class T>
class piecewise_many_fit {
  using Table = piecewise_many<T>;
  static constexpr std::size_t nodes = Table::terms + 1;
  static constexpr bool single = sizeof(T) == 4;
  static constexpr double grid = single ? 0x1p16 : 0x1p40,
                          central = single ? 20 : 50;  // of centres; of abs(log f)
  static constexpr double error = single ? 6e-8 : 1e-14, rounding = single ? 0 : 2.5e-16, swing = 12;
  static constexpr double narrowest = 256 / grid + 1e-7;

 public:
  piecewise_many_fit(const sampled_function& sample, const piecewise_many_range& range)
      : sample_(sample), range_(range) {}

  Table operator()() {
    const double end = reach(range_.upper, [this](double f) { return f >= range_.least; });
    const double from = reach(range_.lower, [](double f) { return f >= 1e-300 && f <= 1e300; });
    if (range_.first_end - from > narrowest) add(interpolate(from, range_.first_end));
    add(interpolate(range_.first_end, end));
    while (count_ + 1 < Table::pieces) {
      const auto worst = std::max_element(pieces_.begin(), pieces_.begin() + count_, by_excess);
      if (worst->excess <= 1) break;
      const interpolant whole = *worst;
      *worst = halved(whole, whole.a, whole.centre);
      add(halved(whole, whole.centre, whole.b));
    }
    std::sort(pieces_.begin(), pieces_.begin() + count_,
              [](const interpolant& a, const interpolant& b) { return a.centre < b.centre; });
    store(end);
    measure();
    return table_;
  }

 private:
  struct interpolant {
    double a = 0, b = 0, centre = 0, half = 0, reference = 1,
           excess = 0;  // excess: error over what is allowed
    int stalls = 0;
    std::array<double, nodes> chebyshev{};
  };
  // cos(pi k/(2 nodes)).
  static double wave(std::size_t k) {
    static constexpr auto waves = detail::quarter_waves<nodes>();
    return waves[k % waves.size()];
  }
  static bool by_excess(const interpolant& a, const interpolant& b) { return a.excess < b.excess; }
  void add(const interpolant& p) { pieces_[count_++] = p; }

  // The last L towards `to` up to which f is `inside`.
  template <class Inside>
  double reach(double to, const Inside& inside) {
    double from = range_.first_end, f;
    sample_(&to, &f, 1);
    if (elementary::is_number(f) && inside(f)) return to;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (from + to);
      sample_(&middle, &f, 1);
      (elementary::is_number(f) && inside(f) ? from : to) = middle;
    }
    return from;
  }

  // Half of a piece that is no better than the whole meets noise, or a step: not worth a third try.
  interpolant halved(const interpolant& whole, double a, double b) {
    interpolant half = interpolate(a, b);
    half.stalls = half.excess < 100 && half.excess > 0.6 * whole.excess ? whole.stalls + 1 : 0;
    if (half.stalls > 2 || half.half < narrowest) half.excess = 0;
    return half;
  }

  interpolant interpolate(double a, double b) {
    interpolant p;
    p.a = a, p.b = b;
    p.centre = std::round(0.5 * (a + b) * grid) / grid;
    p.half = (std::max)(p.centre - a, b - p.centre);
    std::array<double, nodes> at, f, t;
    for (std::size_t j = 0; j < nodes; ++j) at[j] = p.centre + p.half * wave(2 * j + 1);
    sample_(at.data(), f.data(), nodes);
    // A node may lie beyond the end by the rounding of the centre.
    for (std::size_t j = 1; j < nodes; ++j) f[j] = f[j] > 0 ? f[j] : f[j - 1];
    p.excess = 1e30, p.reference = nan<double>();
    if (!std::all_of(f.begin(), f.end(), elementary::is_positive_number)) return p;
    p.reference = f[nodes / 2];
    double most = 0;
    for (std::size_t j = 0; j < nodes; ++j) {
      t[j] = std::log(f[j] / p.reference);
      most = (std::max)(most, std::abs(t[j]));
    }
    for (std::size_t k = 0; k < nodes; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < nodes; ++j) sum += t[j] * wave(k * (2 * j + 1));
      p.chebyshev[k] = sum * (k == 0 ? 1.0 : 2.0) / static_cast<double>(nodes);
    }
    const double rest = (std::max)(std::abs(p.chebyshev[nodes - 1]), 0.2 * std::abs(p.chebyshev[nodes - 2]));
    // Far from 1 the rounding of an exponent is larger.
    const double allowed = error * (1 + 0.002 * square(std::log(p.reference))) + rounding * most;
    p.excess = (std::max)(rest / allowed, most / swing);
    if (!(p.excess <= largest<double>())) p.excess = 1e30;
    return p;
  }

  void store(double end) {
    table_.start.fill((std::numeric_limits<T>::max)());
    for (std::size_t i = 0; i < count_; ++i) store(pieces_[i], i);
    const bool vanishes = end < range_.upper;
    const std::size_t last = count_;
    table_.start[last] = static_cast<T>(std::exp(end));
    table_.centre[last] = static_cast<T>(std::round(end * grid) / grid);
    if (!vanishes) {  // a power of x
      const std::array<double, 2> at{end - 1, static_cast<double>(table_.centre[last])};
      std::array<double, 2> f;
      sample_(at.data(), f.data(), 2);
      table_.twice_value[last] = static_cast<T>(2 * f[1]);
      table_.coefficient[0][last] = static_cast<T>(std::log(f[1] / f[0]) / (at[1] - at[0]));
    }
    table_.few = count_ < Table::pieces / 2;
    table_.lower = (std::max)(table_.start[0], (std::numeric_limits<T>::min)());
    table_.upper = static_cast<T>(vanishes ? 4 * std::exp(end) : 0.5 * (std::numeric_limits<T>::max)());
    table_.at_zero = static_cast<T>(range_.at_zero);
  }

  void store(const interpolant& p, std::size_t i) {
    const std::array<double, nodes> powers = detail::powers(p.chebyshev, p.half);
    table_.start[i] = static_cast<T>(std::exp(p.a));
    table_.centre[i] = static_cast<T>(p.centre);
    table_.twice_value[i] = static_cast<T>(2 * p.reference * std::exp(powers[0]));
    for (std::size_t k = 0; k < Table::terms; ++k) table_.coefficient[k][i] = static_cast<T>(powers[k + 1]);
  }

  // The table as it is used, between the nodes.
  void measure() {
    table_.error = table_.far_error = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      std::array<double, 2> at, f;
      for (std::size_t j = 0; j < 2; ++j)
        at[j] = pieces_[i].centre + pieces_[i].half * wave(4 * (j + 1) * (nodes / 4));
      sample_(at.data(), f.data(), 2);
      for (std::size_t j = 0; j < 2; ++j) {
        const double x = std::exp(at[j]);
        if (x < (std::numeric_limits<T>::min)() || x > (std::numeric_limits<T>::max)()) continue;
        const T high = static_cast<T>(x);
        const double got = table_(double_double<T>(high, static_cast<T>(x - static_cast<double>(high))));
        double& most = std::abs(std::log(f[j])) > central ? table_.far_error : table_.error;
        most = (std::max)(most, std::abs(got / f[j] - 1));
      }
    }
  }

  sampled_function sample_;
  piecewise_many_range range_;
  Table table_;
  std::array<interpolant, Table::pieces> pieces_;
  std::size_t count_ = 0;
};

}  // namespace microfacet
