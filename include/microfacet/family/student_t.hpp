// Student-T slopes: power-law tails set by gamma, through GGX (gamma = 2) to Beckmann (gamma -> inf).
//
// With k = gamma - 1 and A(t) = 1 + t/k:
//
//   P22(r2)         = A(r2)^(-gamma)/pi
//   survival(r2)    = A(r2)^(-k)
//   P2(t)           = N A(t^2)^(-k - 1/2),  N = Gamma(k + 1/2)/(sqrt(pi k) Gamma(k))
//   slope_sf(t), mean_excess(x)   A(t^2)^(-k) times what special/student.hpp has
//
// Domain: gamma > 3/2; at 3/2 the mean slope, and with it sigma, diverges. The density and its slope
// marginals need gamma > 1 only. Ribardiere et al. 2017; d'Eon's notebook "Student-T NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/logarithms.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/gamma.hpp"
#include "microfacet/special/spherical_cap.hpp"
#include "microfacet/special/student.hpp"

namespace microfacet {

template <class T>
class student_t
    : public radial_defaults<T,
                             part::scaled_P2 | part::survival_by_slope | part::direct_radius |
                                 part::scaled_excess | part::tail_quotients | part::mixture_sampling |
                                 part::special_slope_sampling | part::float32_sampling_range,
                             of_slope_sf | of_mean_excess> {
 public:
  static constexpr std::string_view name = "student_t";
  static constexpr std::array<parameter, 1> parameters{{{"gamma", 1.5, inf, 1.0}}};
  static constexpr std::array<std::string_view, 2> sources{"ribardiere2017std", "deon2020hitchhiker"};

  // Beyond gaussian_ the tails are Beckmann's to rounding, as far as they are numbers.
  MICROFACET_INLINE explicit student_t(const T& gamma)
      : k_(minimum(T(inside(parameters[0], gamma) - T(1)), T(gaussian))),
        norm_(gamma_half_step(k_) / T(sqrt_pi)),
        inverse_k_(quotient(double_double<T>(T(1)), double_double<T>(k_))) {}

  T zero_or_nan() const { return T(0) * k_; }
  T P22(const double_double<T>& r2) const { return power(T(1 / pi), r2, T(k_ + T(1))); }
  // z^-4 A^-gamma = B^-2 A^(2 - gamma) with A = 1 + h2/(k z^2), B = z^2 A.
  MICROFACET_INLINE T D(const T& z_argument, const double_double<T>& h2) const {
    const T least = T(single ? 1e-13 : 1e-140), z = maximum(z_argument, least);
    const double_double<T> k_z2 = k_ * two_prod(z, z);
    const auto grazing = (z_argument < least) | (h2.high * T(1 / largest_ratio) > k_z2.high);
    // Where z^2 is nothing beside the other term, and the rounding of z^2 underflows.
    const auto power_of_z = [&] {
      const T one(1), positive = select(grazing, maximum(z_argument, smallest<T>()), one);
      const double_double<T> steepness = log_double_double(select(grazing, h2, double_double<T>(one))) +
                                         -log_double_double(double_double<T>(k_));
      return T(exp(-(steepness * two_sum(k_, one) +
                     log_double_double(double_double<T>(positive)) * two_sum(T(2), T(T(-2) * k_)))) *
               T(1 / pi));
    };
    const auto in_one = [&] {
      const log_of_quotient<T> A = log1p_of_quotient(select(grazing, double_double<T>(T(0)), h2), k_z2);
      // Both factors before the exponential, so that nothing underflows but the result, as far as their square is a number.
      const T inverse_B = k_ * A.reciprocal, most = T(single ? 1e15 : 1e140);
      const auto apart = (inverse_B > most) | (inverse_B < T(1) / most);
      const T factor = select(apart, inverse_B, square(inverse_B)) * T(1 / pi);
      return T(times_exp_minus(factor, two_sum(k_, T(-1)) * A.log) * select(apart, inverse_B, T(1)));
    };
    return select_lazy(grazing, power_of_z, in_one);
  }
  T survival(const double_double<T>& r2) const { return power(T(1), r2, k_); }
  // Of a slope whose square may be infinite.
  T survival_of_slope(const T& r) const { return times_exp_minus(T(1), k_ * growth(slope<T>(r))); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // For gamma near 1 slopes reach beyond the square root of the largest number.
  T radius(const T& xi) const {
    const T depth = log1p(-xi), growth = depth / k_;
    return sqrt((T(0) - depth) * expm1_over(growth)) * exp(T(-0.5) * growth);
  }
  T P2(const slope<T>& t, const T& factor = T(1)) const {
    return times_exp_minus(T(norm_ * factor), T(k_ + T(0.5)) * growth(t));
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [this](const slope<T>& x) {
      return times_power(x, k_, [this](const T& y, const T& q) { return student::tail(k_, y, q); });
    });
  }
  T mean_excess(const slope<T>& x, const T& factor = T(1)) const {
    const T k = nan_unless(k_ > T(parameters[0].lower - 1.0), k_);
    return times_power(x, k, [&](const T& y, const T& q) { return student::excess(k, y, q); }, factor);
  }

  // What smith/visible/inversion.hpp asks for.
  T sf_over_density(const T& t) const {
    const T y = t * t * inverse_k_.high;
    return student::tail(k_, y, T(log1p(y))) * sqrt(T(1) + y) / norm_;
  }
  T moment_over_density(const T& t, const T&) const { return (k_ + t * t) / (T(2) * k_ - T(1)); }
  // A difference, where it loses little.
  T excess_over_density(const T& t, const T& sf) const {
    const T y = t * t * inverse_k_.high;
    const auto series = [&] { return T(student::excess(k_, y, T(log1p(y))) * sqrt(T(1) + y) / norm_); };
    const auto difference = [&] { return T(moment_over_density(t, sf) - t * sf); };
    if constexpr (records<T>) {
      return series();
    } else {
      return select_lazy(t * t < T(0.5), [&] { return difference(); }, [&] { return series(); });
    }
  }
  T score(const T& t, const T&) const { return (T(-2) * k_ - T(1)) * t / (k_ + t * t); }
  T log_density_ratio(const T& t, const T& v) const {
    return (k_ + T(0.5)) * log1p(T(v * ((T(2) * t + v) / (k_ + t * t))));
  }
  T survival_radius(const T& depth) const {
    return minimum(T(sqrt(k_ * expm1(T(depth / k_)))), largest_slope<T>());
  }
  T moment_radius(const T& t, const T& depth) const {
    const T change = minimum(T((k_ + t * t) * expm1(T(depth / (k_ - T(0.5))))), square(largest_slope<T>()));
    return change / (t + sqrt(t * t + change) + smallest<T>());
  }
  T inverse_tail() const { return T(1) / (T(2) * k_ - T(1)); }
  // Where near_moments(t, d) holds: a series in d, whose terms obey the differential equation of P2.
  auto is_near(const T& t, const T& d, const T&) const {
    constexpr double most = sizeof(typename scalar_traits<T>::real) == 4 ? 0.6 : 0.15;
    const T length2 = k_ + t * t, unit = (T(2) * k_ + T(1)) * d;
    return (t * unit < T(most) * length2) & (d * unit < T(most * most) * length2);
  }
  near_integrals<T> near_moments(const T& t, const T& d) const {
    const T unit = d / (k_ + t * t), a = -t * unit, b = -d * unit, twice_k = T(2) * k_;
    T before(0), term(1), mass(1), moment(0.5);
    for (int n = 1; n < 12; ++n) {
      const T next = ((twice_k + T(2 * n - 1)) * a * term + (twice_k + T(n - 1)) * b * before) * T(1.0 / n);
      before = term, term = next;
      mass = mass + next * T(1.0 / (n + 1)), moment = moment + next * T(1.0 / (n + 2));
    }
    return {d * mass, d * d * moment};
  }
  // Of a slope in three dimensions at survival exp(-depth), given its component `along`: the rest of it.
  T across(const T& along, const T& depth) const {
    return sqrt(k_ + along * along) * sqrt(expm1(T(depth / (k_ + T(0.5)))));
  }
  // Where a table gives J(t)/t = 1/v: M(P) = (1 - xi) M(t), and the slope across.
  T moment_beyond(const T& t, const T& xi) const {
    const T change = (k_ + t * t) * expm1(T(-log1p(-xi) / (k_ - T(0.5))));
    return sqrt(minimum(T(t * t + change), square(largest_slope<T>())));
  }
  T across_of_tables(const T& along, const T& xi, const T& turn) const {
    return this->across(along, T(-log1p(-xi))) * elementary::cos_sin_of_turns(T(T(0.5) * turn)).cosine;
  }
  static bool sampling_fits_float32(double gamma) { return gamma >= 2.5; }
  // gamma = 3 takes two uniforms.
  auto has_closed_slopes() const { return k_ == T(2); }
  static bool draws_in_closed_form(double gamma) { return gamma == 3; }
  visible_slopes<T> closed_slopes(const T& x, const T& xi0, const T& xi1) const {
    const T length2 = T(2) + x * x, inverse = T(1) / sqrt(length2), scale = T(sqrt_two);
    const cap_direction<T> w{scale * inverse, x * inverse, length2 * inverse * T(1 / sqrt_two)};
    const T share = sqrt(T(1) - xi0);
    const vec3<T> m = spherical_cap<T>(w, share, T(T(1) - share)).facet_of_cubic(xi1);
    const T reciprocal = scale / m.z;
    return {m.x * reciprocal, m.y * reciprocal};
  }

 private:
  // scale A(r2)^(-exponent), and that times a function of r2/k and log A.
  T power(const T& scale, const double_double<T>& r2, const T& exponent) const {
    return times_exp_minus(scale, exponent * log1p_double_double(r2 * inverse_k_));
  }
  template <class Factor>
  T times_power(const slope<T>& t, const T& exponent, const Factor& factor, const T& scale = T(1)) const {
    const double_double<T> q = growth(t), y = t.squared * inverse_k_;
    // Both parts, as q has them: beside an underflowing product `low` may be more than a rounding.
    const T most = square(largest_slope<T>()), whole = select(y.high < most, T(y.high + y.low), most);
    return times_exp_minus(T(scale * factor(whole, q.high)), exponent * q);
  }
  // log A(t^2), also where t^2 is infinite.
  double_double<T> growth(const slope<T>& t) const {
    if constexpr (records<T>) return log1p_double_double(t.squared * inverse_k_);
    const T size = abs(t.value.high);
    const auto steep = size > largest_slope<T>();
    return select_lazy(
        steep,
        [&] {
          return scaled(T(2), log_double_double(double_double<T>(select(steep, size, T(1))))) +
                 log_double_double(inverse_k_);
        },
        [&] { return log1p_double_double(t.squared * inverse_k_); });
  }

  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double largest_ratio = single ? 1e30 : 1e290;
  static constexpr double gaussian = single ? 1e15 : 1e30;

  T k_, norm_;
  double_double<T> inverse_k_;
};

static_assert(radial_family<student_t<float>> && radial_family<student_t<double>>);

}  // namespace microfacet
