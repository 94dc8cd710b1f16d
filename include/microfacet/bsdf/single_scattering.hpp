// Light that meets one facet: f |cos wo|, the density of directions drawn by visible normals, and these
// directions.
//
// A pair of directions is asked for its facets, the distribution for what it says of them, and the pair for
// the value: the distribution may be evaluated on arrays. eval, pdf and sample below do all of it for one.
#pragma once

#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/sample_visible.hpp"

namespace microfacet {

// In coordinates in which wi is above: for light from below they are turned over.
template <class Material, class T>
class scattering_pair {
  static constexpr bool transmits = requires(const Material m) { m.eta(); };

 public:
  scattering_pair(const Material& material, const vec3<T>& wi, const vec3<T>& wo)
      : material_(material), wi_(wi), wo_(wo) {
    if constexpr (transmits) {
      turned_ = select(wi.z < T(0), T(-1), T(1));
      material_ = material.turned_over(wi.z < T(0)), wi_ = scaled(wi, turned_), wo_ = scaled(wo, turned_);
    }
  }
  // With wo as the facet m scatters wi.
  static scattering_pair drawn(const Material& material, const vec3<T>& wi, const vec3<T>& m, const T& xi) {
    scattering_pair pair(material, wi, wi);
    const scattered<T> s = pair.material_.scatter(pair.wi_, m, xi, xi);
    pair.wo_ = s.w, pair.passed_ = select(s.passed, T(1), T(0));
    return pair;
  }

  const vec3<T>& wi() const { return wi_; }
  // 1 where a drawn pair crosses its facet.
  const T& passed() const { return passed_; }
  // Whose projected area is in the way of wo.
  vec3<T> blocking() const { return scaled(wo_, select(wo_.z > T(0), T(-1), T(1))); }
  vec3<T> facet() const { return material_.facet(wi_, wo_); }
  vec3<T> mirror() const { return reflecting_facet(wi_, wo_); }
  vec3<T> lens() const {
    if constexpr (transmits) {
      return refracting_facet(wi_, wo_, material_.eta());
    } else {
      return mirror();
    }
  }

  // f |cos wo|. Radiance is scaled by 1/eta^2 where light passes.
  T eval(const vec3<T>& m, const facet_statistics<T>& at, bool correlated, bool radiance) const {
    const T value = material_.phase(wi_, wo_, m, at) * shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    return inside(T(value * scale(radiance)));
  }
  // Of all directions that the visible normals give, also of those that no light leaves in.
  T pdf(const vec3<T>& m, const T& D_of_mirror, const vec3<T>& l, const T& D_of_lens, const T& area) const {
    const facet_statistics<T> mirrors{D_of_mirror, area, T(0)}, lenses{D_of_lens, area, T(0)};
    T density = pdf_of_mirrors(mirrors);
    if constexpr (transmits) {
      const T passed = material_.refracted(wi_, wo_, l, lenses);
      density = select(dot(wi_, m) > T(0), material_.reflected(wi_, m, mirrors), T(0)) + passed;
    }
    return select(wi_.z > T(0), density, T(T(0) * (wi_.z + wo_.z)));
  }

  // Of a drawn pair: the facet that might have given the same direction otherwise.
  vec3<T> other_facet() const { return select(passed_ > T(0), mirror(), lens()); }
  struct draw {
    vec3<T> wo;
    T weight, pdf;
  };
  // From the facet m that was drawn, and D at the other one. The weight is f |cos wo|/pdf.
  draw result(const vec3<T>& m, const facet_statistics<T>& at, const vec3<T>& other, const T& D_of_other,
              bool correlated, bool radiance) const {
    T weight = shadowing<transmits>(wi_.z, wo_.z, at, correlated) * scale(radiance), density;
    if constexpr (transmits) {
      const facet_statistics<T> at_other{D_of_other, at.area, T(0)};
      const auto passed = passed_ > T(0);
      const T mirrors = select(passed, of_mirror(other, at_other), of_mirror(m, at));
      const T lenses = select(passed, material_.refracted(wi_, wo_, m, at),
                              material_.refracted(wi_, wo_, other, at_other));
      density = mirrors + lenses;
      // Of what goes there, the part that can leave: mirrored light above, the rest below.
      const auto above = wo_.z > T(0);
      const T part = select(above, mirrors, lenses) / maximum(density, smallest<T>());
      const T sure = select((above & !passed) | ((wo_.z < T(0)) & passed), T(1), T(0));
      weight = weight * select((density > smallest<T>()) & (density < T(inf)), part, sure);
      weight = select(material_.eta() == T(1), T(T(1) + T(0) * wi_.z), weight);
    } else {
      density = pdf_of_mirrors(at), weight = weight * material_.reflectance(dot(wi_, m));
    }
    // From below an opaque surface, and from straight below any, no facet is seen.
    const auto seen = wi_.z > T(0);
    const T nothing = T(0) * wi_.z + T(0);
    return {scaled(select(seen, wo_, scaled(wi_, T(-1))), turned_), select(seen, inside(weight), nothing),
            select(seen, density, nothing)};
  }
  // What leaves of the light that facets m mirror (a pair drawn with 0) or let pass (with 1), per steradian
  // of normals.
  T of_facet(const vec3<T>& m, const facet_statistics<T>& at, bool correlated) const {
    const T cosine = dot(wi_, m), visible = maximum(cosine, T(0)) * at.D / at.area;
    const T reflectance = material_.reflectance(cosine), passed = passed_;
    const auto leaves = select(passed > T(0), T(-wo_.z), wo_.z) > T(0);
    const T share = select(passed > T(0), T(T(1) - reflectance), reflectance);
    const T value = visible * share * shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    return inside(select(leaves, value, T(T(0) * visible)));
  }

 private:
  T of_mirror(const vec3<T>& m, const facet_statistics<T>& at) const {
    return select(dot(wi_, m) > T(0), material_.reflected(wi_, m, at), T(0));
  }
  T scale(bool radiance) const {
    if constexpr (transmits) {
      if (radiance) return select(wo_.z < T(0), T(T(1) / (material_.eta() * material_.eta())), T(1));
    }
    return T(1);
  }
  // 0 where no light goes: from or to the horizon, and below an opaque surface.
  T inside(const T& value) const {
    const auto leaves = transmits ? (wo_.z > T(0)) | (wo_.z < T(0)) : wo_.z > T(0);
    return select((wi_.z > T(0)) & leaves, value, T(T(0) * (wi_.z + wo_.z) + T(0)));
  }

  Material material_;
  vec3<T> wi_, wo_;
  T turned_ = T(1), passed_ = T(0);  // the sign of wi.z; 1 where a drawn pair crosses its facet
};

template <class Material, class Distribution, class T>
T eval(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo,
       bool correlated = true, bool radiance = true) {
  const scattering_pair<Material, T> pair(material, wi, wo);
  const vec3<T> m = pair.facet();
  return pair.eval(m, {ndf.D(m), ndf.sigma(pair.wi()), ndf.sigma(pair.blocking())}, correlated, radiance);
}

template <class Material, class Distribution, class T>
T pdf(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo) {
  const scattering_pair<Material, T> pair(material, wi, wo);
  const vec3<T> m = pair.mirror(), l = pair.lens();
  return pair.pdf(m, ndf.D(m), l, ndf.D(l), ndf.sigma(pair.wi()));
}

// A direction, its weight f |cos wo|/pdf, and its pdf, from three uniform numbers for the facet and one that
// chooses between reflection and transmission.
template <class Material, class Distribution, class T>
auto sample(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& xi,
            const T& choice, bool correlated = true, bool radiance = true) {
  using pairs = scattering_pair<Material, T>;
  const vec3<T> m = sample_visible(ndf, pairs(material, wi, wi).wi(), xi.x, xi.y, xi.z);
  const pairs pair = pairs::drawn(material, wi, m, choice);
  const vec3<T> other = pair.other_facet();
  return pair.result(m, {ndf.D(m), ndf.sigma(pair.wi()), ndf.sigma(pair.blocking())}, other, ndf.D(other),
                     correlated, radiance);
}

}  // namespace microfacet
