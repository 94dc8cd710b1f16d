// One step of the random walk of light on a Smith microsurface, without approximation (Heitz, Hanika, d'Eon
// and Dachsbacher, Multiple-scattering microfacet BSDFs with the Smith model, 2016; d'Eon, A Hitchhiker's
// Guide to Multiple Scattering).
//
// With depth = -log of the share of heights below, Smith's surface is a half-space in which light towards w
// meets facets at the rate sigma(-w) per length and leaves upwards at depth 0; heights have the uniform
// distribution, on which nothing depends. Light that passes a facet goes on in coordinates that are turned
// over (w -> -w), in which the share of heights below is 1 minus what it was.
#pragma once

#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// The depth after a flight towards w, of which w_z and sigma = sigma(-w) are given; negative for light that
// has left. Optical lengths are exponential.
template <class T>
T depth_after(const T& depth, const T& w_z, const T& sigma, const T& xi) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T least(single ? 0x1p-25 : 0x1p-54);  // so that light that sees no facet leaves
  return depth + w_z * (log1p(T(-maximum(xi, least))) / maximum(sigma, smallest<T>()));
}
// The probability to leave towards w from a depth without meeting a facet; sigma = sigma(-w).
template <class T>
T escape(const T& depth, const T& w_z, const T& sigma) {
  return select(w_z > T(0), exp(-depth * sigma / maximum(w_z, smallest<T>())), T(0));
}
// The same place, in coordinates that are turned over.
template <class T>
T depth_from_below(const T& depth) {
  return -log(maximum(T(-expm1(-depth)), smallest<T>()));
}

// The probability to go on after `met` facets of light whose brightest colour has this throughput. Russian
// roulette: faint light goes on seldom, with more weight; so does any, after very many facets.
template <class T>
T chance_to_go_on(const T& throughput, const T& met) {
  const T faint = minimum(maximum(T(throughput * T(4)), T(0.05)), T(1));
  return select(met >= T(1024), T(0.5), select(met >= T(4), faint, T(1)));
}

// Light behind a facet, in coordinates that are turned over where it passed.
template <class T>
struct light_behind {
  vec3<T> w;
  T depth, factor;  // what roulette makes of its throughput, 0 where it ends
};
// w and passed: what the facet did with the light; throughput: what is left of its brightest colour; met: how
// many facets it had met before.
template <class T, class Mask>
light_behind<T> behind_facet(const vec3<T>& w, const Mask& passed, const T& depth, const T& throughput,
                             const T& met, const T& xi) {
  const T chance = chance_to_go_on(throughput, met);
  return {scaled(w, T(select(passed, T(-1), T(1)))), select(passed, depth_from_below(depth), depth),
          select(xi < chance, T(T(1) / chance), T(0))};
}

// Where light is wanted, as the side on which it leaves names the direction, and the area in its way.
template <class T>
struct walk_target {
  vec3<T> w;
  T sigma_out;

  // The direction in the coordinates of light that has yet to cross the surface, or not.
  template <class Mask>
  vec3<T> seen_from(const Mask& crosses) const {
    return scaled(w, T(select(crosses, T(-1), T(1))));
  }
  template <class Mask>
  T reached_from(const T& depth, const Mask& crosses) const {
    return escape(T(select(crosses, depth_from_below(depth), depth)), w.z, sigma_out);
  }
};

}  // namespace microfacet
