// Slopes, and what families give back of them.
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// Holds a slope with its square; exponents are made of the one or the other.
template <class T>
struct slope {
  double_double<T> value, squared;

  slope(const T& t) : slope(double_double<T>(t)) {}
  slope(const double_double<T>& t) : slope(t, square(t)) {}
  slope(const double_double<T>& t, const double_double<T>& t2) : value(t), squared(t2) {}
};

// Finds the slope |c|/s of the plane that a direction grazes, by one quotient and one root; an s^2 below
// `least` counts as that.
template <class T>
struct horizon {
  T s;
  slope<T> x;

  MICROFACET_INLINE horizon(const T& c, const double_double<T>& s2, const T& least)
      : horizon(c, double_double<T>(maximum(s2.high, least), low_of(s2))) {}

 private:
  MICROFACET_INLINE horizon(const T& c, const double_double<T>& s2)
      : horizon(c, s2, T(sqrt(s2.high)), T(T(1) / s2.high)) {}
  MICROFACET_INLINE horizon(const T& c, const double_double<T>& s2, const T& root, const T& reciprocal)
      : s(root),
        x(root_quotient(T(abs(c)), s2, root, T(root * reciprocal)),
          quotient(two_prod(c, c), s2, reciprocal)) {}
};

template <class T>
struct fraction {
  T numerator, denominator;
};

// Integrals of P2(t + s)/P2(t), and of s times that, over s from 0 to d.
template <class T>
struct near_integrals {
  T mass, moment;
};
template <class T, class Mask>
MICROFACET_INLINE near_integrals<T> select(const Mask& mask, const near_integrals<T>& a,
                                           const near_integrals<T>& b) {
  return {select(mask, a.mass, b.mass), select(mask, a.moment, b.moment)};
}

// The stretched direction from which normals are seen, of unit length, and 1/wx, which counts below the horizon alone.
template <class T>
struct cap_direction {
  T wx, wz, inverse_wx;
};

// What the start of an inversion depends on: |x|, the depth -log(probability) and its root, and whether the slope
// leans away from x.
template <class T, class Mask>
struct visible_depth {
  T X, depth, root;
  Mask lower;
};

// Slopes in the plane of incidence of a direction, positive towards it, and across that plane.
template <class T>
struct visible_slopes {
  T along, across;
};
template <class T, class Mask>
visible_slopes<T> select(const Mask& mask, const visible_slopes<T>& a, const visible_slopes<T>& b) {
  return {select(mask, a.along, b.along), select(mask, a.across, b.across)};
}

// Bounds a slope t >= 0 so that its square is finite.
template <class T>
slope<T> bounded(const slope<T>& t) {
  const T most = largest_slope<T>();
  const auto beyond = t.value.high > most;
  return {select(beyond, double_double<T>(most), t.value),
          select(beyond, double_double<T>(T(most * most)), t.squared)};
}

// Extends a probability above t >= 0 to any t by symmetry: it is 1/2 at 0 and 0 at infinity. The square of a
// finite slope may be infinite.
template <class T, class Upper>
T symmetric_sf(const slope<T>& t_argument, const Upper& upper) {
  const T t = t_argument.value.high, size = abs(t);
  const T q = upper(slope<T>(abs(t_argument.value), t_argument.squared));
  const T above = select(size == T(0), T(0.5) + T(0) * q, select(size <= largest<T>(), q, T(0) * q));
  return select(t < T(0), T(T(1) - above), select(size >= T(0), above, size));
}

}  // namespace microfacet
