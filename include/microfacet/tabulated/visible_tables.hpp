// Tables that visible normals take besides the functions of a density. In float32 these tables alone draw them
// (smith/visible/sample_visible_mixture.hpp); in float64 the inverses of differences lack digits, and start the
// iterations of smith/visible/tails.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <variant>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/approx/piecewise.hpp"
#include "microfacet/approx/piecewise_fit.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/tabulated/radial_samples.hpp"
#include "microfacet/tabulated/radial_shells.hpp"
#include "microfacet/tabulated/visible_start.hpp"

namespace microfacet {

namespace detail {

// What the tables hold, of a family in double precision.
template <class Family>
class visible_samples {
  using R = typename Family::scalar;

 public:
  explicit visible_samples(const Family& family) : family_(family), all_(moment(R(0))) {
    // The mean length of a slope along an axis; a density of a user's is known to some digits.
    const double mean = 2 * all(), step = 1.05;
    for (double t = 1e-3 * mean; t < 1e3 * mean; t *= step)
      if (!(at(t) * (1 + 1e-10) >= at(step * t))) fall_ = step * step * t;
    inverse_peak_ = R(1) / P2(R(fall_));
  }

  // Calls: the functions of a family are long.
  [[gnu::noinline]] R P2(const R& t) const { return family_.P2(slope<R>(t)); }
  [[gnu::noinline]] R moment(const R& t) const {
    return family_.mean_excess(slope<R>(t)) + t * family_.slope_sf(slope<R>(t));
  }
  // Each by Newton's method on logarithms.
  R moment_radius(const R& L) const {
    const R odds = elementary::exp(L), target = log(all_) - log(R(1) + odds);
    const R start = R(0.5) * (log(R(2) * all_ / maximum(P2(R(sqrt(all_))), R(1e-3))) + log(log1p(odds)));
    return solve(120, start, 1e-12, [&](const R& y) {
      const R t = elementary::exp(y), m = maximum(moment(t), R(1e-300));
      return R((log(m) - target) * m / maximum(R(t * t * P2(t)), R(1e-300)));
    });
  }
  R excess_radius(const R& L) const {
    const R start = minimum(R(L + log(all_)), R(R(0.5) * log(log1p(exp(minimum(L, R(600)))))));
    return solve(60, start, 1e-12, [&](const R& y) {
      const R t = elementary::exp(y), J = maximum(family_.mean_excess(slope<R>(t)), R(1e-300));
      return R((L + log(J) - y) / (R(1) + t * family_.slope_sf(slope<R>(t)) / J));
    });
  }
  R marginal_radius(const R& L) const {
    const R target = -log(elementary::exp(L) + inverse_peak_), h(1e-4);
    return solve(80, R(log(maximum(R(2) * all_, R(1.5 * fall_)))), 1e-11, [&](const R& y_argument) {
      const R y = maximum(y_argument, R(fall_ > 0 ? std::log(fall_) : -700));
      const R value = log(P2(elementary::exp(y))), slope = (value - log(P2(elementary::exp(R(y + h))))) / h;
      return R((value - target) / maximum(slope, R(1e-6)));
    });
  }
  double of_square(double y) const { return first_lane(family_.P22(double_double<R>(R(y)))); }
  double beyond(double above) const {
    return first_lane(radial_samples<Family>(family_).radius(R(std::log((1 - above) / above))));
  }
  double fall() const { return fall_; }
  double all() const { return first_lane(all_); }
  double inverse_peak() const { return first_lane(inverse_peak_); }
  double at(double t) const { return first_lane(P2(R(t))); }

 private:
  // exp(y) where change(y), the step that Newton's method proposes, is next to nothing. A step that ends too far, where
  // a light tail has no numbers any more, leaves a bound.
  template <class Change>
  static R solve(int most, const R& start, double settled, const Change& change) {
    using states = std::array<R, 2>;
    const states y = iterate(most, states{start, R(800)}, start == start, [&](const states& now) {
      const R proposed = change(now[0]), step = select(proposed == proposed, proposed, R(-1));
      const R bound = select(step < R(0), minimum(now[0], now[1]), now[1]);
      const R to = now[0] + minimum(maximum(step, R(-1)), R(1));
      return iteration{states{select(to <= bound, to, R(R(0.5) * (now[0] + bound))), bound},
                       abs(step) > R(settled)};
    });
    return elementary::exp(y[0]);
  }

  const Family& family_;
  R all_, inverse_peak_;
  double fall_ = 0;
};

}  // namespace detail

template <class T, class Location = by_map<T>>
class visible_tables {
  static constexpr bool single = sizeof(T) == 4, searches = Location::searches;

 public:
  using table = piecewise<T, single || searches ? 8 : 18, Location>;

  table moment;                    // M(t) = int_t^inf y P2(y) dy at t
  table moment_radius;             // t at M(0)/M(t) - 1
  table marginal_radius;           // t > fall at 1/P2(t) - 1/P2(fall)
  table excess_radius;             // t at t/mean_excess(t)
  T first_moment{}, inverse_P2{};  // M(0) and 1/P2(fall)
  T fall{};                        // P2 decreases from here on
  bool complete = false;           // whether visible normals can be drawn from the tables alone
  std::conditional_t<single && !searches, visible_start, std::monostate>
      start;                // of the inversion in float32
  radial_shells<T> shells;  // the slope across, given one below `fall`

  bool falls() const { return fall == 0; }

  // From a family in double precision; any density, where `any`. One that ends in an edge has no digits there to
  // invert, and nothing beyond its shells.
  template <class Family>
  void build(const Family& family, bool any = false, bool ends_in_edge = false) {
    using R = typename Family::scalar;
    const detail::visible_samples<Family> samples(family);
    first_moment = static_cast<T>(samples.all()), inverse_P2 = static_cast<T>(samples.inverse_peak());
    fall = static_cast<T>(samples.fall());
    const double mean = 2 * samples.all(), at_middle = (std::max)(mean, 2 * samples.fall());
    const auto fill = [&](table& t, const auto& function, fit_range range) {
      range.any = any;
      const auto sample = [&](const double* L, double* f, std::size_t n) {
        detail::in_lanes<R>(L, f, n, function);
      };
      t = piecewise_fit<table>(sample, range)();
    };
    // Heavy tails are powers by exp(60), light ones go on.
    const auto fill_far = [&](table& t, const auto& function, fit_range range) {
      range.upper = single ? 86 : 60;
      fill(t, function, range);
      if (t.error < 1) return;
      range.upper = 60;
      fill(t, function, range);
    };
    constexpr double tiny = static_cast<double>((std::numeric_limits<T>::min)()), central = single ? 20 : 50,
                     least = single ? -87 : -700;
    // Near 0 the inverses of differences have the digits of float32 alone.
    const double peak = samples.inverse_peak(), smallest = single ? 1e-6 : 0.02;
    const double middle = std::log(1 / samples.at(at_middle) - peak);
    const double from =
        (std::min)(std::log(peak > 1e-290 ? smallest * peak : 1 / samples.at(1e-8 * mean)), middle - 1);
    fill_far(moment_radius, [&](const R& L) { return samples.moment_radius(L); },
             {single ? -14.0 : -1.0, 60, 1, 0, 1e-30, 50});
    fill_far(marginal_radius, [&](const R& L) { return samples.marginal_radius(L); },
             {from, 60, middle, samples.fall(), 1e-9 * mean, 50});
    if (ends_in_edge) fall = largest<T>();
    if (!falls())
      shells.build([&](double y) { return samples.of_square(y); },
                   [&](double above) { return samples.beyond(above); });
    if constexpr (single) {
      fill(moment, [&](const R& L) { return samples.moment(R(elementary::exp(L))); },
           {least, 20, least, samples.all(), tiny, central});
      fill_far(excess_radius, [&](const R& L) { return samples.excess_radius(L); },
               {least, 60, 0, 0, tiny, 20});
      complete = true;
      for (const table* t : {&moment, &moment_radius, &marginal_radius, &excess_radius})
        complete = complete && t->error < 2e-6;
    }
  }
};

}  // namespace microfacet
