// Directions that a facet sends into each other. All point away from it.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

template <class T>
vec3<T> scaled(const vec3<T>& a, const T& factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}
// a + factor b
template <class T>
vec3<T> axpy(const vec3<T>& a, const vec3<T>& b, const T& factor) {
  return {multiply_add(factor, b.x, a.x), multiply_add(factor, b.y, a.y), multiply_add(factor, b.z, a.z)};
}
template <class T>
vec3<T> unit(const vec3<T>& a) {
  return scaled(a, T(T(1) / sqrt(dot(a, a))));
}
template <class T, class Mask>
vec3<T> select(const Mask& mask, const vec3<T>& a, const vec3<T>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// The direction along w, of any length but 0; nan along 0 and along what is no number. A length that is 1 to
// `tolerance`, some roundings, is left alone: a direction of ours is taken as it is.
template <class T>
vec3<T> normalized(const vec3<T>& w, const T& tolerance) {
  const auto near_1 = abs(T(dot(w, w) - T(1))) <= tolerance;
  return select_lazy(
      near_1, [&] { return w; },
      [&] {
        // By the largest component first: its square may be no number.
        const T largest = maximum(T(maximum(T(abs(w.x)), T(abs(w.y)))), T(abs(w.z)));
        return unit(vec3<T>{w.x / largest, w.y / largest, w.z / largest});
      });
}

// The mirror image of w about the normal m.
template <class T>
vec3<T> reflect(const vec3<T>& w, const vec3<T>& m) {
  return axpy(scaled(w, T(-1)), m, T(T(2) * dot(w, m)));
}

// The direction in which light from w passes on, where cosine_t is the cosine behind the facet
// (fresnel_dielectric). Of unit length whatever rounding made of w, so that walks do not drift. The law of
// refraction is divided by the larger index, so that no eta leaves the range of T.
template <class T>
vec3<T> refract(const vec3<T>& w, const vec3<T>& m, const T& eta, const T& cosine_t) {
  const T above = minimum(T(T(1) / eta), T(1)), below = minimum(eta, T(1));
  return unit(axpy(scaled(w, T(-above)), m, T(dot(w, m) * above - below * cosine_t)));
}

// Beyond this index of refraction wi no longer matters to the facet.
template <class T>
T largest_index() {
  return T(0x1p60);
}
// A normal along h; where there is none, one that no facet has.
template <class T>
vec3<T> facet_along(const vec3<T>& h) {
  const T length2 = dot(h, h);
  const auto none = length2 < smallest<T>();
  return select(none, vec3<T>{T(0), T(0), T(-1)}, scaled(h, T(T(1) / sqrt(select(none, T(1), length2)))));
}
// The normal of the facet that reflects wi into wo.
template <class T>
vec3<T> reflecting_facet(const vec3<T>& wi, const vec3<T>& wo) {
  return facet_along(axpy(wi, wo, T(1)));
}
// The one that refracts wi into wo, on the side of wi; there is such a facet where wo lies on its other side.
template <class T>
vec3<T> refracting_facet(const vec3<T>& wi, const vec3<T>& wo, const T& eta) {
  const vec3<T> h = axpy(wi, wo, minimum(eta, largest_index<T>()));
  return facet_along(scaled(h, select(dot(wi, h) < T(0), T(-1), T(1))));
}

// Normals per direction out, |dm/dwo|. Walter et al., Microfacet models for refraction through rough
// surfaces, 2007, equations 14 and 17.
template <class T>
T reflection_jacobian(const vec3<T>& wi, const vec3<T>& m) {
  return T(0.25) / dot(wi, m);
}
// From the cosines before and behind the facet, both >= 0: eta^2 cosine_t/(cosine - eta cosine_t)^2. Where
// the indices are almost the same the difference is a quotient, (1 - eta)(1 + eta)/(cosine + eta cosine_t).
template <class T>
T refraction_jacobian(const T& cosine, const T& cosine_t, const T& eta) {
  const T n = minimum(eta, largest_index<T>()), root = n * cosine_t;
  const T reciprocal = (cosine + root) / ((T(1) - n) * (T(1) + n));
  return (n * reciprocal) * (root * reciprocal);
}

}  // namespace microfacet
