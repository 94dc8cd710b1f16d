// Light that meets one facet: f |cos wo|, the density of directions drawn by visible normals, and these
// directions.
//
// Directions have unit length. A drawn direction is asked anew for its facets, so that its density is the one
// that pdf says of it, however far rounding has moved it from the facet that was drawn.
#pragma once

#include <array>
#include <cstring>
#include <limits>

#include "microfacet/bsdf/scattering_pair.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"

namespace microfacet {

template <class Material, class Distribution, class T>
T eval(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo,
       bool correlated = true, bool radiance = true) {
  return scattering_pair<Material, T>(material, wi, wo).eval(ndf, correlated, radiance);
}

template <class Material, class Distribution, class T>
T pdf(const Material& material, const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo) {
  return scattering_pair<Material, T>(material, wi, wo).pdf(ndf);
}

// The numbers in which the caller keeps directions: those of T, or narrower ones.
template <class T>
class kept_numbers {
  using own = typename scalar_traits<T>::real;
  using limits = std::numeric_limits<own>;
  using narrow = std::numeric_limits<float>;

 public:
  explicit kept_numbers(bool in_float32 = false) : narrow_(in_float32 && sizeof(own) > sizeof(float)) {}

  T largest() const { return T(narrow_ ? own((narrow::max)()) : (limits::max)()); }
  T rounding() const { return T(narrow_ ? own(narrow::epsilon()) : limits::epsilon()); }
  vec3<T> operator()(const vec3<T>& w) const {
    if (!narrow_) return w;
    const auto each = [](const T& x) {
      std::array<own, sizeof(T) / sizeof(own)> lanes;
      std::memcpy(lanes.data(), &x, sizeof x);
      for (own& lane : lanes) lane = static_cast<own>(static_cast<float>(lane));
      T result;
      std::memcpy(&result, lanes.data(), sizeof result);
      return result;
    };
    return {each(w.x), each(w.y), each(w.z)};
  }

 private:
  bool narrow_;
};

// Moves a drawn direction by a rounding where its density is infinite, as at the peak of a sharp
// distribution: of what is drawn both f and the density are numbers. Equal indices have no others.
template <class Material, class T>
vec3<T> beside_peak(const Material& material, const vec3<T>& wo, const T& pdf, const T& largest,
                    const T& rounding) {
  auto infinite = pdf > largest;
  if constexpr (Material::transmits) infinite = infinite & (material.eta() != T(1));
  return {select(infinite, T(wo.x + rounding), wo.x), wo.y, wo.z};
}

// The direction into which the facet m, which wi sees, scatters; `choice` chooses between reflection and
// transmission. m is in the coordinates of scattering_pair.
template <class Material, class Distribution, class T>
drawn_direction<T> sample_at(const Material& material, const Distribution& ndf, const vec3<T>& wi,
                             const vec3<T>& m, const T& choice, bool correlated, bool radiance,
                             const kept_numbers<T>& kept = kept_numbers<T>()) {
  using pairs = scattering_pair<Material, T>;
  const pairs drawn = pairs(material, wi, wi).drawn(m, choice);
  vec3<T> wo = kept(drawn.turned(drawn.wo()));
  for (bool moved = false;; moved = true) {
    const auto found = pairs(material, wi, wo).result(ndf, drawn.passed(), correlated, radiance);
    if (moved || !any_lane(found.pdf > kept.largest())) return found;
    wo = beside_peak(material, wo, found.pdf, kept.largest(), kept.rounding());
  }
}

// Draws a direction from three uniform numbers for the facet and one that chooses between reflection and
// transmission.
template <class Material, class Distribution, class T>
drawn_direction<T> sample(const Material& material, const Distribution& ndf, const vec3<T>& wi,
                          const vec3<T>& xi, const T& choice, bool correlated = true, bool radiance = true) {
  const vec3<T> above = scattering_pair<Material, T>(material, wi, wi).wi();
  const vec3<T> m = sample_visible(ndf, above, xi.x, xi.y, xi.z);
  return sample_at(material, ndf, wi, m, choice, correlated, radiance);
}

}  // namespace microfacet
