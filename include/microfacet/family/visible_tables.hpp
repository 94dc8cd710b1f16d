// Two inverses that start the iterations of smith/visible_tails.hpp, as piecewise polynomials: nothing hangs
// on their last digits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "microfacet/core/math.hpp"
#include "microfacet/core/piecewise.hpp"
#include "microfacet/core/piecewise_fit.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet {

namespace detail {

// What the tables hold, of a family in double precision.
template <class Family>
class visible_samples {
  using R = typename Family::scalar;

 public:
  explicit visible_samples(const Family& family)
      : family_(family), all_(moment(R(0))), inverse_peak_(R(1) / P2(R(0))) {}

  // Calls: the functions of a family are long.
  [[gnu::noinline]] R P2(const R& t) const { return family_.P2(slope<R>(t)); }
  [[gnu::noinline]] R moment(const R& t) const {
    return family_.slope_excess(slope<R>(t)) + t * family_.slope_sf(slope<R>(t));
  }
  // Newton's method on logarithms.
  R moment_radius(const R& L) const {
    const R odds = elementary::exp(L), target = log(all_) - log(R(1) + odds);
    R y = R(0.5) * (log(R(2) * all_ / maximum(P2(R(sqrt(all_))), R(1e-3))) + log(log1p(odds)));
    for (int i = 0; i < 60; ++i) {
      const R t = elementary::exp(y), m = moment(t);
      const R change = (log(m) - target) * m / maximum(R(t * t * P2(t)), R(1e-300));
      y = y + minimum(maximum(change, R(-1)), R(1));
    }
    return elementary::exp(y);
  }
  R marginal_radius(const R& L) const {
    const R target = -log(elementary::exp(L) + inverse_peak_), h(1e-4);
    R y(0);
    for (int i = 0; i < 80; ++i) {
      const R value = log(P2(elementary::exp(y))), slope = (value - log(P2(elementary::exp(R(y + h))))) / h;
      y = y + minimum(maximum(R((value - target) / maximum(slope, R(1e-6))), R(-1)), R(1));
    }
    return elementary::exp(y);
  }
  double all() const { return number(all_); }
  double inverse_peak() const { return number(inverse_peak_); }
  double at(double t) const { return number(P2(R(t))); }

 private:
  static double number(const R& r) {
    double x;
    std::memcpy(&x, &r, sizeof x);
    return x;
  }
  const Family& family_;
  R all_, inverse_peak_;
};

}  // namespace detail

template <class T>
class visible_tables {
  static constexpr bool single = sizeof(T) == 4;

 public:
  using table = piecewise<T, single ? 8 : 18>;

  table moment_radius;             // t at M(0)/M(t) - 1, M(t) = int_t^inf y P2(y) dy
  table marginal_radius;           // t at 1/P2(t) - 1/P2(0)
  T first_moment{}, inverse_P2{};  // M(0) and 1/P2(0)
  bool falls = true;               // whether P2 decreases everywhere

  // From a family in double precision; in_lanes(x, f, n, function) calls a function of its scalars.
  template <class Family, class InLanes>
  void build(const Family& family, const InLanes& in_lanes) {
    using R = typename Family::scalar;
    const detail::visible_samples<Family> samples(family);
    first_moment = static_cast<T>(samples.all()), inverse_P2 = static_cast<T>(samples.inverse_peak());
    falls = true;
    for (double t = 1e-3; t < 1e3; t *= 1.2) falls = falls && samples.at(t) >= samples.at(1.2 * t);
    const auto fill = [&](table& t, const auto& function, double lower) {
      const auto sample = [&](const double* L, double* f, std::size_t n) { in_lanes(L, f, n, function); };
      t = piecewise_fit<table>(sample, {lower, 60, lower + 2, 0, 1e-30, 50.0})();
    };
    fill(moment_radius, [&](const R& L) { return samples.moment_radius(L); }, -1);
    const double peak = samples.inverse_peak(), least = peak > 1e-290 ? 0.02 * peak : 1 / samples.at(1e-8);
    fill(marginal_radius, [&](const R& L) { return samples.marginal_radius(L); }, std::log(least));
  }
};

}  // namespace microfacet
