// A distribution of microfacet normals: a family in standard space under a shape.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/smith/masking.hpp"
#include "microfacet/smith/shape.hpp"

namespace microfacet {

// Of directions, or of cosines where the shape is isotropic. A direction need not have unit length where only
// slopes matter (D, Lambda, G1); sigma is for unit directions.
template <class Family, class T, class Shape = anisotropic_shape<T>>
class ndf {
 public:
  ndf(const Family& family, const Shape& shape) : family_(family), shape_(shape) {}

  const Family& family() const { return family_; }
  const Shape& shape() const { return shape_; }

  // Slopes. P22 is D of a normal with z^4 = area.
  T P22(const T& p, const T& q) const {
    const double_double<T> h2 = shape_.unit_slope2(p, q);
    const auto by_square = [&] { return T(rounded(family_.D(shape_.unit(), h2)) * shape_.unit_density()); };
    if constexpr (P22_by_slope<Family>) {
      const auto by_slope = [&] {
        const T unit2 = square(shape_.unit());
        return T(rounded(family_.P22_of_slope(shape_.length(p, q))) *
                 rounded(T(rounded(T(shape_.unit_density() / unit2)) / unit2)));
      };
      return select_lazy(h2.high < T(0x1p40) * smallest<T>(), by_slope, by_square);
    } else {
      return by_square();
    }
  }
  T P2(const T& p) const {
    const double_double<T> t = shape_.standard(p);
    if constexpr (scaled_P2<Family>) {  // times a factor that lifts what underflows alone
      return family_.P2(t, shape_.inverse_along_x());
    } else {
      return rounded(family_.P2(t)) * shape_.inverse_along_x();
    }
  }
  T slope_cdf(const T& p) const { return family_.slope_sf(-shape_.standard(p)); }

  // Normals, per steradian: P22 at the slopes (-x/z, -y/z), over (z/|m|)^4.
  T D(const vec3<T>& m) const { return D_of_unit(m) * square(T(dot(m, m))); }
  T D(const cosine<T>& m) const { return D_of_unit(m); }
  // Of a normal of unit length, or a cosine. Slopes are homogeneous in the normal. Below the horizon D means nothing,
  // but a nan stays one.
  template <class Direction>
  T D_of_unit(const Direction& m) const {
    const T value = rounded(family_.D(T(m.z * shape_.unit()), shape_.unit_slope2(m))) * shape_.unit_density();
    const T nothing = T(0) * shape_.unit_density() + family_.zero_or_nan();
    return select(m.z > T(0), value, multiply_add(m.z, nothing, nothing));
  }
  // Density per steradian of normals drawn from D cos(theta).
  T pdf(const vec3<T>& m) const { return D(m) * m.z / sqrt(dot(m, m)); }

  // Directions.
  T sigma(const vec3<T>& w) const { return microfacet::sigma(family_, w.z, shape_.stretch2(w)); }
  T sigma(const cosine<T>& w) const { return microfacet::sigma(family_, w.z, shape_.stretch2(w)); }
  T Lambda(const vec3<T>& w) const { return microfacet::Lambda(family_, w.z, shape_.stretch2(w)); }
  T Lambda(const cosine<T>& w) const { return microfacet::Lambda(family_, w.z, shape_.stretch2(w)); }
  T G1(const vec3<T>& w) const { return microfacet::G1(family_, w.z, shape_.stretch2(w)); }
  T G1(const cosine<T>& w) const { return microfacet::G1(family_, w.z, shape_.stretch2(w)); }

  // Masking and shadowing: 0 for wi below the horizon; reflection for wo.z > 0, transmission for wo.z < 0.
  T G2(const vec3<T>& wi, const vec3<T>& wo) const {
    const T lambda_i = Lambda(vec3<T>{wi.x, wi.y, abs(wi.z)}),
            lambda_o = Lambda(vec3<T>{wo.x, wo.y, abs(wo.z)});
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
