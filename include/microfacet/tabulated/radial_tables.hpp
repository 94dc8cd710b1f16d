// The functions of family/radial.hpp for fixed shape parameters as piecewise polynomials, built once from a
// family in double precision and stored in the precision T: a plain value of fixed size. Tables are built and
// judged one by one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "microfacet/approx/piecewise.hpp"
#include "microfacet/approx/piecewise_fit.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/tabulated/radial_samples.hpp"
#include "microfacet/tabulated/visible_tables.hpp"

namespace microfacet {

// The largest relative errors, measured on the tables themselves, near 1 and beyond exp(20) (float) or
// exp(50).
struct radial_error {
  double error = 0, far_error = 0;
};

// Tables that are searched are for densities that are smooth only piecewise.
template <class T, class Location = by_map<T>>
class radial_tables {
 public:
  static constexpr bool single = sizeof(T) == 4, searches = Location::searches, always_composes = false;
  using table = piecewise<T, single || searches ? 8 : 18, Location>;

  table root_D;       // sqrt(P22) (1 + r2) at r2: D(z, h2) = (root_D(h2/z^2)/(z^2 + h2))^2 stays away from 0
  table survival;     // at r2
  table radius;       // at the odds xi/(1 - xi)
  table root_P2;      // the square root of P2 at t > 0
  table slope_sf;     // at t > 0
  table mean_excess;  // at t^2
  visible_tables<T, Location> visible;

  // From a family in double precision, scalar or pack. `any`: it may be any density, which is not known below 1e-284.
  template <class Family>
  void build(const Family& family, unsigned functions = of_all, bool any = Location::searches);

  radial_error error(unsigned functions = of_all) const {
    radial_error e;
    each(functions, [&e](const table& t) {
      e.error = (std::max)(e.error, t.error), e.far_error = (std::max)(e.far_error, t.far_error);
    });
    return e;
  }
  // Whether these functions keep the accuracy contract with a margin. What visible normals need besides does
  // not decide: a table of it that could not be built is nan, and only starts an iteration elsewhere, or the
  // tables are not `complete`.
  bool good(unsigned functions) const {
    const radial_error e = error(functions);
    return e.error <= (single ? 1.8e-6 : 8e-14) && e.far_error <= (single ? 2.5e-5 : 8e-13);
  }

 private:
  template <class Use>
  void each(unsigned functions, const Use& use) const {
    if (functions & of_P22) use(root_D);
    if (functions & of_survival) use(survival);
    if (functions & of_radius) use(radius);
    if (functions & of_P2) use(root_P2);
    if (functions & of_slope_sf) use(slope_sf);
    if (functions & of_mean_excess) use(mean_excess);
  }
};

namespace detail {

// The slope functions of tables in float32, at t >= 0.
struct functions_at_numbers {
  const radial_tables<float>& tables;
  double P2(double t) const { return square(at(tables.root_P2, t)); }
  double slope_sf(double t) const { return at(tables.slope_sf, t); }
  double mean_excess(double t) const { return at(tables.mean_excess, t * t); }
  static double at(const radial_tables<float>::table& table, double x) {
    return static_cast<double>(table(double_double<float>(static_cast<float>((std::min)(x, 1e37)))));
  }
};

}  // namespace detail

template <class T, class Location>
template <class Family>
void radial_tables<T, Location>::build(const Family& family, unsigned functions, bool any) {
  using R = typename Family::scalar;
  // Logarithms of the smallest slope, of its square, and of slopes and squares beyond which all is a power, or
  // of which nobody asks.
  bool slow = false;
  if constexpr (requires { family.slow_tails; }) slow = family.slow_tails;
  const double slope_end = searches ? (single ? 43 : 60) : slow ? (single ? 43 : 138) : (single ? 20 : 40);
  const double square_end = 2 * slope_end;
  constexpr double least = single ? -87 : -700;
  const double tiny = any && !single ? 1e-284 : static_cast<double>((std::numeric_limits<T>::min)()),
               tiny_root = single ? 1e-22
                           : any  ? 1e-142
                                  : 1e-150;
  constexpr double central = single ? 20 : 50;
  // Smaller odds leave an inversion of samples no digits.
  const double least_odds = single ? least
                            : any  ? -680
                                   : -695,
               least_radius = single ? tiny
                              : any  ? 1e-290
                                     : 1e-303;
  const detail::radial_samples<Family> samples(family);
  const auto fill = [any](table& t, const auto& function, fit_range range) {
    range.any = any;
    const auto sample = [&](const double* L, double* f, std::size_t n) {
      detail::in_lanes<R>(L, f, n, function);
    };
    t = piecewise_fit<table>(sample, range)();
  };
  const auto at_zero = [](const R& value) { return detail::first_lane(value); };
  const R zero(0);
  // Any density may vanish towards 0.
  const double middle = any ? 2 * std::log(at_zero(samples.radius(zero))) : least;
  if (functions & of_P22)
    fill(root_D, [&](const R& L) { return samples.root_D(L); },
         {least, square_end, middle, std::sqrt(at_zero(family.P22(double_double<R>(zero)))),
          single || any ? tiny_root : 1e-160, central, !searches});
  if (functions & of_survival)
    fill(survival, [&](const R& L) { return samples.survival(L); },
         {least, square_end, least, 1, tiny, central, !searches});
  if (functions & of_radius)
    fill(radius, [&](const R& L) { return samples.radius(L); },
         {least_odds, single ? 17 : 37, 0, 0, least_radius, central});
  if (functions & of_P2)
    fill(root_P2, [&](const R& L) { return samples.root_P2(L); },
         {least, slope_end, least, std::sqrt(at_zero(family.P2(slope<R>(zero)))), tiny_root, central});
  if (functions & of_slope_sf)
    fill(slope_sf, [&](const R& L) { return samples.slope_sf(L); },
         {least, slope_end, least, 0.5, tiny, central});
  if (functions & of_mean_excess)
    fill(mean_excess, [&](const R& L) { return samples.mean_excess(L); },
         {0.8 * least, square_end, 0.8 * least, at_zero(family.mean_excess(slope<R>(zero))), tiny, central});
  if (functions & of_visible) {
    visible.build(family, any, any && root_P2.error > 1e-4 && root_P2.error < largest<double>());
    if constexpr (single && !searches)
      if (visible.complete) visible.start.build(detail::functions_at_numbers{*this});
  }
}

// Of densities of the user's own.
template <class T>
using user_density_tables = radial_tables<T, by_search<T, 512>>;

}  // namespace microfacet
