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

  explicit student_t(const T& gamma)
      : k_(where((gamma > T(parameters[0].density_lower)) & (gamma < T(inf)), T(gamma - T(1)))),
        norm_(gamma_half_step(k_) / T(sqrt_pi)) {}

  T P22(const T& r2) const { return power(r2, T(k_ + T(1))) / T(pi); }
  T D(const T& z, const T& h2) const {
    return density_from_log(T(-(k_ + T(1)) * log1p(h2 / (z * z * k_))), z) / T(pi);
  }
  T survival(const T& r2) const { return power(r2, k_); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // For gamma near 1 slopes reach beyond the square root of the largest number.
  T radius(const T& xi) const {
    const T growth = log1p(-xi) / k_;
    return sqrt(-k_ * expm1(growth)) * exp(T(-0.5) * growth);
  }
  T P2(const T& t) const { return norm_ * power(T(t * t), T(k_ + T(0.5))); }
  T slope_sf(const T& t) const {
    return symmetric_sf(t, [this](const T& x) { return upper_tail(x); });
  }
  T slope_excess(const T& x) const {
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
  T power(const T& r2, const T& exponent) const { return exp(-exponent * log1p(r2 / k_)); }

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
};

static_assert(radial_family<student_t<double>>);

}  // namespace microfacet
