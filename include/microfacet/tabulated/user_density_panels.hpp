// A radial density as a table, and its integrals over log r by Gauss-Legendre panels, summed from both ends
// once, so that both tails of the survival function keep their digits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "microfacet/approx/gauss.hpp"
#include "microfacet/approx/piecewise_fit.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet::detail {

class user_density_panels {
 protected:
  using table = piecewise<double, 8, by_search<double, 512>>;
  static table table_of(const sampled_function& f, double lower, double upper, double at_zero) {
    return piecewise_fit<table>(f, {lower, upper, lower, at_zero, 1e-300, 50, false, true})();
  }
  // density(L, f, n) stores P22 (up to a factor) at slopes exp(L[i]) in [lower, upper]; beyond both it is a
  // power.
  user_density_panels(const sampled_function& density, double lower, double upper, double at_zero)
      : P22_(table_of(density, lower, upper, at_zero)) {
    // The last piece is the power beyond the end, or nothing.
    const auto last = static_cast<std::size_t>(
        std::find(P22_.start.begin(), P22_.start.end(), largest<double>()) - P22_.start.begin() - 1);
    goes_on_ = P22_.twice_value[last] > 0, high_power_ = P22_.coefficient[0][last];
    begin_ = lower, end_ = goes_on_ ? upper : std::log(P22_.start[last]);
    const double step = (std::min)(1.0, 0.05 * (end_ - begin_));
    low_power_ = std::log(at(begin_ + step) / at(begin_)) / step;
    for (std::size_t i = 0; i < last; ++i) add_panels(i, (std::min)(std::log(P22_.start[i + 1]), end_));
    if (goes_on_) add_panels(last, end_);
    accumulate();
  }

  static constexpr std::size_t nodes = 12;
  // Integrals of P22 dr, P22 r dr, P22 r^2 dr.
  struct sums {
    double line = 0, mass = 0, moment = 0;
  };
  static constexpr std::size_t most_panels = 1600;

  double at(double L) const { return at(L, std::exp(L)); }
  double at(double L, double r) const {
    if (L < begin_) return at(begin_) * std::exp(low_power_ * (L - begin_));
    if (L > end_) return !goes_on_ ? 0 : at(end_) * std::exp(high_power_ * (L - end_));
    return P22_(double_double<double>(r));
  }

  // P22(r) r at r = exp(L): where P22 alone overflows too.
  double line_density(double L) const {
    if (L < begin_) return at(begin_) * std::exp(begin_ + (low_power_ + 1) * (L - begin_));
    return at(L) * std::exp(L);
  }

  // Panels of a piece up to `to`, on which no integrand changes much.
  void add_panels(std::size_t piece, double to) {
    if (panels_ == 0) panel_[0] = begin_;
    const double from = panel_[panels_];
    if (!(to > from)) return;
    const std::size_t first_panel = panels_;
    // A piece may hold a whole peak.
    const double middle = 0.5 * (from + to);
    const double swing = std::abs(std::log(at(middle) / at(from)) + (to - from)) +
                         std::abs(std::log(at(to) / at(middle)) + (to - from));
    const double parts = std::ceil((std::max)((std::min)(swing, 1e3) / 6, (to - from) / 2));
    for (double k = 1; k <= parts && panels_ + 1 < most_panels; ++k)
      panel_[++panels_] = k == parts ? to : from + (to - from) * k / parts;
    std::fill(piece_.begin() + first_panel, piece_.begin() + panels_, piece);
  }

  using values = std::array<double, nodes>;
  // P22 at exp(L) inside a panel.
  values inside(std::size_t panel, const values& L) const {
    const std::size_t i = piece_[panel];
    values f;
    for (std::size_t j = 0; j < nodes; ++j)
      f[j] = P22_.of_piece<table::most_pieces>(L[j] - P22_.centre[i], static_cast<std::int64_t>(i));
    return f;
  }
  sums integral(std::size_t panel, double from, double to) const {
    sums s;
    values L;
    const double half = 0.5 * (to - from);
    for (std::size_t j = 0; j < nodes; ++j) L[j] = from + half * (1 + rule_.node[j]);
    const values f = inside(panel, L);
    for (std::size_t j = 0; j < nodes; ++j) {
      const double r = elementary::exp(L[j]), term = half * rule_.weight[j] * f[j] * r;
      s.line += term, s.mass += term * r, s.moment += term * r * r;
    }
    return s;
  }

  void accumulate() {
    // Beyond the ends: int r^(p + k) dr.
    const double first = at(begin_), r0 = std::exp(begin_), last = at(end_), r1 = std::exp(end_);
    const auto tail = [&](double k) {
      return !goes_on_             ? 0
             : high_power_ + k < 0 ? last * std::pow(r1, k) / -(high_power_ + k)
                                   : infinite<double>();
    };
    const auto head = [&](double k) {
      return low_power_ + k > 0 ? first * std::pow(r0, k) / (low_power_ + k) : infinite<double>();
    };
    above_[panels_] = {tail(1), tail(2), tail(3)};
    below_[0] = head(2);
    for (std::size_t i = panels_; i-- > 0;) {
      const sums s = integral(i, panel_[i], panel_[i + 1]), &a = above_[i + 1];
      above_[i] = {a.line + s.line, a.mass + s.mass, a.moment + s.moment};
      mass_[i] = s.mass;
    }
    for (std::size_t i = 0; i < panels_; ++i) below_[i + 1] = below_[i] + mass_[i];
    norm_ = 2 * pi * (above_[0].mass + below_[0]);
    norm_inverse_ = 1 / norm_;
    line_ = above_[0].line + head(1);
    std::size_t i = 0;
    while (i < panels_ && below_[i] < above_[i].mass) ++i;
    median_ = panel_[i];
  }

  std::size_t panel_of(double L) const {
    return static_cast<std::size_t>(std::upper_bound(panel_.begin(), panel_.begin() + panels_ + 1, L) -
                                    panel_.begin()) -
           1;
  }
  double mass_above(double L) const {
    if (L >= end_) return above_[panels_].mass * std::exp((high_power_ + 2) * (L - end_));
    if (L < begin_) return above_[0].mass + below_[0] - mass_below(L);
    const std::size_t i = panel_of(L);
    return above_[i + 1].mass + integral(i, L, panel_[i + 1]).mass;
  }
  double mass_below(double L) const {
    if (L < begin_) return below_[0] * std::exp((low_power_ + 2) * (L - begin_));
    if (L >= end_) return below_[panels_] + above_[panels_].mass - mass_above(L);
    const std::size_t i = panel_of(L);
    return below_[i] + integral(i, panel_[i], L).mass;
  }

  gauss_legendre<nodes> rule_;
  table P22_;
  double begin_, end_, low_power_ = 0, high_power_ = 0, norm_ = 0, norm_inverse_ = 1, line_ = 0, median_ = 0;
  bool goes_on_ = false;  // as a power, beyond end_
  std::size_t panels_ = 0;
  std::array<double, most_panels> panel_{}, below_{}, mass_{};
  std::array<sums, most_panels> above_{};
  std::array<std::size_t, most_panels> piece_{};
};

}  // namespace microfacet::detail
