// A density that its user gives as a function of the slope's length, in double precision: what tables are
// made of. P22 becomes a table itself, everything else is an integral of it (user_density_panels.hpp). With r = t
// cosh y, q = t sinh y (y >= 0):
//
//   P2(t)           = 2 int P22(r) r dy
//   slope_sf(t)     = 2 int P22(r) atan(q/t) r q dy
//   mean_excess(t) = 2 int P22(r) (q - t atan(q/t)) r q dy
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/tabulated/user_density_panels.hpp"

namespace microfacet {

class user_density
    : public radial_defaults<double, part::P22_by_slope | part::direct_radius | part::radius_by_odds>,
      detail::user_density_panels {
 public:
  static constexpr std::string_view name = "user_density";
  static constexpr std::array<std::string_view, 0> sources{};

  // The survival function above(L, f, n), if `known`, need not be integrated.
  user_density(const sampled_function& density, double lower, double upper, double at_zero, bool known,
               const sampled_function& above)
      : user_density_panels(density, lower, upper, at_zero), known_(known) {
    if (known) survival_ = table_of(above, lower, upper, 1);
  }

  double norm() const { return norm_; }  // the integral over the plane; inf or nan where there is none
  double excess_at_0() const { return 2 * norm_inverse_ * above_[0].moment; }
  double error() const { return P22_.error; }

  double P22_of_slope(double r) const {
    return r == 0 ? norm_inverse_ * P22_.at_zero : norm_inverse_ * at(std::log(r), r);
  }
  double P22(const double_double<double>& r2) const { return P22_of_slope(std::sqrt(r2.high)); }
  double D(double z, const double_double<double>& h2) const {
    return P22_of_slope(std::sqrt(h2.high) / z) / square(square(z));
  }

  double survival(const double_double<double>& r2) const {
    const double r = std::sqrt(r2.high);
    if (known_) return survival_(double_double<double>(r));
    return r == 0 ? 1 : (std::min)(2 * pi * norm_inverse_ * mass_above(std::log(r)), 1.0);
  }
  // Newton's method in log r on the logarithm of the smaller tail, between bounds.
  double radius_at_odds(double odds) const {
    if (!(odds > 0 && odds <= largest<double>())) return odds == 0 ? 0 : odds;
    const bool lower = odds <= 1;
    const double target = std::log((lower ? odds : 1) / (1 + odds) * norm_ / (2 * pi));
    double least = begin_ - 800, most = end_ + 800, L = median_;
    for (int i = 0; i < 200; ++i) {
      const double tail = lower ? mass_below(L) : mass_above(L), off = std::log(tail) - target;
      (lower == (off > 0) ? most : least) = L;
      const double newton = -off * tail / (at(L) * std::exp(2 * L)) * (lower ? 1 : -1);
      const double step = elementary::is_number(newton) ? newton : most - least;
      if (std::abs(step) < 4e-16 * (1 + std::abs(L))) break;
      L = L + step > least && L + step < most ? L + step : 0.5 * (least + most);
    }
    return std::exp(L);
  }
  double radius(double xi) const { return radius_at_odds(xi / (1 - xi)); }
  double radius2(double xi) const { return square(radius(xi)); }

  double P2(const slope<double>& t) const { return marginal<0>(std::abs(t.value.high)); }
  double slope_sf(const slope<double>& t) const {
    return symmetric_sf(
        t, [this](const slope<double>& x) { return (std::min)(marginal<1>(bounded(x).value.high), 0.5); });
  }
  double mean_excess(const slope<double>& t) const { return marginal<2>(t.value.high); }

 private:
  // Direct near t; where (t/r)^2 is lost beside 1, from the sums: atan(q/t) = pi/2 - t/r there. And no
  // further than what is left counts.
  template <int Which>
  double marginal(double t) const {
    if (t == 0) return Which == 0 ? 2 * norm_inverse_ * line_ : Which == 1 ? 0.5 : excess_at_0();
    const double start = std::log(t);
    double y = 0, sum = 0;
    const auto advance = [&](double end, std::size_t panel) {
      while (y < end) {
        const double next = (std::min)(end, y + (std::min)(1 + 0.5 * y, 3.0));
        sum += direct<Which>(t, start, y, next, panel);
        y = next;
      }
    };
    std::size_t i = 0;
    if (start >= begin_) {
      i = (std::min)(panel_of(start), panels_);
    } else {
      advance(angle(begin_ - start), outside);
    }
    while (i < panels_) {
      advance(angle(panel_[i + 1] - start), i);
      const sums& rest = above_[++i];
      const double distance = panel_[i] - start;
      const double all = Which == 0 ? rest.line : Which == 1 ? 0.5 * pi * rest.mass : rest.moment;
      if (distance > 19)
        return 2 * norm_inverse_ *
               (sum + all - (Which == 0 ? 0 : t * (Which == 1 ? rest.line : 0.5 * pi * rest.mass)));
      // The weight of what is left is 1/sqrt(1 - (t/r)^2) at most.
      if (all < 1e-17 * sum * std::sqrt((std::min)(distance, 1.0))) break;
    }
    if (i == panels_ && goes_on_) advance(40, outside);
    return 2 * norm_inverse_ * sum;
  }
  // y of log(r/t).
  static double angle(double d) {
    return d > 19 ? d + std::numbers::ln2 : std::asinh(std::sqrt(std::expm1(2 * d)));
  }
  static constexpr std::size_t outside = most_panels;

  template <int Which>
  double direct(double t, double start, double from, double to, std::size_t panel) const {
    double sum = 0;
    const double half = 0.5 * (to - from);
    values L, sinh, r;
    for (std::size_t j = 0; j < nodes; ++j) {
      const double e = elementary::expm1(from + half * (1 + rule_.node[j])),
                   cosh_less = 0.5 * e * rounded(e / (1 + e));
      sinh[j] = 0.5 * (e + e / (1 + e)), r[j] = t * (1 + cosh_less),
      L[j] = start + elementary::log1p(cosh_less);
    }
    values line;  // P22(r) r
    if (panel == outside) {
      for (std::size_t j = 0; j < nodes; ++j) line[j] = line_density(L[j]);
    } else {
      line = inside(panel, L);
      for (std::size_t j = 0; j < nodes; ++j) line[j] = line[j] * r[j];
    }
    for (std::size_t j = 0; j < nodes; ++j) {
      const double weight = rule_.weight[j] * line[j];
      if constexpr (Which == 0) sum += weight;
      if constexpr (Which == 1) sum += weight * t * sinh[j] * std::atan(sinh[j]);
      if constexpr (Which == 2) sum += weight * t * sinh[j] * t * less_atan(sinh[j]);
    }
    return half * sum;
  }
  // x - atan(x).
  static double less_atan(double x) {
    if (x > 0.4) return x - std::atan(x);
    double sum = 0;
    for (int k = 45; k >= 3; k -= 2) sum = 1.0 / k - x * x * sum;
    return x * x * x * sum;
  }

  bool known_;
  table survival_;
};

static_assert(radial_family<user_density>);

}  // namespace microfacet
