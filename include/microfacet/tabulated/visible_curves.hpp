// Slopes that one direction sees, by the depth -log(probability) of their side (smith/visible/inversion.hpp): what
// tabulated/visible_start.hpp is fitted to. Nothing is solved: slopes give depths, and the slopes at the depths wanted
// lie between.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "microfacet/core/math.hpp"

namespace microfacet {

namespace detail {

inline constexpr std::size_t most_points = 680;

// A rising function by its points, in logarithms.
class rising_curve {
 public:
  void add(double x, double y) {
    if (!(x > 0) || !(y > 0) || (size_ > 0 && std::log(x) <= x_[size_ - 1])) return;
    x_[size_] = std::log(x), y_[size_++] = std::log(y);
  }
  bool enough() const { return size_ > 3; }
  double at(double x) const {
    const double* const end = x_.data() + size_ - 1;
    const auto i = static_cast<std::size_t>(std::upper_bound(x_.data() + 1, end, std::log(x)) - x_.data());
    return std::exp(y_[i - 1] + (y_[i] - y_[i - 1]) / (x_[i] - x_[i - 1]) * (std::log(x) - x_[i - 1]));
  }

 private:
  std::array<double, most_points> x_, y_;
  std::size_t size_ = 0;
};

// The slopes of each depth that one direction sees, by the tables of a density.
template <class Functions>
class visible_curves {
 public:
  visible_curves(const Functions& f, double X, double scale)
      : X_(X), peak_(f.P2(0)), above_(0.5 * X + f.mean_excess(0)) {
    J_ = f.mean_excess(X), P2_ = f.P2(X);
    for (double g = -14; g < 40; g += 0.08) {
      const double v = scale * std::exp(g), t = X + v;
      if (const double N = t * f.slope_sf(v) + f.mean_excess(v); N > 1e-37)
        upper_.add(-std::log(N / above_), v);
      if (const double N = v * f.slope_sf(t) + f.mean_excess(t); N > 1e-37 && N < J_)
        below_.add(-std::log(N / J_), v);
    }
    // What lies beyond x - d, summed from its end.
    std::array<double, 320> d, N;
    double density = P2_, from = 0, sum = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      d[i] = i + 1 < d.size() ? X / (1 + std::exp(18 - 0.1 * static_cast<double>(i))) : X;
      const double there = f.P2(X - d[i]);
      N[i] = sum + 0.25 * (density + there) * (d[i] - from) * (d[i] + from);
      sum = N[i], from = d[i], density = there;
    }
    lower_part_ = sum;
    for (std::size_t i = d.size() - 1; i-- > 0;) lower_.add(-std::log(N[i] / sum), -std::log(d[i] / X));
  }
  double X() const { return X_; }
  bool complete() const { return upper_.enough() && lower_.enough(); }
  bool seen_from_below() const { return J_ > 1e-30 && P2_ > 1e-37 && below_.enough(); }
  // What the polynomials hold, and how much an error of it counts: less where little lies beyond.
  double upper(double L) const { return std::log(upper_.at(L) / parabola(L)); }
  double lower(double L) const { return lower_.at(L) / L; }
  double below(double L) const { return std::log(below_.at(L) / std::sqrt(2 * L * J_ / P2_)); }
  double weight_upper(double L) const { return std::cbrt(above_ / (X_ + J_) * std::exp(-L)); }
  double weight_lower(double L) const {
    const double rest = std::exp(-L * lower(L));  // of x
    return std::cbrt(lower_part_ / (X_ + J_) * std::exp(-L)) * L * rest /
           (std::min)(rest, 1 - rest + 0.05 * above_ / (X_ * (X_ + J_)));
  }
  double weight_below(double L) const { return std::cbrt(std::exp(-L)); }

 private:
  double parabola(double L) const {
    const double e = peak_ / above_, b = X_ * e;
    return 2 * L / (b + std::sqrt(b * b + 2 * (b * b + e) * L));
  }
  double X_, peak_, above_, J_, P2_, lower_part_;
  rising_curve upper_, lower_, below_;
};

// The points of [-1, 1] where Chebyshev's polynomial vanishes, and the powers of the interpolant there.
template <std::size_t N>
double chebyshev_node(std::size_t i) {
  return std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / N);
}
template <std::size_t N>
std::array<double, N> powers_at_nodes(const std::array<double, N>& values) {
  std::array<double, N> node{}, powers{}, product{};
  for (std::size_t i = 0; i < N; ++i) node[i] = chebyshev_node<N>(i);
  std::array<double, N> divided = values;
  for (std::size_t k = 1; k < N; ++k)
    for (std::size_t i = N; i-- > k;) divided[i] = (divided[i] - divided[i - 1]) / (node[i] - node[i - k]);
  product[0] = 1;
  for (std::size_t k = 0; k < N; ++k) {
    for (std::size_t j = 0; j < N; ++j) powers[j] += divided[k] * product[j];
    for (std::size_t j = N; j-- > 0;) product[j] = (j > 0 ? product[j - 1] : 0) - node[k] * product[j];
  }
  return powers;
}

}  // namespace detail

}  // namespace microfacet
