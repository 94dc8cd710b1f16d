// Facets that scatter as Lambert's law says.
#pragma once

#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/scattered.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
class diffuse {
 public:
  static constexpr int parameters = 1, uniforms = 2;
  static constexpr bool transmits = false, closed = false;

  explicit diffuse(const T& albedo) : albedo_(nan_unless((albedo >= T(0)) & (albedo <= T(1)), albedo)) {}
  explicit diffuse(const T* p) : diffuse(p[0]) {}

  // The part of the light on a facet m that goes to wo, per steradian. No closed form says which facets see
  // both wo and wi, so m is drawn.
  T phase(const vec3<T>& wo, const vec3<T>& m) const {
    return albedo_ * T(1 / pi) * maximum(dot(wo, m), T(0));
  }
  scattered<T> scatter(const vec3<T>& wi, const vec3<T>& m, const T& xi0, const T& xi1) const {
    // m plus a point of the unit sphere: the density is cos/pi.
    const T z = T(1) - T(2) * xi0, r = sqrt(maximum(T(T(1) - z * z), T(0)));
    const elementary::circle<T> turn = elementary::cos_sin_of_turns(xi1);
    const vec3<T> sum{m.x + r * turn.cosine, m.y + r * turn.sine, m.z + z};
    const auto degenerate = dot(sum, sum) < T(1e-12);
    return {select(degenerate, m, normalize(sum)), albedo_, wi.z != wi.z};
  }

 private:
  T albedo_;
};

}  // namespace microfacet
