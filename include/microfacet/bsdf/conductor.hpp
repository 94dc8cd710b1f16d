// Facets that are mirrors of a metal.
#pragma once

#include "microfacet/bsdf/fresnel.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "microfacet/bsdf/scattered.hpp"

namespace microfacet {

// What facets do that reflect as Material says, and let nothing pass.
template <class Material, class T>
class mirrors {
 public:
  static constexpr bool transmits = false, closed = true;

  microfacet::half_vector<T> half_vector(const vec3<T>& wi, const vec3<T>& wo) const {
    return half_vector_reflection(wi, wo);
  }
  // The part of the light from wi that the facet m = half_vector(wi, wo) sends to wo, per steradian.
  T phase(const vec3<T>&, const vec3<T>&, const microfacet::half_vector<T>& m, const T& D,
          const T& inverse_sigma) const {
    return share(self().reflectance(m.cosine), pdf_of_mirrors(D, inverse_sigma));
  }
  scattered<T> scatter(const vec3<T>& wi, const vec3<T>& m, const T&, const T&) const {
    return {reflect(wi, m), self().reflectance(dot(wi, m)), wi.z != wi.z};
  }

 private:
  const Material& self() const { return static_cast<const Material&>(*this); }
};

template <class T>
class conductor : public mirrors<conductor<T>, T> {
 public:
  // The indices of refraction of the metal over that of the medium above, eta - i k; eta = inf is a perfect
  // mirror.
  static constexpr int parameters = 2, uniforms = 0;

  conductor(const T& eta, const T& k) : eta_(eta), interface_(eta, k) {}
  explicit conductor(const T* p) : conductor(p[0], p[1]) {}

  T reflectance(const T& cosine) const {
    return select(eta_ > largest<T>(), T(T(1) + T(0) * cosine), interface_(cosine));
  }

 private:
  T eta_;
  metal_interface<T> interface_;
};

}  // namespace microfacet
