// Visible normals without continuity in the uniforms, for random walks. Folded over the sign of the slope P
// in the plane of incidence, what a direction x = cot(theta) sees is
//
//   max(0, x + P) + max(0, x - P) = 2 max(x, 0) + max(0, |P| - |x|),
//
// so that with the probability of the area that it sees from below, xi0 small, the slope is one that -|x|
// sees, else one of all slopes, turned towards x where x sees too little of it. What -|x| sees has the weight
// max(0, P - |x|) = int_{|x|}^P dg: with J = mean_excess and M(t) = int_t^inf y P2(y) dy it is drawn in two
// steps,
//
//   J(g)/g = xi J(|x|)/|x|   and then   M(P) = xi' M(g),   P > g > |x|,
//
// both inverses of functions of one variable: polynomials, where the other scheme has to iterate.
#pragma once

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"

namespace microfacet {

namespace detail {

template <class T>
struct uniforms {
  T xi[4];
};

// Composes two inverses from tables, as far as these reach.
template <class Family, class T, class Mask>
visible_slopes<T> composed_from_below(const Family& family, const T& X, const T& excess, const T& part,
                                      const uniforms<T>& u, const Mask& reached) {
  const T least = maximum(family.excess_radius(X / maximum(T(excess * part), smallest<T>())), X);
  const T along = family.moment_beyond(least, u.xi[1]);
  return {nan_unless(reached, along), family.across_of_tables(along, u.xi[2], u.xi[3])};
}
// g > X with J(g)/g = part J(X)/X, by Newton's method in s = log(g/X), in which log(J/g) is concave: it falls by M(g)/J(g).
// The start lies beyond the solution, since J(g) <= J(X) and J(g) <= M(g).
template <class Family, class T>
T excess_radius_by_newton(const Family& family, const T& X_argument, const T& part) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T X = maximum(X_argument, T(single ? 1e-15 : 1e-150)), depth = -log(part);
  const T at_X = family.excess_over_density(X, family.sf_over_density(X));
  const T moment = family.moment_over_density(X, at_X);
  const T beyond = family.moment_radius(X, T(depth + log(moment / at_X)));
  const T s = iterate(30, minimum(depth, T(log1p(beyond / X))), depth == depth, [&](const T& now) {
    const T v = X * expm1(now), g = X + v, excess = family.excess_over_density(g, family.sf_over_density(g));
    const T residual = depth - now - family.log_density_ratio(X, v) + log(excess / at_X);
    const T change = residual * excess / family.moment_over_density(g, excess);
    return iteration{maximum(T(now + change), T(0)), abs(change) > T(single ? 3e-4 : 1e-8)};
  });
  return X + X * expm1(s);
}
template <class Family, class T>
visible_slopes<T> seen_from_below(const Family& family, const T& X, const T& excess, const T& part,
                                  const uniforms<T>& u) {
  if constexpr (always_composes<Family>) {
    return composed_from_below(family, X, excess, part, u, excess > T(1e-30));
  } else if constexpr (records<T> && tail_quotients<Family> && mixture_sampling<Family>) {
    const T along = family.moment_beyond(excess_radius_by_newton(family, X, part), u.xi[1]);
    return {along, family.across_of_tables(along, u.xi[2], u.xi[3])};
  } else if constexpr (starts<Family> && started_inversion<Family>) {
    return start_visible_slopes(family, T(-X), part, u.xi[2], u.xi[3]);
  } else {
    if constexpr (excess_quantile<Family>) {
      if (family.samples_from_tables())
        return composed_from_below(family, X, excess, part, u, tables_reach(family, T(-X)));
    }
    return solve_visible_slopes(family, T(-X), part, u.xi[2], u.xi[3], X == X);
  }
}
template <class Family, class T>
visible_slopes<T> turned_towards(const Family& family, const T& c, const T& rest, const uniforms<T>& u) {
  const T depth = -log(maximum(rest, smallest<T>()));
  const T r = [&] {
    if constexpr (radius_by_survival<Family>) {
      return family.radius_at_survival(maximum(rest, smallest<T>()));
    } else if constexpr (radius_by_depth<Family>) {
      return family.survival_radius(depth);
    } else {
      return visible_tails<Family, T>(family).survival_radius(depth);
    }
  }();
  const elementary::circle<T> azimuth = elementary::cos_sin_of_turns(u.xi[1]);
  const T P = r * azimuth.cosine;
  return {select((P < T(0)) & (u.xi[2] * c < -P), T(-P), P), r * azimuth.sine};
}

template <class Family, class T>
visible_slopes<T> mix_visible_slopes(const Family& family, const T& x, const uniforms<T>& u) {
  const auto up = x > T(0);
  const T X = abs(x), c = select(up, x, T(0)), below = family.mean_excess(slope<T>(X));
  // From above, what tables do not reach is left out: none draws it.
  constexpr double least = sizeof(typename scalar_traits<T>::real) == 4 ? 1e-30 : 0;
  const T seen = select(below > T(least), below, T(0));
  const T share = select(up, T(seen / (c + seen)), T(1)), other = c / (c + below + smallest<T>());
  // At most the share, and positive.
  const auto first = u.xi[0] < share;
  const T part = maximum(T(select(first, u.xi[0], share) / maximum(share, smallest<T>())), smallest<T>());
  // At most 1, whatever rounding says.
  const T rest = select(first, T(1), minimum(T((T(1) - u.xi[0]) / maximum(other, smallest<T>())), T(1)));
  return select_lazy(
      first, [&] { return seen_from_below(family, X, below, part, u); },
      [&] { return turned_towards(family, c, rest, u); });
}

}  // namespace detail

// From Family::mixture_dimensions uniforms; families with closed slopes have this scheme alone.
template <class Family, class T, class Shape>
vec3<T> sample_visible_mixture(const ndf<Family, T, Shape>& distribution, const vec3<T>& w, const T& xi0,
                               const T& xi1, const T& xi2, const T& xi3) {
  const Family& family = distribution.family();
  if constexpr (closed_visible_sampling<Family>) {
    return sample_visible(distribution, w, xi0, xi1, xi2);
  } else {
    const detail::standard_direction<T> seen(distribution.shape(), w);
    const detail::uniforms<T> u{detail::uniform(xi0), detail::uniform(xi1), detail::uniform(xi2),
                                detail::uniform(xi3)};
    const auto mixed = [&] { return detail::mix_visible_slopes(family, seen.x, u); };
    if constexpr (special_slope_sampling<Family>) {
      const auto closed = [&] { return family.closed_slopes(seen.x, u.xi[0], u.xi[1]); };
      return detail::normal_of_visible(distribution.shape(), seen,
                                       select_lazy(family.has_closed_slopes(), closed, mixed));
    } else {
      return detail::normal_of_visible(distribution.shape(), seen, mixed());
    }
  }
}

}  // namespace microfacet
