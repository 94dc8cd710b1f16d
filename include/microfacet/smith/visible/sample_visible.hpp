// Normals as a direction sees them, with density max(0, w . m) D(m)/sigma(w), for directions above and below
// the horizon: stretch the direction, turn it into the plane y = 0, draw the slope in that plane and the one
// across it, and go back (Heitz and d'Eon, Importance sampling microfacet-based BSDFs using the distribution
// of visible normals, 2014).
//
// A family may draw both slopes at once (visible_slopes_of), or the facet (visible_facet). Otherwise the
// slope P in the plane comes from smith/visible/inversion.hpp. For the one across it the density of slopes is
// taken for the projection of an isotropic one in three dimensions: given P its length R has the survival
// function P2(R)/P2(|P|), and the rest is uniform on a circle, so that
//
//   Q = cos(pi xi2) sqrt(R^2 - P^2).
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/visible/direction.hpp"
#include "microfacet/smith/visible/inversion.hpp"
#include "microfacet/smith/visible/started.hpp"
#include "microfacet/smith/visible/tails.hpp"

namespace microfacet {

namespace detail {

// Whether tables in float32 reach as far below the horizon as x; otherwise nan is drawn, and the caller may
// draw in double.
template <class Family, class T>
auto tables_reach(const Family& family, const T& x) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  if constexpr (single) {
    return (x > T(0)) | (family.mean_excess(slope<T>(abs(x))) > T(1e-30));
  } else {
    return x == x;
  }
}

// The slope across the plane of incidence, given that in it.
template <class Family, class T>
T slope_across(const Family& family, const T& along, const T& xi1, const T& xi2) {
  if constexpr (quantile_across<Family>) {
    return family.across_by_quantile(xi1);
  } else {
    const T valid = nan_unless((xi2 >= T(0)) & (xi2 < T(1)), xi2);
    const auto by_length = [&] {
      return T(family.across(along, T(-log1p(-xi1))) *
               elementary::cos_sin_of_turns(T(T(0.5) * valid)).cosine);
    };
    if constexpr (requires { family.lifts(along); }) {
      const auto by_integral = [&] {
        return T(select(valid < T(0.5), T(1), T(-1)) * family.across_by_integral(along, xi1) +
                 (valid - valid));
      };
      return select_lazy(family.lifts(along), by_length, by_integral);
    } else {
      return by_length();
    }
  }
}

// A call, so that what surrounds it stays short.
template <class Family, class T, class Mask>
[[gnu::noinline]] visible_slopes<T> solve_visible_slopes(const Family& family, const T& x, const T& xi0,
                                                         const T& xi1, const T& xi2, const Mask& below) {
  const auto from = [&](const auto& tails) -> visible_slopes<T> {
    T least = smallest<T>();
    if constexpr (requires { tails.least_share(); }) least = tails.least_share();
    const T along = visible_slope(tails, x, T(maximum(xi0, least)), below);
    return {along, slope_across(tails, along, xi1, xi2)};
  };
  if constexpr (tail_quotients<Family>) {
    return from(family);
  } else {
    const visible_slopes<T> s = from(visible_tails<Family, T>(family));
    return {nan_unless(tables_reach(family, x), s.along), s.across};
  }
}

// By a start and one step, in float32.
template <class Family>
concept starts = sizeof(typename scalar_traits<typename Family::scalar>::real) == 4 &&
                 (started_inversion<Family> || requires(const Family f) { f.visible().start.steps; });
template <class Family, class T>
MICROFACET_INLINE visible_slopes<T> start_visible_slopes(const Family& family, const T& x, const T& xi0,
                                                         const T& xi1, const T& xi2) {
  if constexpr (started_inversion<Family>) {
    const T along = started_slope<Family, T>(family)(x, maximum(xi0, smallest<T>()));
    return {along, family.across_by_quantile(xi1)};
  } else {
    using tails = visible_tails<Family, T>;
    const T along = started_slope<tails, T>(tails(family))(x, maximum(xi0, tails::least_share()));
    const T valid = nan_unless((xi2 >= T(0)) & (xi2 < T(1)), xi2);
    return {along, family.across_of_tables(T(abs(along)), xi1, valid)};
  }
}

template <class Family, class T>
MICROFACET_INLINE visible_slopes<T> draw_visible_slopes(const Family& family, const T& x, const T& xi0,
                                                        const T& xi1, const T& xi2) {
  const auto solved = [&] { return solve_visible_slopes(family, x, xi0, xi1, xi2, x <= T(0)); };
  if constexpr (slope_sampling<Family>) {
    return family.visible_slopes_of(x, xi0, xi1, xi2);
  } else if constexpr (special_slope_sampling<Family>) {
    return select_lazy(family.has_closed_slopes(), [&] { return family.closed_slopes(x, xi0, xi1); }, solved);
  } else if constexpr (starts<Family>) {
    if constexpr (requires { family.visible(); }) {
      if (family.visible().start.steps == 0) return solved();
    }
    return start_visible_slopes(family, x, xi0, xi1, xi2);
  } else {
    return solved();
  }
}

template <class T>
T uniform(const T& xi) {
  return nan_unless((xi >= T(0)) & (xi < T(1)), xi);
}

}  // namespace detail

// From two or three uniforms (Family::visible_dimensions); the result is continuous in them where the family
// has such a scheme.
template <class Family, class T, class Shape>
vec3<T> sample_visible(const ndf<Family, T, Shape>& distribution, const vec3<T>& w, const T& xi0,
                       const T& xi1, const T& xi2) {
  const Family& family = distribution.family();
  const T u = detail::uniform(xi0), v = detail::uniform(xi1);
  if constexpr (facet_sampling<Family>) {
    const detail::unit_direction<T> seen(distribution.shape(), w);
    return detail::normal_of_facet(distribution.shape(), seen, family.visible_facet(seen.w, u, v));
  } else {
    const detail::standard_direction<T> seen(distribution.shape(), w);
    const visible_slopes<T> slopes = detail::draw_visible_slopes(family, seen.x, u, v, xi2);
    return detail::normal_of_visible(distribution.shape(), seen, slopes);
  }
}

}  // namespace microfacet
