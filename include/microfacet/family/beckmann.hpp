// Beckmann: Gaussian slopes.
//
//   P22(r2)         = exp(-r2)/pi
//   survival(r2)    = exp(-r2)
//   P2(t)           = exp(-t^2)/sqrt(pi)
//   slope_sf(t)     = erfc(t)/2
//   mean_excess(x) = ierfc(x)/2
//
// Beckmann and Spizzichino 1963; Walter et al. 2007; Heitz 2014.
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/bivariate.hpp"
#include "microfacet/special/coefficients/visible.hpp"
#include "microfacet/special/erf.hpp"

namespace microfacet {

namespace detail {
// Where smith/visible/started.hpp starts.
struct beckmann_start {
  static constexpr int steps = 1;
  static constexpr double peak = 1 / sqrt_pi, inverse_peak = sqrt_pi, excess_at_0 = 0.5 / sqrt_pi;

  template <class T, class Mask>
  static T above(const visible_depth<T, Mask>& at, const T& parabola) {
    const variables<T> s(at);
    // P2 is between P2(0) and P2(x), so that ((x - t)/x)^2 lies between exp(-depth) and exp(x^2 - depth).
    const T falls = at.depth * s.inverse * polynomial(coefficients::visible_lower, s.x, at.root);
    const T fall = minimum(maximum(falls, T(T(0.5) * (at.depth - at.X * at.X))), T(T(0.5) * at.depth));
    const T upper = parabola * polynomial(coefficients::visible_upper, s.x, s.depth);
    return select(at.lower, T(-at.X * expm1(T(-fall))), upper);
  }
  template <class T, class Mask>
  static T below(const visible_depth<T, Mask>& at, const T&) {
    const variables<T> s(at);
    const T grown = multiply_add(at.root, polynomial(coefficients::visible_below, s.x, s.depth), at.depth);
    return grown / (at.X + sqrt(multiply_add(at.X, at.X, maximum(grown, T(0)))) + smallest<T>());
  }

 private:
  // 1/(1.5 + X), X/(1.5 + X) and root/(2 + root), from one quotient.
  template <class T>
  struct variables {
    T inverse, x, depth;
    template <class Mask>
    explicit variables(const visible_depth<T, Mask>& at) {
      const T wide = T(1.5) + at.X, deep = T(2) + at.root, both = T(1) / (wide * deep);
      inverse = both * deep, x = at.X * inverse, depth = at.root * both * wide;
    }
  };
};
}  // namespace detail

template <class T>
class beckmann : public radial_defaults<T, part::scaled_P2 | part::scaled_sigma | part::tail_quotients |
                                               part::quantile_across | part::mixture_sampling |
                                               part::started_inversion | part::closed_excess_quantile> {
 public:
  static constexpr std::string_view name = "beckmann";
  static constexpr std::array<std::string_view, 3> sources{"beckmann1963scattering", "walter2007microfacet",
                                                           "deon2020hitchhiker"};
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  T P22(const double_double<T>& r2) const { return times_exp_minus(T(1 / pi), r2); }
  MICROFACET_INLINE T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    return times_exp_minus(T(square(reciprocal) * T(1 / pi)), quotient(h2, two_prod(z, z), reciprocal));
  }
  T survival(const double_double<T>& r2) const { return times_exp_minus(T(1), r2); }
  T radius2(const T& xi) const { return -log1p(-xi); }
  T P2(const slope<T>& t, const T& factor = T(1)) const {
    return times_exp_minus(T(T(1 / sqrt_pi) * factor), t.squared);
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) {
      return times_exp_minus(T(T(0.5) * erfc_scaled(x.value.high)), x.squared);
    });
  }
  T mean_excess(const slope<T>& x) const {
    return times_exp_minus(T(T(0.5) * ierfc_scaled(x.value.high)), x.squared);
  }
  fraction<T> sigma_below(const T& c, const double_double<T>& s2) const {
    const horizon<T> seen(c, s2, T(T(16) * smallest<T>()));  // beyond, exp(-x^2) is zero
    const auto [numerator, denominator] = ierfc_scaled_fraction(seen.x.value.high);
    return {times_exp_minus(T(lifted(T(0.5)) * (seen.s * numerator)), seen.x.squared), denominator};
  }

  // What smith/visible/inversion.hpp asks for.
  T sf_over_density(const T& t) const {
    return select_lazy(
        t > detail::where_erfc_lives(t), [&] { return T(T(0.5) / t * far_tail(t, {2, 12, 120, 1680})); },
        [&] { return T(T(0.5 * sqrt_pi) * erfc_scaled(t)); });
  }
  T excess_over_density(const T& t, const T&) const {
    return select_lazy(
        t > detail::where_erfc_lives(t),
        [&] { return T(T(0.25) / (t * t) * far_tail(t, {6, 60, 840, 15120})); },
        [&] { return T(T(0.5 * sqrt_pi) * ierfc_scaled(t)); });
  }
  T moment_over_density(const T&, const T&) const { return T(0.5); }
  T score(const T& t, const T&) const { return T(-2) * t; }
  T log_density_ratio(const T& t, const T& v) const { return v * (T(2) * t + v); }
  T survival_radius(const T& depth) const { return sqrt(depth); }
  T moment_radius(const T& t, const T& depth) const {
    return depth / (t + sqrt(t * t + depth) + smallest<T>());
  }
  T inverse_tail() const { return T(0); }
  // Where near_moments(t, d) holds: a series in d, of which term n obeys the recurrence of Hermite's
  // polynomials.
  auto is_near(const T& t, const T& d, const T&) const {
    return d * (T(1) + T(2) * t) < T(single ? 0.6 : 0.15);
  }
  near_integrals<T> near_moments(const T& t, const T& d) const {
    const T a = T(-2) * t * d, b = T(-2) * d * d;
    T before(0), term(1), mass(1), moment(0.5);
    for (int n = 1; n < 11; ++n) {
      const T next = (a * term + b * before) * T(1.0 / n);
      before = term, term = next;
      mass = mass + next * T(1.0 / (n + 1)), moment = moment + next * T(1.0 / (n + 2));
    }
    return {d * mass, d * d * moment};
  }
  static constexpr detail::beckmann_start start() { return {}; }
  static T over_density(const T& t) { return T(sqrt_pi) * exp(minimum(T(t * t), T(80))); }
  T closed_excess_radius(const T& v) const { return ierfc_quotient_inverse(v); }
  // The slope across the plane of incidence is independent of that in it.
  T across_by_quantile(const T& xi) const { return erfc_inverse_of_half(maximum(xi, smallest<T>())); }
  // Where a table gives J(t)/t = 1/v: M(P) = (1 - xi) M(t), and the slope across.
  T moment_beyond(const T& t, const T& xi) const { return sqrt(t * t - log1p(-xi)); }
  T across_of_tables(const T&, const T& xi, const T&) const { return across_by_quantile(xi); }

 private:
  // Where exp(-t^2) is zero its quotients have asymptotic series in -1/(2t)^2 (Abramowitz and Stegun 7.2.14).
  static T far_tail(const T& t, const std::array<double, 4>& c) {
    const T y = T(0.25) / (t * t);
    return T(1) - y * (T(c[0]) - y * (T(c[1]) - y * (T(c[2]) - y * T(c[3]))));
  }
};

static_assert(radial_family<beckmann<float>> && radial_family<beckmann<double>>);

}  // namespace microfacet
