// What a family is: an isotropic density of slopes in standard space (roughness 1).
//
// A family states its joint density P22, the probability `survival` that the squared slope exceeds r2, and
// the inverse of that. Its slope marginals follow from these by the integrals below, unless it has a closed
// form. Everything else (sigma, Lambda, G1, G2, sampling, shape) is written once for all families, in smith/.
#pragma once

#include <concepts>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// Functions of a density, to be combined with |: what a quantity needs, and what it pays to prepare.
enum radial_function : unsigned {
  of_P22 = 1,
  of_survival = 2,
  of_radius = 4,
  of_P2 = 8,
  of_slope_sf = 16,
  of_slope_excess = 32,
  of_all = 63,
  of_visible = 64  // what visible normals need besides
};

// A slope with its square; exponents are made of the one or the other.
template <class T>
struct slope {
  double_double<T> value, squared;

  slope(const T& t) : slope(double_double<T>(t)) {}
  slope(const double_double<T>& t) : slope(t, square(t)) {}
  slope(const double_double<T>& t, const double_double<T>& t2) : value(t), squared(t2) {}
  // From the exact square, `root` being its square root to rounding.
  static slope of_square(const T& root, const double_double<T>& t2) {
    const T rest = residual(t2.high, root, root) + t2.low;
    return slope({root, T(0.5) * rest / maximum(root, smallest<T>())}, t2);
  }
};

template <class T>
struct fraction {
  T numerator, denominator;
};

// Of s from 0 to d, the integrals of P2(t + s)/P2(t) and of s times that.
template <class T>
struct near_integrals {
  T mass, moment;
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

// clang-format off
template <class F>
concept radial_family = requires(const F f, typename F::scalar xi, double_double<typename F::scalar> r2, slope<typename F::scalar> t) {
  F::name;                                                     // one string everywhere
  F::parameters;                                               // std::array<parameter, n>: the shape parameters
  { f.zero_or_nan() } -> std::convertible_to<typename F::scalar>;        // 0, nan where a parameter lies outside its domain
  F::sources;                                                  // keys of references.bib
  { F::shape_invariant } -> std::convertible_to<bool>;         // whether roughness is a stretch of the slopes
  { f.P22(r2) } -> std::convertible_to<typename F::scalar>;    // joint density of slopes at squared slope r2
  { f.D(xi, r2) } -> std::convertible_to<typename F::scalar>;  // D(z, h2) = P22(h2/z^2)/z^4, never over- or underflowing
  { f.survival(r2) } -> std::convertible_to<typename F::scalar>;     // Pr(slope^2 > r2)
  { f.radius2(xi) } -> std::convertible_to<typename F::scalar>;      // survival(radius2(xi)) = 1 - xi
  { f.P2(t) } -> std::convertible_to<typename F::scalar>;            // density of the slope along an azimuth
  { f.slope_sf(t) } -> std::convertible_to<typename F::scalar>;      // Pr(slope along an azimuth > t)
  { f.slope_excess(t) } -> std::convertible_to<typename F::scalar>;  // int_t^inf slope_sf = E[(slope - t)_+], t >= 0
};
// clang-format on

// A family by its name, whatever its numbers are.
template <template <class> class Family>
struct family_tag {
  template <class T>
  using type = Family<T>;
};

// A slope t >= 0 whose square is finite: the largest stands for all above it.
template <class T>
slope<T> bounded(const slope<T>& t) {
  const T most = largest_slope<T>();
  const auto beyond = t.value.high > most;
  return {select(beyond, double_double<T>(most), t.value),
          select(beyond, double_double<T>(T(most * most)), t.squared)};
}

// A probability above t >= 0 made one for any t by symmetry: 1/2 at 0 and nothing above infinity. The square
// of a finite slope may be infinite.
template <class T, class Upper>
T symmetric_sf(const slope<T>& t_argument, const Upper& upper) {
  const T t = t_argument.value.high, size = abs(t);
  const T q = upper(slope<T>(abs(t_argument.value), t_argument.squared));
  const T above = select(size == T(0), T(0.5) + T(0) * q, select(size <= largest<T>(), q, T(0) * q));
  return select(t < T(0), T(T(1) - above), select(size >= T(0), above, size));
}

}  // namespace microfacet
