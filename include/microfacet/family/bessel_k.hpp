// Bessel K slopes: Beckmann with a Gamma(a, 1) distributed squared roughness; exponential tails.
//
// With y^2 = r2, nu = a - 1/2 (special/bessel.hpp has h_nu(y) = 2 y^nu K_nu(2y)):
//
//   P22(r2)         = 2 y^(a-1) K_{a-1}(2y)/(pi Gamma(a))       infinite at 0 for a <= 1
//   survival(r2)    = 2 y^a K_a(2y)/Gamma(a)
//   P2(t)           = 2 |t|^nu K_nu(2|t|)/(sqrt(pi) Gamma(a))   infinite at 0 for a <= 1/2
//   slope_sf, slope_excess   special/variance_gamma.hpp
//
// a = 1 is K0. d'Eon's notebook "Bessel K NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/bessel.hpp"
#include "microfacet/special/variance_gamma.hpp"

namespace microfacet {

namespace detail {

// The isotropic part of Bessel K for any a > 0, as a function of y = sqrt(r2).
template <class T>
class bessel_radial {
 public:
  explicit bessel_radial(const T& a) : a_(a) {}

  // log P22 from h_{a-1}: directly for a >= 1/2, else through y^2 h_{a-1}, the neighbour below order a.
  T log_P22(const T& y) const {
    const T inside = clamp(y);
    const auto direct = a_ >= T(0.5);
    const bessel::neighbours<T> k = bessel::orders(T(select(direct, T(a_ - T(1)), a_)), inside);
    const T value = bessel::log_unscaled(T(select(direct, k.at, T(a_ * k.below)) / T(pi)), k.exponent) -
                    select(direct, T(0), T(T(2) * log(inside)));
    const auto finite = a_ > T(1);
    const T at_normal = select(finite, T(-log(T(pi) * select(finite, T(a_ - T(1)), T(1)))), T(inf));
    return select(y == T(0), T(at_normal + value * T(0)), value);
  }
  T survival(const T& y) const {
    const bessel::neighbours<T> k = bessel::orders(a_, clamp(y));
    return exp(bessel::log_unscaled(T(a_ * k.at), k.exponent));
  }

  // Newton's method: below the median on log(1 - survival) against log y, above on log(survival) against y.
  T inverse(const T& xi_argument) const {
    constexpr int most = 80;
    const T xi =
        maximum(xi_argument, T(T(4096) * smallest<T>()));  // its square root's powers stay normal numbers
    const auto lower = xi < T(0.5);
    const auto large = a_ > T(20);
    const T target = log(select(lower, xi, T(T(1) - xi)));
    T y = T(0.8) * sqrt(a_);
    auto moving = y == y;  // a lane that has converged stays, so that a batch gives what a scalar gives
    for (int i = 0; i < most; ++i) {
      const bessel::neighbours<T> k = bessel::orders(a_, y);
      const T unscale = exp(k.exponent);
      const T small_cdf =
          bessel::complement_of_large_order(T(select(large, a_, T(30))), T(select(large, y, T(1))));
      const T cdf = select(large & (y * y < a_), small_cdf, T(k.complement_above + unscale * k.below));
      const T left = (target - log(cdf)) * cdf / (T(2) * a_ * unscale * k.below);
      const T right = (log(a_ * k.at) + k.exponent - target) * y * k.at / (T(2) * k.below);
      const T left_y = y * exp(minimum(maximum(left, T(-30)), T(1)));
      const T right_y = y + maximum(right, T(T(-0.5) * y));
      const T next = maximum(T(select(lower, left_y, right_y)), bessel::least_argument<T>());
      const auto far = abs(next - y) > T(1e-9) * y;
      y = select(moving, next, y);
      moving = moving & far;
      if (!any(moving)) break;
    }
    return select(xi_argument == T(0), T(0), select(xi_argument == T(1), T(inf), y));
  }

  // Neither 0 nor infinite; beyond 1e9 sqrt(a) every result is zero.
  T clamp(const T& y) const {
    return minimum(maximum(y, bessel::least_argument<T>()), T(T(1e9) * maximum(sqrt(a_), T(1))));
  }

 private:
  T a_;
};

}  // namespace detail

template <class T>
class bessel_k {
 public:
  using scalar = T;
  static constexpr std::string_view name = "bessel_k";
  static constexpr std::array<parameter, 1> parameters{{{"a", 0.0, inf, 0.0}}};
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool shape_invariant = true;
  static constexpr bool native_float32 = false;
  static constexpr unsigned costly = of_all;

  explicit bessel_k(const T& a) : a_(where((a > T(0)) & (a < T(inf)), a)), radial_(a_) {}

  T nothing() const { return T(0) * a_; }
  T P22(const twofold<T>& r2) const { return P22_of_slope(sqrt(r2.high)); }
  // The density of slopes of length y; near its singularity the square of y underflows first.
  T P22_of_slope(const T& y) const { return exp(radial_.log_P22(y)); }
  T D(const T& z_argument, const twofold<T>& h2) const {
    const T z = maximum(z_argument, T(T(4) * sqrt(smallest<T>())));
    return density_from_log(radial_.log_P22(T(sqrt(h2.high) / z)), z);
  }
  T survival(const twofold<T>& r2) const { return radial_.survival(sqrt(r2.high)); }
  T radius(const T& xi) const { return radial_.inverse(xi); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  T P2(const slope<T>& t_argument) const {
    const T t = t_argument.value.high;
    const T inside = radial_.clamp(abs(t));
    const T value = variance_gamma::density(a_, bessel::orders(T(a_ - T(0.5)), inside));
    const auto finite = a_ > T(0.5);
    const T at_zero = gamma_half_step(a_) * sqrt(a_) / (T(sqrt_pi) * select(finite, T(a_ - T(0.5)), T(1)));
    return select(t == T(0), select(finite, at_zero, T(at_zero * T(inf))), value);
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(
        t, [this](const slope<T>& x) { return variance_gamma::tails(a_, radial_.clamp(x.value.high)).sf; });
  }
  T slope_excess(const slope<T>& x) const {
    return variance_gamma::tails(a_, radial_.clamp(x.value.high)).excess;
  }

 private:
  T a_;
  detail::bessel_radial<T> radial_;
};

static_assert(radial_family<bessel_k<double>>);

}  // namespace microfacet
