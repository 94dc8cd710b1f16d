// Bessel K slopes: Beckmann with a Gamma(a, 1) distributed squared roughness; exponential tails.
//
// With y^2 = r2, nu = a - 1/2 (special/bessel.hpp has h_nu(y) = 2 y^nu K_nu(2y)):
//
//   P22(r2)         = 2 y^(a-1) K_{a-1}(2y)/(pi Gamma(a))       infinite at 0 for a <= 1
//   survival(r2)    = 2 y^a K_a(2y)/Gamma(a)
//   P2(t)           = 2 |t|^nu K_nu(2|t|)/(sqrt(pi) Gamma(a))   infinite at 0 for a <= 1/2
//   slope_sf, mean_excess   special/variance_gamma.hpp
//
// a = 1 is K0. d'Eon's notebook "Bessel K NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/bessel.hpp"
#include "microfacet/special/bessel_complement.hpp"
#include "microfacet/special/gamma.hpp"
#include "microfacet/special/variance_gamma.hpp"

namespace microfacet {

template <class T>
class bessel_k
    : public radial_defaults<T, part::P22_by_slope | part::direct_radius | part::float32_sampling_range,
                             of_all> {
 public:
  static constexpr std::string_view name = "bessel_k";
  static constexpr std::array<parameter, 1> parameters{{{"a", 0.0, 1e100, 0.0}}};
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static bool sampling_fits_float32(double a) { return a >= 0.5; }

  // Below least_shape, where all is proportional to a, its powers would leave the range.
  explicit bessel_k(const T& a) : a_(maximum(inside(parameters[0], a), T(least_shape))) {}

  T zero_or_nan() const { return T(0) * a_; }
  T P22(const double_double<T>& r2) const { return density(sqrt(r2), T(1)); }
  // The density of slopes of length y; near its singularity the square of y underflows first.
  T P22_of_slope(const T& y) const { return density(double_double<T>(y), T(1)); }
  T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^2 would overflow, D is zero.
    const T z = maximum(z_argument, T(T(1) / largest_slope<T>())), reciprocal = T(1) / (z * z);
    return density(sqrt(quotient(h2, two_prod(z, z), reciprocal)), reciprocal);
  }
  T survival(const double_double<T>& r2) const {
    const bessel::neighbours<T> k = bessel::orders(a_, sqrt(r2));
    return minimum(T(a_ * k.at * k.decay * k.decay), T(1));
  }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // Newton's method: below the median on log(1 - survival) against log y, above on log(survival) against y.
  T radius(const T& xi_argument) const {
    // Powers of its square root stay normal, and its quotient by a; less is a power of the slope for a > 2.
    const auto smooth = a_ > T(2);
    const T xi = maximum(xi_argument, select(smooth, T(least_smooth), T(T(4096) * smallest<T>())));
    const auto lower = xi < T(0.5);
    const T target = log(select(lower, xi, T(T(1) - xi)));
    const T start = T(0.8) * sqrt(a_);
    const T y = iterate(80, start, start == start, [&](const T& now) {
      const bessel::neighbours<T> k = bessel::orders(a_, double_double<T>(now));
      const T next = select_lazy(
          lower,
          [&] {
            const T cdf = bessel::complement(a_, now, k), slope = T(2) * a_ * (k.below * k.decay * k.decay);
            return T(now * exp(minimum(maximum(T((target - log(cdf)) * cdf / slope), T(-30)), T(1))));
          },
          [&] {
            const T change = (log(a_ * k.at) + k.exponent - target) * now * k.at / (T(2) * k.below);
            return T(now + maximum(change, T(T(-0.5) * now)));
          });
      const T bounded = maximum(next, bessel::least_argument<T>());
      return iteration{bounded, abs(bounded - now) > T(single ? 1e-4 : 1e-9) * now};
    });
    const T less = select(smooth, T(sqrt(xi_argument) / sqrt(xi)), T(1));
    return select(xi_argument == T(0), zero_or_nan(), select(xi == T(1), infinite<T>(), T(y * less)));
  }
  T P2(const slope<T>& t) const {
    const auto finite = a_ > T(0.5);
    const T at_zero = gamma_half_step(a_) * sqrt(a_) / (T(sqrt_pi) * select(finite, T(a_ - T(0.5)), T(1)));
    return select(t.value.high == T(0), select(finite, at_zero, T(at_zero * infinite<T>())),
                  variance_gamma::density(a_, abs(t.value)));
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [this](const slope<T>& x) { return variance_gamma::sf(a_, bounded(x).value); });
  }
  T mean_excess(const slope<T>& x) const { return variance_gamma::excess(a_, x.value); }

 private:
  // At slopes of length y, times `factor` squared, from h_{a-1}: directly for a >= 1/2, else through y^2
  // h_{a-1}, the neighbour below order a.
  T density(const double_double<T>& y, const T& factor) const {
    const auto direct = a_ >= T(0.5);
    const bessel::neighbours<T> k = bessel::orders(T(select(direct, T(a_ - T(1)), a_)), y);
    const T inside = maximum(y.high, bessel::least_argument<T>()), decay = k.decay * factor;
    const T once = select(direct, k.at, T(rounded(T(a_ * k.below / inside)) / inside)) * decay;
    const T value = rounded(once) * (decay * T(1 / pi));
    const auto finite = a_ > T(1);
    const T at_normal = square(factor) / (T(pi) * select(finite, T(a_ - T(1)), T(1))) + zero_or_nan();
    return select(y.high == T(0), select(finite, at_normal, T(at_normal * infinite<T>())), value);
  }

  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double least_shape = single ? 1e-30 : 1e-300, least_smooth = single ? 1e-20 : 1e-190;

  T a_;
};

static_assert(radial_family<bessel_k<float>> && radial_family<bessel_k<double>>);

}  // namespace microfacet
