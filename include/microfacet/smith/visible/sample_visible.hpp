// Normals as a direction sees them, with density max(0, w . m) D(m)/sigma(w), for directions above and below
// the horizon: stretch the direction, turn it into the plane y = 0, draw the slope in that plane and the one
// across it, and go back (Heitz and d'Eon, Importance sampling microfacet-based BSDFs using the distribution
// of visible normals, 2014).
//
// A family may draw both slopes at once (visible_slopes_of), or the facet (visible_facet). Otherwise the
// slope P in the plane comes from smith/visible/slope.hpp. For the one across it the density of slopes is
// taken for the projection of an isotropic one in three dimensions: given P its length R has the survival
// function P2(R)/P2(|P|), and the rest is uniform on a circle, so that
//
//   Q = cos(pi xi2) sqrt(R^2 - P^2).
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/special/spherical_cap.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/visible/slope.hpp"
#include "microfacet/smith/visible/started.hpp"
#include "microfacet/smith/visible/tails.hpp"

namespace microfacet {

namespace detail {

// A direction in standard space: x = cot(theta), and its azimuth.
template <class T>
struct standard_direction {
  T x, cosine, sine;

  template <class Shape>
  standard_direction(const Shape& shape, const vec3<T>& w) {
    constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
    T a = w.x, b = w.y;
    shape.to_standard(a, b);
    const T length2 = a * a + b * b;
    const auto vertical = length2 < T(single ? 1e-36 : 1e-290);
    const T inverse = T(1) / sqrt(select(vertical, T(1), length2));
    // From far below the horizon only slopes beyond -x are seen.
    const T most = T(single ? 1e9 : 1e15), deepest = T(single ? -1e18 : -1e150);
    cosine = select(vertical, T(1), T(a * inverse));
    sine = select(vertical, T(0), T(b * inverse));
    // Straight down nothing is seen.
    const T top = select(w.z > T(0), most, select(w.z > T(0), w.z, nan<T>()));
    const T x_argument = select(vertical, top, T(w.z * inverse));
    x = select(x_argument > most, most, select(x_argument < deepest, deepest, x_argument));
  }
};

// A direction in standard space of unit length, and its azimuth.
template <class T>
struct unit_direction {
  cap_direction<T> w;
  T cosine, sine;

  template <class Shape>
  unit_direction(const Shape& shape, const vec3<T>& given) {
    constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
    T a = given.x, b = given.y;
    shape.to_standard(a, b);
    const T across2 = a * a + b * b, length2 = across2 + given.z * given.z;
    const auto vertical = across2 < T(single ? 1e-36 : 1e-290);
    const T across = sqrt(select(vertical, T(1), across2)), length = sqrt(length2);
    // Both reciprocals from one quotient. Straight down nothing is seen.
    const T both = T(1) / (across * nan_unless((!vertical) | (given.z > T(0)), length));
    const T per_across = both * length;
    w = {select(vertical, T(0), T(across2 * both)), given.z * across * both, length2 * both};
    cosine = select(vertical, T(1), T(a * per_across)), sine = select(vertical, T(0), T(b * per_across));
  }
};

// The unit normal of a facet (in the plane of w, across it, up) of standard space.
template <class T, class Shape>
vec3<T> normal_of_facet(const Shape& shape, const unit_direction<T>& w, const vec3<T>& m) {
  T x = w.cosine * m.x - w.sine * m.y, y = w.sine * m.x + w.cosine * m.y;
  shape.to_surface(x, y);
  const T inverse = T(1) / sqrt(x * x + y * y + m.z * m.z);
  return {x * inverse, y * inverse, m.z * inverse};
}

// The unit normal of slopes, favourable ones positive, in the frame of a standard direction.
template <class T, class Shape>
vec3<T> normal_of_visible(const Shape& shape, const standard_direction<T>& w, const visible_slopes<T>& s) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T most = T(single ? 1e18 : 1e150);
  T x = w.cosine * s.along - w.sine * s.across, y = w.sine * s.along + w.cosine * s.across;
  shape.to_surface(x, y);
  // Beside slopes whose squares might overflow 1 is nothing.
  const T scale = select(maximum(T(abs(x)), T(abs(y))) > most, T(single ? 1e-12 : 1e-110), T(1));
  x = x * scale, y = y * scale;
  const T z = T(1) / sqrt(T(1) + (x * x + y * y));
  return {x * z, y * z, z};
}

// Whether tables in float32 reach as far below the horizon as x; otherwise nan is drawn, and the caller may
// draw in double.
template <class Family, class T>
auto tables_reach(const Family& family, const T& x) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  if constexpr (single) {
    return (x > T(0)) | (family.slope_excess(slope<T>(abs(x))) > T(1e-30));
  } else {
    return x == x;
  }
}

// A call, so that what surrounds it stays short.
template <class Family, class T>
[[gnu::noinline]] visible_slopes<T> solve_visible_slopes(const Family& family, const T& x, const T& xi0,
                                                         const T& xi1, const T& xi2) {
  const auto from = [&](const auto& tails) -> visible_slopes<T> {
    T least = smallest<T>();
    if constexpr (requires { tails.least_share(); }) least = tails.least_share();
    const T along = visible_slope(tails, x, T(maximum(xi0, least)));
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
MICROFACET_INLINE visible_slopes<T> start_visible_slopes(const Family& family, const T& x, const T& xi0, const T& xi1,
                                                         const T& xi2) {
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
MICROFACET_INLINE visible_slopes<T> draw_visible_slopes(const Family& family, const T& x, const T& xi0, const T& xi1,
                                      const T& xi2) {
  const auto solved = [&] { return solve_visible_slopes(family, x, xi0, xi1, xi2); };
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
