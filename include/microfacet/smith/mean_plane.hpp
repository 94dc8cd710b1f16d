// Smith's masking about the mean plane of a surface, which need not be horizontal: a distribution offers sigma(w), D(m)
// and up(w) = sigma(w) - sigma(-w), the area of the mean plane as w sees it, which stands where cos(theta) stands for
// a mean plane that is (Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs, 2014; Dupuy et
// al., Linear efficient antialiased displacement and reflectance mapping, 2013).
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/masking.hpp"

namespace microfacet::mean_plane {

// w where the mask is false, else -w.
template <class Mask, class T>
vec3<T> turned_over(const Mask& mask, const vec3<T>& w) {
  return {select(mask, T(-w.x), w.x), select(mask, T(-w.y), w.y), select(mask, T(-w.z), w.z)};
}

// sigma(-w)/up(w) for w above the plane; Lambda(-w) = -1 - Lambda(w); infinite along it.
template <class Distribution, class T>
T Lambda(const Distribution& ndf, const vec3<T>& w) {
  const T up = ndf.up(w);
  const auto below = up < T(0);
  const T ratio = ndf.sigma(turned_over(!below, w)) / abs(up);
  return select(below, T(T(-1) - ratio), ratio);
}

// up(w)/sigma(w) above the plane, else 0.
template <class Distribution, class T>
T G1(const Distribution& ndf, const vec3<T>& w) {
  const T up = ndf.up(w), sigma = ndf.sigma(w);
  return select(up > T(0), T(up / sigma), T((up + sigma) * T(0)));
}

// Masking and shadowing: 0 for wi below the plane; reflection for wo above it, transmission for wo below.
template <class Distribution, class T>
T G2(const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo) {
  const auto through = ndf.up(wo) < T(0);
  const T value = G2_correlated(Lambda(ndf, wi), Lambda(ndf, turned_over(through, wo)), through);
  return select(ndf.up(wi) > T(0), value, T(T(0) * (ndf.up(wi) + ndf.up(wo))));
}
template <class Distribution, class T>
T G2_uncorrelated(const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo) {
  return G1(ndf, wi) * G1(ndf, turned_over(ndf.up(wo) < T(0), wo));
}

// Density per steradian of the normals that w sees.
template <class Distribution, class T>
T D_visible(const Distribution& ndf, const vec3<T>& m, const vec3<T>& w) {
  return maximum(T(dot(m, w) / sqrt(dot(m, m))), T(0)) * ndf.D(m) / ndf.sigma(w);
}

// Coordinates in which the mean plane of slopes p, q is horizontal: there Smith's surface is one whose mean slope is 0.
class frame {
  using T = double;

 public:
  frame(T p, T q) : length_(sqrt(T(1 + p * p + q * q))) {
    // The shortest rotation.
    const T x = -p / length_, y = -q / length_, z = 1 / length_, share = 1 / (1 + z);
    first_ = {1 - x * x * share, -x * y * share, -x};
    second_ = {-x * y * share, 1 - y * y * share, -y};
    normal_ = {x, y, z};
  }
  vec3<T> from_world(const vec3<T>& w) const { return {dot(first_, w), dot(second_, w), dot(normal_, w)}; }
  vec3<T> to_world(const vec3<T>& w) const {
    return {first_.x * w.x + second_.x * w.y + normal_.x * w.z,
            first_.y * w.x + second_.y * w.y + normal_.y * w.z,
            first_.z * w.x + second_.z * w.y + normal_.z * w.z};
  }
  // The area of the mean plane over a unit of the horizontal one.
  T area() const { return length_; }

 private:
  T length_;
  vec3<T> first_, second_, normal_;
};

}  // namespace microfacet::mean_plane
