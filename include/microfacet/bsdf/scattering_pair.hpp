// A pair of directions and the facet between them: the one place where density, masking, Fresnel's equations
// and Jacobians come together. A distribution offers D(m) for a normal of any length and sigma(w) for unit
// directions.
#pragma once

#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "microfacet/bsdf/scattered.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// A direction, its weight f |cos wo|/pdf, and its pdf.
template <class T>
struct drawn_direction {
  vec3<T> wo;
  T weight, pdf;
};

// A pair in coordinates in which wi is above: for light from below they are turned over.
template <class Material, class T>
class scattering_pair {
  static constexpr bool transmits = Material::transmits;
  using half = microfacet::half_vector<T>;

 public:
  scattering_pair(const Material& material, const vec3<T>& wi, const vec3<T>& wo)
      : material_(material), wi_(wi), wo_(wo) {
    if constexpr (transmits) {
      turned_ = select(wi.z < T(0), T(-1), T(1));
      material_ = material.flipped(wi.z < T(0)), wi_ = scaled(wi, turned_), wo_ = scaled(wo, turned_);
    }
  }
  // The same with wo as the facet m scatters wi, in these coordinates.
  scattering_pair drawn(const vec3<T>& m, const T& xi) const {
    const scattered<T> s = material_.scatter(wi_, m, xi, xi);
    scattering_pair pair = *this;
    pair.wo_ = select(s.passed, s.w, normalize(s.w)), pair.passed_ = select(s.passed, T(1), T(0));
    return pair;
  }

  const Material& material() const { return material_; }
  const vec3<T>& wi() const { return wi_; }
  const vec3<T>& wo() const { return wo_; }
  // 1 where a drawn pair crosses its facet.
  const T& passed() const { return passed_; }
  // A direction of these coordinates in those of the caller, and back.
  vec3<T> turned(const vec3<T>& w) const { return scaled(w, turned_); }

  half half_vector() const { return material_.half_vector(wi_, wo_); }
  template <class Distribution>
  facet_statistics<T> statistics(const Distribution& ndf, const vec3<T>& m) const {
    return statistics_of(ndf, wi_, wo_, m);
  }
  T phase(const half& m, const facet_statistics<T>& at) const {
    return material_.phase(wi_, wo_, m, at.D, at.inverse_sigma);
  }
  // Radiance is scaled by 1/eta^2 where light passes.
  T radiance_scale(bool radiance) const {
    return radiance ? select(wo_.z < T(0), square(T(T(1) / material_.eta())), T(1)) : T(1);
  }
  // What leaves the surface of the light that facets send to wo. A surface between equal indices is none, and
  // all leaves.
  T leaving(const facet_statistics<T>& at, bool correlated, bool radiance) const {
    const T seen = shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    if constexpr (transmits) {
      return select(material_.eta() == T(1), T(T(1) + T(0) * seen), share(seen, radiance_scale(radiance)));
    } else {
      return seen;
    }
  }

  // f |cos wo|.
  template <class Distribution>
  T eval(const Distribution& ndf, bool correlated, bool radiance) const {
    const half m = half_vector();
    const facet_statistics<T> at = statistics_of(ndf, wi_, wo_, m.m);
    return inside(number(share(leaving(at, correlated, radiance), phase(m, at)), at.inverse_sigma));
  }
  // The density of all directions that the visible normals give, also of those that no light leaves in.
  template <class Distribution>
  T pdf(const Distribution& ndf) const {
    const densities d = parts(ndf, inverse_sigma(ndf, wi_));
    return select(wi_.z > T(0), T(d.mirrors + d.lenses), T(T(0) * (wi_.z + wo_.z)));
  }
  // Of a pair that asks anew for a direction that was drawn; passed: 1 where it crossed its facet. The weight
  // is a number also where f |cos wo| and pdf are infinite or nothing.
  template <class Distribution>
  drawn_direction<T> result(const Distribution& ndf, const T& passed, bool correlated, bool radiance) const {
    const facet_statistics<T> at{T(0), inverse_sigma(ndf, wi_), sigma_out(ndf, wo_)};
    const densities d = parts(ndf, at.inverse_sigma);
    const T density = d.mirrors + d.lenses;
    T weight = leaving(at, correlated, radiance);
    if constexpr (transmits) {
      // Of what goes there, the part that can leave: mirrored light above, the rest below.
      const auto above = wo_.z > T(0), crossed = passed > T(0);
      const T part = select(above, d.mirrors, d.lenses) / maximum(density, smallest<T>());
      const T sure = select((above & !crossed) | ((wo_.z < T(0)) & crossed), T(1), T(0));
      const auto some = density > smallest<T>(), finite = density <= largest<T>();
      weight = share(select(some & finite, part, sure), weight);
    } else {
      weight = weight * material_.reflectance(half_vector().cosine);
    }
    // From below an opaque surface, and from straight below any, no facet is seen.
    const auto seen = wi_.z > T(0);
    const T nothing = T(0) * wi_.z + T(0);
    return {turned(select(seen, wo_, scaled(wi_, T(-1)))), select(seen, inside(weight), nothing),
            select(seen, density, nothing)};
  }
  // The part of a drawn pair's light that leaves, where wo lies on the side where it has to.
  T leaving_side(const facet_statistics<T>& at, bool correlated) const {
    const auto leaves = select(passed_ > T(0), T(-wo_.z), wo_.z) > T(0);
    const T seen = shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    return select(leaves, seen, T(T(0) * at.inverse_sigma));
  }
  // What leaves of the light that facets m mirror (a pair drawn with 0) or let pass (with 1), per steradian
  // of normals.
  T of_facet(const vec3<T>& m, const facet_statistics<T>& at, bool correlated) const {
    const T cosine = dot(wi_, m), visible = maximum(cosine, T(0)) * at.D * at.inverse_sigma;
    T part = material_.reflectance(cosine);
    if constexpr (transmits) part = select(passed_ > T(0), material_.transmittance(cosine), part);
    return inside(T(visible * part * leaving_side(at, correlated)));
  }

 private:
  struct densities {
    T mirrors, lenses;
  };
  template <class Distribution>
  densities parts(const Distribution& ndf, const T& inverse) const {
    const half m = half_vector_reflection(wi_, wo_);
    const T D = ndf.D(m.m);
    if constexpr (transmits) {
      const half l = half_vector_transmission(wi_, wo_, material_.eta());
      const T lenses = select_lazy(
          material_.refracts(wo_, l), [&] { return material_.refracted(wi_, wo_, l, ndf.D(l.m), inverse); },
          [&] { return material_.unrefracted(wi_, wo_); });
      return {number(material_.reflected(m, D, inverse), inverse), number(lenses, inverse)};
    } else {
      return {pdf_of_mirrors(D, inverse), T(0)};
    }
  }
  // Along the horizon, between indices that hardly differ, an infinite density may be multiplied by 0.
  T number(const T& value, const T& inverse) const {
    if constexpr (transmits) {
      const T nothing = T(0) * (wi_.z + wo_.z + material_.eta()) + (inverse - inverse);
      return select(value == value, value, nothing);
    } else {
      return value;
    }
  }
  // 0 where no light goes: from or to the horizon, and below an opaque surface.
  T inside(const T& value) const {
    const auto leaves = transmits ? (wo_.z > T(0)) | (wo_.z < T(0)) : wo_.z > T(0);
    return select((wi_.z > T(0)) & leaves, value, T(T(0) * (wi_.z + wo_.z) + T(0)));
  }

  Material material_;
  vec3<T> wi_, wo_;
  T turned_ = T(1), passed_ = T(0);  // the sign of wi.z
};

}  // namespace microfacet
