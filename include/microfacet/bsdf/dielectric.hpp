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
  static constexpr bool transmits = true, closed = true;

  // The index of refraction below the surface over that above.
  explicit dielectric(const T& eta)
      : eta_(nan_unless((eta > T(0)) & (eta <= largest<T>()), eta)),
        inverse_(T(1) / eta_),
        interface_(eta_),
        denser_(maximum(eta_, inverse_)) {}
  explicit dielectric(const T* p) : dielectric(p[0]) {}

  // The same facets for light from below, in coordinates that are turned over.
  template <class Mask>
  dielectric flipped(const Mask& below) const {
    return any_lane(below) ? dielectric(select(below, inverse_, eta_)) : *this;
  }

  T eta() const { return eta_; }
  T reflectance(const T& cosine) const { return interface_(cosine).reflected; }
  T transmittance(const T& cosine) const { return interface_(cosine).passed; }

  microfacet::half_vector<T> half_vector(const vec3<T>& wi, const vec3<T>& wo) const {
    return select_lazy(
        wo.z > T(0), [&] { return half_vector_reflection(wi, wo); },
        [&] { return half_vector_transmission(wi, wo, eta_); });
  }
  // The part of the light from wi that one facet m = half_vector(wi, wo) sends to wo, per steradian.
  T phase(const vec3<T>& wi, const vec3<T>& wo, const microfacet::half_vector<T>& m, const T& D,
          const T& inverse_sigma) const {
    return select_lazy(
        wo.z > T(0), [&] { return reflected(m, D, inverse_sigma); },
        [&] { return refracted(wi, wo, m, D, inverse_sigma); });
  }
  T reflected(const microfacet::half_vector<T>& m, const T& D, const T& inverse_sigma) const {
    return share(reflectance(m.cosine), pdf_of_mirrors(D, inverse_sigma));
  }
  // Whether a facet refracts wi into wo: it is seen by both, from its two sides.
  auto refracts(const vec3<T>& wo, const microfacet::half_vector<T>& m) const {
    return (m.cosine > T(0)) & (dot(wo, m.m) < T(0)) & (m.m.z > T(0)) & (eta_ != T(1));
  }
  // Of the two cosines that the directions make with m, the one in the thinner medium determines the other,
  // which changes little with it.
  T refracted(const vec3<T>& wi, const vec3<T>& wo, const microfacet::half_vector<T>& m, const T& D,
              const T& inverse_sigma) const {
    const T before = m.cosine, behind = -dot(wo, m.m);
    const auto to_denser = eta_ >= T(1);
    const T thin = select(to_denser, before, behind);
    const fresnel_split<T> split = denser_(thin);
    const T cosine = select(to_denser, thin, split.cosine), cosine_t = select(to_denser, split.cosine, thin);
    const T density = cosine * D * inverse_sigma * refraction_jacobian(cosine, cosine_t, eta_);
    return select(refracts(wo, m), share(split.passed, density), unrefracted(wi, wo));
  }
  // What is sent to wo where no facet refracts: an interface of equal indices deflects nothing, and all goes
  // to -wi, whose density is infinite.
  T unrefracted(const vec3<T>& wi, const vec3<T>& wo) const {
    const auto straight = (eta_ == T(1)) & (wo.x == -wi.x) & (wo.y == -wi.y) & (wo.z == -wi.z);
    return select(straight, T(inf), T(T(0) * (eta_ + wo.z)));
  }
  // Reflects or refracts, each with its own probability, as the first uniform number says.
  scattered<T> scatter(const vec3<T>& wi, const vec3<T>& m, const T& xi, const T&) const {
    const fresnel_split<T> at = interface_(dot(wi, m));
    // Also for xi = 1, but where all is reflected.
    const decltype(xi < xi) passed = ((xi >= at.reflected) & (at.reflected < T(1))) | (eta_ == T(1));
    const vec3<T> through = refract(wi, m, eta_, at.cosine);
    const T weight = T(1) + T(0) * at.reflected;
    return {select(passed, select(eta_ == T(1), scaled(wi, T(-1)), through), reflect(wi, m)), weight, passed};
  }

 private:
  T eta_, inverse_;
  dielectric_interface<T> interface_, denser_;  // the latter from the thinner medium
};

}  // namespace microfacet
