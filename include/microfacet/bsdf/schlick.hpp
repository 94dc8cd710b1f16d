// Facets that are mirrors of a metal by its reflectance at normal incidence alone (Schlick, An inexpensive BRDF model
// for physically-based rendering, 1994, equation 15): what engines have where indices of refraction are not known.
#pragma once

#include "microfacet/bsdf/conductor.hpp"

namespace microfacet {

template <class T>
T fresnel_schlick(const T& cosine, const T& f0) {
  const T rest = T(1) - minimum(maximum(cosine, T(0)), T(1)), rest2 = rest * rest;
  return multiply_add(T(rest2 * rest2 * rest), T(T(1) - f0), f0);
}

template <class T>
class schlick_conductor : public mirrors<schlick_conductor<T>, T> {
 public:
  static constexpr int parameters = 1, uniforms = 0;

  explicit schlick_conductor(const T& f0) : f0_(f0) {}
  T reflectance(const T& cosine) const { return fresnel_schlick(cosine, f0_); }

 private:
  T f0_;
};

}  // namespace microfacet
