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
vec3<T> normalize(const vec3<T>& a) {
  return scaled(a, T(T(1) / sqrt(dot(a, a))));
}
template <class T, class Mask>
vec3<T> select(const Mask& mask, const vec3<T>& a, const vec3<T>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// Normalises w, of any length but 0; gives nan along 0 and along what is no number. Leaves a direction alone
// whose squared length is 1 to `tolerance`, a few roundings, so that directions which this library made stay
// as they are.
template <class T>
vec3<T> normalize(const vec3<T>& w, const T& tolerance) {
  const auto near_1 = abs(T(dot(w, w) - T(1))) <= tolerance;
  return select_lazy(
      near_1, [&] { return w; },
      [&] {
        // By the largest component first: its square may be no number.
        const T largest = maximum(T(maximum(T(abs(w.x)), T(abs(w.y)))), T(abs(w.z)));
        return normalize(vec3<T>{w.x / largest, w.y / largest, w.z / largest});
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
  return normalize(axpy(scaled(w, T(-above)), m, T(dot(w, m) * above - below * cosine_t)));
}

// Beyond this index of refraction wi no longer matters to the facet.
template <class T>
T largest_index() {
  return T(0x1p60);
}
// The normal of the facet that takes one direction to another, and the cosine that the first one makes with
// it.
template <class T>
struct half_vector {
  vec3<T> m;
  T cosine;
};
template <class T, class Mask>
half_vector<T> select(const Mask& mask, const half_vector<T>& a, const half_vector<T>& b) {
  return {select(mask, a.m, b.m), select(mask, a.cosine, b.cosine)};
}
// Gives the facet that reflects wi into wo. Its normal is wi + wo as it stands, since distributions look at
// slopes alone; the length of that is twice the cosine. wo = -wi has no such facet, and 0 is a normal of
// density 0.
template <class T>
half_vector<T> half_vector_reflection(const vec3<T>& wi, const vec3<T>& wo) {
  const vec3<T> sum = axpy(wi, wo, T(1));
  return {sum, T(T(0.5) * sqrt(dot(sum, sum)))};
}
// Gives the facet that refracts wi into wo, of unit length, on the side of wi; such a facet exists where wo
// lies on its other side. Where wi + eta wo is 0 the normal is one that no facet has.
template <class T>
half_vector<T> half_vector_transmission(const vec3<T>& wi, const vec3<T>& wo, const T& eta) {
  const vec3<T> sum = axpy(wi, wo, minimum(eta, largest_index<T>()));
  const T length2 = dot(sum, sum), along = dot(wi, sum);
  const auto none = length2 < smallest<T>();
  const T inverse = select(along < T(0), T(-1), T(1)) / sqrt(select(none, T(1), length2));
  const vec3<T> m = select(none, vec3<T>{T(0), T(0), T(-1)}, scaled(sum, inverse));
  return {m, dot(wi, m)};
}

// Normals per direction out, |dm/dwo|, of refraction (Walter et al., Microfacet models for refraction through rough
// surfaces, 2007, equation 17): eta^2 cosine_t/(cosine - eta cosine_t)^2, from the cosines before and behind the facet,
// both >= 0. Where the indices are almost the same the difference is a quotient,
// (1 - eta)(1 + eta)/(cosine + eta cosine_t).
template <class T>
T refraction_jacobian(const T& cosine, const T& cosine_t, const T& eta) {
  const T n = minimum(eta, largest_index<T>()), root = n * cosine_t;
  const T reciprocal = (cosine + root) / ((T(1) - n) * (T(1) + n));
  return (n * reciprocal) * (root * reciprocal);
}

}  // namespace microfacet
