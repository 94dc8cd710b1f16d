// Facets of a transparent medium, which reflect and refract.
#pragma once

#include "microfacet/bsdf/fresnel.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "microfacet/bsdf/scattered.hpp"

namespace microfacet {

template <class T>
class dielectric {
 public:
  static constexpr int parameters = 1, uniforms = 1;

  // The index of refraction below the surface over that above.
  explicit dielectric(const T& eta) : eta_(eta) {}
  explicit dielectric(const T* p) : dielectric(p[0]) {}

  // The same facets for light from below, in coordinates that are turned over.
  template <class Mask>
  dielectric turned_over(const Mask& below) const {
    return dielectric(select(below, T(T(1) / eta_), eta_));
  }

  T eta() const { return eta_; }
  T reflectance(const T& cosine) const { return fresnel_dielectric(cosine, eta_).reflected; }

  vec3<T> facet(const vec3<T>& wi, const vec3<T>& wo) const {
    return select(wo.z > T(0), reflecting_facet(wi, wo), refracting_facet(wi, wo, eta_));
  }
  // The part of the light from wi that one facet m = facet(wi, wo) sends to wo, per steradian.
  T phase(const vec3<T>& wi, const vec3<T>& wo, const vec3<T>& m, const facet_statistics<T>& at) const {
    return select(wo.z > T(0), reflected(wi, m, at), refracted(wi, wo, m, at));
  }
  T reflected(const vec3<T>& wi, const vec3<T>& m, const facet_statistics<T>& at) const {
    return share(reflectance(dot(wi, m)), pdf_of_mirrors(at));
  }
  T refracted(const vec3<T>& wi, const vec3<T>& wo, const vec3<T>& m, const facet_statistics<T>& at) const {
    const T cosine = dot(wi, m), passed = T(1) - reflectance(cosine);
    const T density = cosine * at.D / at.area * refraction_jacobian(wi, wo, m, eta_);
    // An interface of equal indices deflects nothing: all goes to -wi, which has no density.
    const auto possible = (cosine > T(0)) & (dot(wo, m) < T(0)) & (eta_ != T(1));
    return select(possible, share(passed, density), T(T(0) * (eta_ + wo.z)));
  }
  // By the first uniform number one of both, with its own probability.
  scattered<T> scatter(const vec3<T>& wi, const vec3<T>& m, const T& xi, const T&) const {
    const fresnel_split<T> at = fresnel_dielectric(dot(wi, m), eta_);
    // Also for xi = 1, but where all is reflected.
    const decltype(xi < xi) passed = (xi >= at.reflected) & (at.reflected < T(1));
    const vec3<T> through = refract(wi, m, eta_, at.cosine);
    const T weight = T(1) + T(0) * at.reflected;
    return {select(passed, select(eta_ == T(1), scaled(wi, T(-1)), through), reflect(wi, m)), weight, passed};
  }

 private:
  // Nothing of a density is nothing, even if it is infinite.
  static T share(const T& part, const T& density) { return select(part == T(0), T(0), T(part * density)); }

  T eta_;
};

}  // namespace microfacet
