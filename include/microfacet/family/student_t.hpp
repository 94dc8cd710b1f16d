// Student-T slopes: power-law tails set by gamma, through GGX (gamma = 2) to Beckmann (gamma -> inf).
//
// With k = gamma - 1 and A(t) = 1 + t/k:
//
//   P22(r2)         = A(r2)^(-gamma)/pi
//   survival(r2)    = A(r2)^(-k)
//   P2(t)           = N A(t^2)^(-k - 1/2),  N = Gamma(k + 1/2)/(sqrt(pi k) Gamma(k))
//   slope_sf(t)     = Student's t tail, an incomplete Beta function
//   slope_excess(x) = N k/(2k - 1) A(x^2)^(1/2 - k) - x slope_sf(x) for small x, a continued fraction for
//   large
//
// Domain: gamma > 3/2; at 3/2 the mean slope, and with it sigma, diverges. The density and its slope
// marginals need gamma > 1 only. Ribardiere et al. 2017; d'Eon's notebook "Student-T NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/gamma.hpp"
#include "microfacet/special/student.hpp"

namespace microfacet {

template <class T>
class student_t {
 public:
  using scalar = T;
  static constexpr std::string_view name = "student_t";
  static constexpr std::array<parameter, 1> parameters{{{"gamma", 1.5, inf, 1.0}}};
  static constexpr std::array<std::string_view, 2> sources{"ribardiere2017std", "deon2020hitchhiker"};
  static constexpr bool shape_invariant = true;
  static constexpr bool native_float32 = false, costly = true;

  explicit student_t(const T& gamma)
      : k_(where((gamma > T(parameters[0].density_lower)) & (gamma < T(inf)), T(gamma - T(1)))),
        norm_(gamma_half_step(k_) / T(sqrt_pi)),
        inverse_k_(quotient(twofold<T>(T(1)), twofold<T>(k_))) {}

  T nothing() const { return T(0) * k_; }
  T P22(const twofold<T>& r2) const { return power(r2, T(k_ + T(1))) * T(1 / pi); }
  // z^(2 gamma - 4) (z^2 + h2/k)^-gamma, in one exponent.
  T D(const T& z_argument, const twofold<T>& h2) const {
    const T z = maximum(z_argument, T(1) / largest_slope<T>());
    const twofold<T> z2 = exact_product(z, z), gamma = exact_sum(k_, T(1));
    const twofold<T> ratio = quotient(h2 * inverse_k_, z2);
    const twofold<T> exponent = log1p_twofold(ratio) * gamma, rest = log_twofold(z2);
    const twofold<T> sum = exact_sum(exponent.high, T(T(2) * rest.high));
    return exp(-twofold<T>(sum.high, T(sum.low + (exponent.low + T(2) * rest.low)))) * T(1 / pi);
  }
  T survival(const twofold<T>& r2) const { return power(r2, k_); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // For gamma near 1 slopes reach beyond the square root of the largest number.
  T radius(const T& xi) const {
    const T growth = log1p(-xi) / k_;
    return sqrt(-k_ * expm1(growth)) * exp(T(-0.5) * growth);
  }
  T P2(const slope<T>& t) const { return norm_ * power(t.squared, T(k_ + T(0.5))); }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [this](const slope<T>& x) { return upper_tail(x.value.high); });
  }
  T slope_excess(const slope<T>& x_argument) const {
    const T x = x_argument.value.high;
    const T k = where(k_ > T(parameters[0].lower - 1.0), k_), x2 = x * x;
    const auto tail = student::in_tail(k, x2);
    const auto far = [&] {
      const T inside = select(tail, x, T(sqrt(T(2) + k)));
      return T(P2(inside) * student::excess_over_density(k, inside));
    };
    const auto near = [&] {
      return T(norm_ * k / (T(2) * k - T(1)) * power(x2, T(k - T(0.5))) - x * upper_tail(x));
    };
    return choose(tail, far, near);
  }

 private:
  T power(const twofold<T>& r2, const T& exponent) const {
    return exp(-(log1p_twofold(r2 * inverse_k_) * twofold<T>(exponent)));
  }

  T upper_tail(const T& x) const {
    const auto tail = student::in_tail(k_, T(x * x));
    const auto far = [&] {
      const T inside = select(tail, x, T(sqrt(T(2) + k_)));
      return T(P2(inside) * student::tail_over_density(k_, inside));
    };
    const auto near = [&] {
      const T inside = select(tail, T(0), x);
      return T(T(0.5) - P2(inside) * student::centre_over_density(k_, inside));
    };
    return choose(tail, far, near);
  }

  T k_, norm_;
  twofold<T> inverse_k_;
};

static_assert(radial_family<student_t<double>>);

}  // namespace microfacet
