// A distribution of microfacet normals: a family in standard space under a shape.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/smith/masking.hpp"
#include "microfacet/smith/shape.hpp"

namespace microfacet {

// Directions need not have unit length where only slopes matter (D, Lambda, G1); sigma is for unit
// directions.
template <class Family, class T, class Shape = anisotropic_shape<T>>
class ndf {
 public:
  ndf(const Family& family, const Shape& shape) : family_(family), shape_(shape) {}

  const Family& family() const { return family_; }
  const Shape& shape() const { return shape_; }

  // Slopes.
  T P22(const T& p, const T& q) const {
    if constexpr (requires { family_.P22_of_slope(p); }) {
      return family_.P22_of_slope(shape_.slope(p, q)) / shape_.area();
    } else {
      return family_.P22(shape_.slope2(p, q)) / shape_.area();
    }
  }
  T P2(const T& p) const { return family_.P2(shape_.standard(p)) / shape_.along_x(); }
  T slope_cdf(const T& p) const { return family_.slope_sf(T(-shape_.standard(p))); }

  // Normals, per steradian: P22 at the slopes (-x/z, -y/z), over (z/|m|)^4.
  T D(const vec3<T>& m) const {
    const auto above = m.z > T(0);
    // The stretched slope times z, squared: slope2 is homogeneous of degree two. Normals below the horizon
    // are evaluated where no density is infinite, so that only a nan survives the multiplication by zero.
    const T z = select(above, m.z, T(1)), h2 = select(above, shape_.slope2(m.x, m.y), T(1));
    const T value = family_.D(z, h2) / shape_.area() * square(dot(m, m));
    return select(above, value, T(value * T(0)));
  }
  // Density per steradian of normals drawn from D cos(theta).
  T pdf(const vec3<T>& m) const { return D(m) * m.z / sqrt(dot(m, m)); }

  // Directions.
  T sigma(const vec3<T>& w) const { return microfacet::sigma(family_, w.z, shape_.stretch(w.x, w.y)); }
  T Lambda(const vec3<T>& w) const { return microfacet::Lambda(family_, w.z, shape_.stretch(w.x, w.y)); }
  T G1(const vec3<T>& w) const { return microfacet::G1(family_, w.z, shape_.stretch(w.x, w.y)); }

  // Masking and shadowing: 0 for wi below the horizon; reflection for wo.z > 0, transmission for wo.z < 0.
  T G2(const vec3<T>& wi, const vec3<T>& wo) const {
    const T lambda_i = Lambda({wi.x, wi.y, abs(wi.z)}), lambda_o = Lambda({wo.x, wo.y, abs(wo.z)});
    return select(wi.z > T(0), G2_correlated(lambda_i, lambda_o, wo.z < T(0)), T(0));
  }
  T G2_uncorrelated(const vec3<T>& wi, const vec3<T>& wo) const {
    return G1(wi) * G1(vec3<T>{wo.x, wo.y, abs(wo.z)});
  }

  // Density per steradian of the normals that w sees.
  T D_visible(const vec3<T>& m, const vec3<T>& w) const {
    return maximum(T(dot(m, w) / sqrt(dot(m, m))), T(0)) * D(m) / sigma(w);
  }

 private:
  Family family_;
  Shape shape_;
};

}  // namespace microfacet
