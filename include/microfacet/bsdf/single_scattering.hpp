// Light that meets one facet: f |cos wo|, the density of directions drawn by visible normals, and these
// directions.
//
// A pair of directions is asked for its facets, the distribution for what it says of them, and the pair for
// the value: the distribution may be evaluated on arrays. eval, pdf and sample below do all of it for one.
// Directions have unit length. A drawn direction is asked anew for its facets, so that its density is the one
// that pdf says of it, however far rounding has moved it from the facet that was drawn.
#pragma once

#include <limits>

#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"

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
      material_ = material.flipped(wi.z < T(0)), wi_ = scaled(wi, turned_), wo_ = scaled(wo, turned_);
    }
  }
  // With wo as the facet m scatters wi.
  static scattering_pair drawn(const Material& material, const vec3<T>& wi, const vec3<T>& m, const T& xi) {
    scattering_pair pair(material, wi, wi);
    const scattered<T> s = pair.material_.scatter(pair.wi_, m, xi, xi);
    pair.wo_ = select(s.passed, s.w, unit(s.w)), pair.passed_ = select(s.passed, T(1), T(0));
    return pair;
  }

  const vec3<T>& wi() const { return wi_; }
  // Of a drawn pair: where it goes, as the caller's coordinates have it, and 1 where it crosses its facet.
  vec3<T> wo() const { return scaled(wo_, turned_); }
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
    return inside(share(leaving(at, correlated, radiance), material_.phase(wi_, wo_, m, at)));
  }
  // Of all directions that the visible normals give, also of those that no light leaves in.
  T pdf(const vec3<T>& m, const T& D_of_mirror, const vec3<T>& l, const T& D_of_lens, const T& area) const {
    const densities d = parts(m, D_of_mirror, l, D_of_lens, area);
    return select(wi_.z > T(0), T(d.mirrors + d.lenses), T(T(0) * (wi_.z + wo_.z)));
  }

  struct draw {
    vec3<T> wo;
    T weight, pdf;
  };
  // Of a pair whose wo was drawn; passed: 1 where it crossed its facet. at: D at the mirror m, and areas. The
  // weight is f |cos wo|/pdf, a number also where these two are infinite or nothing.
  draw result(const T& passed, const vec3<T>& m, const facet_statistics<T>& at, const vec3<T>& l,
              const T& D_of_lens, bool correlated, bool radiance) const {
    const densities d = parts(m, at.D, l, D_of_lens, at.area);
    const T density = d.mirrors + d.lenses;
    T weight = leaving(at, correlated, radiance);
    if constexpr (transmits) {
      // Of what goes there, the part that can leave: mirrored light above, the rest below.
      const auto above = wo_.z > T(0), crossed = passed > T(0);
      const T part = select(above, d.mirrors, d.lenses) / maximum(density, smallest<T>());
      const T sure = select((above & !crossed) | ((wo_.z < T(0)) & crossed), T(1), T(0));
      weight = share(select((density > smallest<T>()) & (density <= largest<T>()), part, sure), weight);
    } else {
      weight = weight * material_.reflectance(dot(wi_, m));
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
    const auto crosses = passed_ > T(0), leaves = select(crosses, T(-wo_.z), wo_.z) > T(0);
    T part = material_.reflectance(cosine);
    if constexpr (transmits) part = select(crosses, material_.transmittance(cosine), part);
    const T value = visible * part * shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    return inside(select(leaves, value, T(T(0) * visible)));
  }

 private:
  struct densities {
    T mirrors, lenses;
  };
  densities parts(const vec3<T>& m, const T& D_of_mirror, const vec3<T>& l, const T& D_of_lens,
                  const T& area) const {
    const facet_statistics<T> mirrors{D_of_mirror, area, T(0)};
    if constexpr (transmits) {
      return {material_.reflected(wi_, m, mirrors),
              material_.refracted(wi_, wo_, l, facet_statistics<T>{D_of_lens, area, T(0)})};
    } else {
      return {pdf_of_mirrors(mirrors), T(0)};
    }
  }
  // What leaves the surface of the light that facets send to wo: all of it where there is none.
  T leaving(const facet_statistics<T>& at, bool correlated, bool radiance) const {
    const T seen = shadowing<transmits>(wi_.z, wo_.z, at, correlated);
    if constexpr (transmits) {
      const T scale = radiance ? select(wo_.z < T(0), square(T(T(1) / material_.eta())), T(1)) : T(1);
      return select(material_.eta() == T(1), T(T(1) + T(0) * seen), share(seen, scale));
    } else {
      return seen;
    }
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

// Moves a drawn direction by a rounding where its density is infinite, as at the peak of a sharp
// distribution: of what is drawn both f and the density are numbers. Equal indices have no others.
template <class Material, class T>
vec3<T> beside_peak(const Material& material, const vec3<T>& wo, const T& pdf, const T& largest,
                    const T& rounding) {
  auto infinite = pdf > largest;
  if constexpr (requires { material.eta(); }) infinite = infinite & (material.eta() != T(1));
  return {select(infinite, T(wo.x + rounding), wo.x), wo.y, wo.z};
}

// A direction, its weight f |cos wo|/pdf, and its pdf, from three uniform numbers for the facet and one that
// chooses between reflection and transmission.
template <class Material, class Distribution, class T>
auto sample(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& xi,
            const T& choice, bool correlated = true, bool radiance = true) {
  using pairs = scattering_pair<Material, T>;
  using limits = std::numeric_limits<typename scalar_traits<T>::real>;
  const vec3<T> facet = sample_visible(ndf, pairs(material, wi, wi).wi(), xi.x, xi.y, xi.z);
  const pairs drawn = pairs::drawn(material, wi, facet, choice);
  const auto ask = [&](const vec3<T>& wo) {
    const pairs pair(material, wi, wo);
    const vec3<T> m = pair.mirror(), l = pair.lens();
    return pair.result(drawn.passed(), m, {ndf.D(m), ndf.sigma(pair.wi()), ndf.sigma(pair.blocking())}, l,
                       ndf.D(l), correlated, radiance);
  };
  const auto found = ask(drawn.wo());
  const T largest((limits::max)());
  if (!any_lane(found.pdf > largest)) return found;
  return ask(beside_peak(material, drawn.wo(), found.pdf, largest, T(limits::epsilon())));
}

}  // namespace microfacet
