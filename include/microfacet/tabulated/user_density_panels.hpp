// A radial density as a table, and its integrals over log r by Gauss-Legendre panels, summed from both ends
// once, so that both tails of the survival function keep their digits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/gauss.hpp"
#include "microfacet/approx/piecewise_many.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet::detail {

class user_density_panels {
 protected:
  using table = piecewise_many<double>;
  // density(L, f, n) stores P22 (up to a factor) at slopes exp(L[i]) in [lower, upper]; beyond both it is a
  // power.
  user_density_panels(const sampled_function& density, double lower, double upper, double at_zero)
      : P22_(piecewise_many_fit<double>(density, {lower, lower, upper, at_zero, 1e-300})()) {
    // The last piece is the power beyond the end, or nothing.
    const auto pieces = static_cast<std::size_t>(
        std::find(P22_.start.begin(), P22_.start.end(), largest<double>()) - P22_.start.begin());
    begin_ = lower, end_ = std::log(P22_.start[pieces - 1]);
    low_power_ = std::log(at(begin_ + 1) / at(begin_));
    if (P22_.twice_value[pieces - 1] > 0) high_power_ = std::log(at(end_ - 0.5) / at(end_ - 1.5));
    add_panels();
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
    if (L > end_) return high_power_ == 0 ? 0 : at(end_) * std::exp(high_power_ * (L - end_));
    return P22_(double_double<double>(r));
  }

  // P22(r) r at r = exp(L): where P22 alone overflows too.
  double line_density(double L) const {
    if (L < begin_) return at(begin_) * std::exp(begin_ + (low_power_ + 1) * (L - begin_));
    return at(L) * std::exp(L);
  }

  // Panels inside the pieces, on which no integrand changes much.
  void add_panels() {
    panel_[0] = begin_;
    for (std::size_t i = 1; i < table::pieces && P22_.start[i] < largest<double>(); ++i) {
      const double from = panel_[panels_], to = (std::min)(std::log(P22_.start[i]), end_);
      if (!(to > from)) continue;
      const std::size_t first_panel = panels_;
      const double swing = std::abs(std::log(at(to) / at(from)) + 2 * (to - from));
      const double parts = std::ceil((std::max)((std::min)(swing, 1e3) / 6, (to - from) / 2));
      for (double k = 1; k <= parts && panels_ + 1 < most_panels; ++k)
        panel_[++panels_] = k == parts ? to : from + (to - from) * k / parts;
      std::fill(piece_.begin() + first_panel, piece_.begin() + panels_, i - 1);
    }
  }

  using values = std::array<double, nodes>;
  // P22 at exp(L) inside a panel.
  values inside(std::size_t panel, const values& L) const {
    const std::size_t i = piece_[panel];
    values f;
    for (std::size_t j = 0; j < nodes; ++j) {
      const double v = L[j] - P22_.centre[i];
      double p = P22_.coefficient[table::terms - 1][i];
      for (std::size_t k = table::terms - 1; k-- > 0;) p = multiply_add(p, v, P22_.coefficient[k][i]);
      f[j] = 0.5 * P22_.twice_value[i] * elementary::exp(p * v);
    }
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
      return high_power_ == 0      ? 0
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
  std::size_t panels_ = 0;
  std::array<double, most_panels> panel_{}, below_{}, mass_{};
  std::array<sums, most_panels> above_{};
  std::array<std::size_t, most_panels> piece_{};
};

}  // namespace microfacet::detail
