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

template <class T>
class visible_tables {
  static constexpr bool single = sizeof(T) == 4;

 public:
  using table = piecewise<T, single ? 8 : 18>;

  table moment_radius;    // t at M(0)/M(t) - 1, M(t) = int_t^inf y P2(y) dy
  table marginal_radius;  // t at 1/P2(t) - 1/P2(0)
  T first_moment{}, inverse_P2{};  // M(0) and 1/P2(0)
  bool falls = true;               // whether P2 decreases everywhere

  // From a family in double precision, scalar or pack. In lanes: visit(x, f, n, function) as in_lanes does.
  template <class Family, class InLanes>
  void build(const Family& family, const InLanes& in_lanes) {
    using R = typename Family::scalar;
    const auto number = [](const R& r) {
      double x;
      std::memcpy(&x, &r, sizeof x);
      return x;
    };
    const auto P2 = [&](const R& t) { return R(family.P2(slope<R>(t))); };
    const auto moment = [&](const R& t) {
      return R(family.slope_excess(slope<R>(t)) + t * family.slope_sf(slope<R>(t)));
    };
    const double all = number(family.slope_excess(slope<R>(R(0)))), peak = number(P2(R(0)));
    first_moment = static_cast<T>(all), inverse_P2 = static_cast<T>(1 / peak);

    falls = true;
    for (double t = 1e-3; t < 1e3; t *= 1.2) falls = falls && number(P2(R(t))) >= number(P2(R(1.2 * t)));

    // Newton's method on logarithms; what falls by a power falls steeper the farther out.
    const auto by_moment = [&](const R& L) {
      const R target = log(R(all)) - log(R(1) + elementary::exp(L));
      R y = R(0.5) * (log(R(2 * all) / maximum(P2(R(sqrt(all))), R(1e-3))) + log(log1p(elementary::exp(L))));
      for (int i = 0; i < 60; ++i) {
        const R t = elementary::exp(y), m = moment(t);
        const R change = (log(m) - target) * m / maximum(R(t * t * P2(t)), R(1e-300));
        y = y + minimum(maximum(change, R(-1)), R(1));
      }
      return elementary::exp(y);
    };
    const auto by_marginal = [&](const R& L) {
      const R target = -log(elementary::exp(L) + R(1 / peak));
      R y(0);
      for (int i = 0; i < 80; ++i) {
        const R value = log(P2(elementary::exp(y))), h(1e-4);
        const R slope = (value - log(P2(elementary::exp(R(y + h))))) / h;
        y = y + minimum(maximum(R((value - target) / maximum(slope, R(1e-6))), R(-1)), R(1));
      }
      return elementary::exp(y);
    };
    const auto fill = [&](table& t, const auto& function, double lower, double upper) {
      const auto sample = [&](const double* L, double* f, int n) { in_lanes(L, f, n, function); };
      t = piecewise_fit<table, decltype(sample)>(sample, {lower, upper, lower + 2, 0, 1e-30, 50.0})();
    };
    fill(moment_radius, by_moment, -1, 60);
    const double least = peak < 1e300 ? 0.02 / peak : 1 / number(P2(R(1e-8)));
    fill(marginal_radius, by_marginal, std::log(least), single ? 60 : 120);
  }
};

}  // namespace microfacet
