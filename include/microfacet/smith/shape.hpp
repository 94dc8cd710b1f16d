// The shape that stretches a density of standard space: alpha_x, alpha_y along axes turned by `rotation`.
//
// A slope (p, q) of the surface is the standard slope times (alpha_x, alpha_y) in the turned axes. The
// direction that sees standard slopes as w sees the surface's has the same cosine and the components (alpha_x
// w_x, alpha_y w_y), so sigma, which is homogeneous of degree one, needs only c = w_z and s, the length of
// those components.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// alpha outside (0, inf) becomes nan and so does every result in that lane.
template <class T>
T valid_alpha(const T& alpha) {
  return where((alpha > T(0)) & (alpha < T(inf)), alpha);
}

// sqrt(p^2 + q^2) without the squares' under- and overflow.
template <class T>
T length(const T& p, const T& q) {
  const T most = T(1) / smallest<T>(), a = minimum(T(abs(p)), most), b = minimum(T(abs(q)), most);
  const T larger = maximum(maximum(a, b), smallest<T>());
  return larger * sqrt(square(T(a / larger)) + square(T(b / larger)));
}

template <class T>
class isotropic_shape {
 public:
  explicit isotropic_shape(const T& alpha) : alpha_(valid_alpha(alpha)) {}

  T area() const { return alpha_ * alpha_; }  // of the image of a unit square of standard slopes
  T slope2(const T& p, const T& q) const { return square(T(p / alpha_)) + square(T(q / alpha_)); }
  T slope(const T& p, const T& q) const { return length(T(p / alpha_), T(q / alpha_)); }
  T standard(const T& p) const { return p / alpha_; }
  T along_x() const { return alpha_; }
  T stretch(const T& x, const T& y) const { return alpha_ * sqrt(x * x + y * y); }
  void to_surface(T& p, T& q) const { p = p * alpha_, q = q * alpha_; }

 private:
  T alpha_;
};

template <class T>
class anisotropic_shape {
 public:
  anisotropic_shape(const T& alpha_x, const T& alpha_y, const T& cosine, const T& sine)
      : alpha_x_(valid_alpha(alpha_x)), alpha_y_(valid_alpha(alpha_y)), c_(cosine), s_(sine) {}

  T area() const { return alpha_x_ * alpha_y_; }
  T slope2(const T& p, const T& q) const {
    return square(T((c_ * p + s_ * q) / alpha_x_)) + square(T((c_ * q - s_ * p) / alpha_y_));
  }
  T slope(const T& p, const T& q) const {
    return length(T((c_ * p + s_ * q) / alpha_x_), T((c_ * q - s_ * p) / alpha_y_));
  }
  // The slope along x of the surface is a standard slope times this, in any isotropic density.
  T along_x() const { return sqrt(square(T(alpha_x_ * c_)) + square(T(alpha_y_ * s_))); }
  T standard(const T& p) const { return p / along_x(); }
  T stretch(const T& x, const T& y) const {
    return sqrt(square(T(alpha_x_ * (c_ * x + s_ * y))) + square(T(alpha_y_ * (c_ * y - s_ * x))));
  }
  void to_surface(T& p, T& q) const {
    const T a = p * alpha_x_, b = q * alpha_y_;
    p = c_ * a - s_ * b, q = s_ * a + c_ * b;
  }

 private:
  T alpha_x_, alpha_y_, c_, s_;
};

}  // namespace microfacet
