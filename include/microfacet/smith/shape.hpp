// The shape that stretches a density of standard space: alpha_x, alpha_y along axes turned by `rotation`.
//
// A slope (p, q) of the surface is the standard slope times (alpha_x, alpha_y) in the turned axes. The
// direction that sees standard slopes as w sees the surface's has the same cosine and the components (alpha_x
// w_x, alpha_y w_y), so sigma, which is homogeneous of degree one, needs only c = w_z and s, the length of
// those components.
#pragma once

#include <limits>
#include <type_traits>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// alpha outside its interval becomes nan and so does every result in that lane. alpha may come with more
// digits than a T has.
template <class T>
double_double<T> valid_alpha(const double_double<T>& alpha) {
  return {inside(roughness, alpha.high), low_of(alpha)};
}

// sqrt(p^2 + q^2) without the squares' under- and overflow.
template <class T>
T length(const T& p, const T& q) {
  const T most = T(1) / smallest<T>(), larger = maximum(T(abs(p)), T(abs(q)));
  const T unit = minimum(maximum(larger, smallest<T>()), most);  // finite beside infinity
  return unit * sqrt(square(T(p / unit)) + square(T(q / unit)));
}

// Rounding takes the cosine of a normalised direction a few ulp above 1: up to here it counts as 1.
template <class T>
inline constexpr T largest_cosine = T(1) + 8 * std::numeric_limits<T>::epsilon();

// A direction in the plane y = 0 by its cosine u in [-1, 1] alone; beyond largest_cosine its z is nan.
template <class T>
struct cosine {
  // 1 - u^2 keeps its digits as u -> 1: rounded once where the hardware does it, else as a sum of two or, in
  // one number, as a product.
  static constexpr bool rounds_once = MICROFACET_FUSED && elementary::has_lanes<T>;
  T z;
  std::conditional_t<rounds_once, T, double_double<T>> sine2;

  explicit cosine(const T& u)
      : z(select_lazy(
            abs(u) > T(1), [&] { return bounded(u); }, [&] { return u; })),
        sine2(one_minus_square(z)) {}

 private:
  static T bounded(const T& u) {
    if constexpr (records<T>) return u;
    const auto valid = abs(u) <= T(largest_cosine<typename scalar_traits<T>::real>);
    return nan_unless(valid, minimum(maximum(u, T(-1)), T(1)));
  }
  static auto one_minus_square(const T& u) {
    if constexpr (rounds_once) {
      return multiply_add(T(-u), u, T(1));
    } else if constexpr (one_number<T>) {
      return double_double<T>((T(1) - u) * (T(1) + u));
    } else {
      const double_double<T> square = two_prod(u, u), rest = fast_two_sum(T(1), T(-square.high));
      return fast_two_sum(rest.high, T(low_of(rest) - low_of(square)));
    }
  }
};

template <class T>
double_double<T> squared_length(const T& x, const T& y) {
  return two_prod(x, x) + two_prod(y, y);
}

template <class T>
double_double<T> reciprocal(const double_double<T>& a) {
  return quotient(double_double<T>(T(1)), a);
}

// What both shapes offer, of slopes (p, q) and directions:
//   slope2, length       the standard slope squared, and its length where the square would leave the range
//   unit, unit_slope2    a power of two whose fourth power is near the area (or what is shortest for numbers whose
//                        roundings do not count), and the squared standard slope of slopes or of a normal times
//                        (z unit)^2: D at unit z over- and underflows where the surface's density does
//   unit_density         what times D(unit z, unit_slope2) gives that density
//   stretch2             the squared sine of the stretched direction
//   along_x, standard    the roughness of slopes along x, and slopes over it
//   least                the smaller roughness
//   to_standard          the x and y of the stretched direction, in the shape's own axes
//   to_surface           slopes from standard space to the surface's
template <class T>
class isotropic_shape {
 public:
  explicit isotropic_shape(const double_double<T>& alpha)
      : alpha_(valid_alpha(alpha)),
        alpha2_(square(alpha_)),
        inverse_(reciprocal(alpha_)),
        unit_(records<T> ? alpha_.high : elementary::power_of_two_of_root(alpha_.high)),
        unit2_(records<T> ? double_double<T>(T(1)) : square(unit_) * reciprocal(alpha2_)) {}

  T unit() const { return unit_; }
  T unit_density() const { return rounded(T(square(unit_) * unit2_.high)); }
  double_double<T> unit_slope2(const T& p, const T& q) const { return squared_length(p, q) * unit2_; }
  double_double<T> unit_slope2(const vec3<T>& m) const { return squared_length(m.x, m.y) * unit2_; }
  double_double<T> unit_slope2(const cosine<T>& m) const { return m.sine2 * unit2_; }
  double_double<T> slope2(const T& r) const { return square(standard(r)); }
  T length(const T& p, const T& q) const {
    return microfacet::length(T(p / alpha_.high), T(q / alpha_.high));
  }
  double_double<T> stretch2(const vec3<T>& w) const { return squared_length(w.x, w.y) * alpha2_; }
  double_double<T> stretch2(const cosine<T>& w) const { return w.sine2 * alpha2_; }
  T along_x() const { return alpha_.high; }
  T least() const { return alpha_.high; }
  T inverse_along_x() const { return inverse_.high; }
  double_double<T> standard(const T& p) const { return p * inverse_; }
  void to_standard(T& x, T& y) const { x = x * alpha_.high, y = y * alpha_.high; }
  void to_surface(T& p, T& q) const { p = p * alpha_.high, q = q * alpha_.high; }

 private:
  double_double<T> alpha_, alpha2_, inverse_;
  T unit_;
  double_double<T> unit2_;  // times the inverse square
};

template <class T>
class anisotropic_shape {
 public:
  anisotropic_shape(const double_double<T>& alpha_x, const double_double<T>& alpha_y, const T& cosine,
                    const T& sine)
      : alpha_x_(valid_alpha(alpha_x)),
        alpha_y_(valid_alpha(alpha_y)),
        c_(cosine),
        s_(sine),
        x2_(square(alpha_x_)),
        y2_(square(alpha_y_)),
        unit_(elementary::power_of_two_of_root(
            elementary::power_of_two_of_root(T(alpha_x_.high * alpha_y_.high)))),
        unit_x2_(square(unit_) * reciprocal(x2_)),
        unit_y2_(square(unit_) * reciprocal(y2_)),
        along_x_(sqrt(x2_ * two_prod(c_, c_) + y2_ * two_prod(s_, s_))),
        inverse_(reciprocal(along_x_)) {}

  T unit() const { return unit_; }
  T unit_density() const {
    return rounded(T(square(unit_) / alpha_x_.high)) * rounded(T(square(unit_) / alpha_y_.high));
  }
  double_double<T> unit_slope2(const T& p, const T& q) const {
    if constexpr (records<T>) {
      const T a = (c_ * p + s_ * q) / alpha_x_.high, b = (c_ * q - s_ * p) / alpha_y_.high;
      return T(a * a + b * b);
    } else {
      return weighed(p, q, unit_x2_, unit_y2_);
    }
  }
  double_double<T> unit_slope2(const vec3<T>& m) const { return unit_slope2(m.x, m.y); }
  T length(const T& p, const T& q) const {
    return microfacet::length(T((c_ * p + s_ * q) / alpha_x_.high), T((c_ * q - s_ * p) / alpha_y_.high));
  }
  double_double<T> stretch2(const vec3<T>& w) const { return weighed(w.x, w.y, x2_, y2_); }
  // The slope along x of the surface is a standard slope times this, in any isotropic density.
  T along_x() const { return along_x_.high; }
  T least() const { return minimum(alpha_x_.high, alpha_y_.high); }
  T inverse_along_x() const { return inverse_.high; }
  double_double<T> standard(const T& p) const { return p * inverse_; }
  void to_standard(T& x, T& y) const {
    const T a = c_ * x + s_ * y, b = c_ * y - s_ * x;
    x = a * alpha_x_.high, y = b * alpha_y_.high;
  }
  void to_surface(T& p, T& q) const {
    const T a = p * alpha_x_.high, b = q * alpha_y_.high;
    p = c_ * a - s_ * b, q = s_ * a + c_ * b;
  }

 private:
  // The sum of the squared components along the axes, each with its weight.
  double_double<T> weighed(const T& x, const T& y, const double_double<T>& along,
                           const double_double<T>& across) const {
    const double_double<T> a = square(component(c_, x, s_, y)) * along;
    const double_double<T> b = square(component(c_, y, T(-s_), x)) * across;
    return a + b;
  }
  static double_double<T> component(const T& a, const T& x, const T& b, const T& y) {
    const sum_of_products<T> sum = sum_of_products<T>(a, x).plus(b, y);
    return fast_two_sum(sum.high, sum.low);
  }

  double_double<T> alpha_x_, alpha_y_;
  T c_, s_;
  double_double<T> x2_, y2_;
  T unit_;
  double_double<T> unit_x2_, unit_y2_, along_x_, inverse_;
};

}  // namespace microfacet
