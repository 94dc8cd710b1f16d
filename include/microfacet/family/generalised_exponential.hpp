// Generalised exponential slopes: exp(-r^g), from heavier tails than an exponential's (g < 1) through the
// exponential (g = 1) and Beckmann (g = 2) to a disc of equally likely slopes with an edge (g -> inf).
//
// With z = r2^(g/2) and c = 2/g:
//
//   P22(r2)      = exp(-z)/(pi Gamma(1 + c))
//   survival(r2) = Q(c, z)                    special/incomplete_gamma.hpp
//   P2, slope_sf, mean_excess                 special/generalised_exponential_marginal.hpp
//
// The interval of g ends where tables of the density do: for more its edge is too steep for their pieces, for less
// it spans too many powers of two. d'Eon's notebook "Generalized Exponential NDF" has the density alone.
#pragma once

#include <array>
#include <string_view>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/generalised_exponential_marginal.hpp"
#include "microfacet/special/incomplete_gamma.hpp"

namespace microfacet {

template <class T>
class generalised_exponential
    : public radial_defaults<T, part::direct_radius | part::radius_by_odds, of_all> {
 public:
  static constexpr std::string_view name = "generalised_exponential";
  static constexpr std::array<parameter, 1> parameters{{{"g", 0.4, 4.5, 0.4}}};
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};

  explicit generalised_exponential(const T& g)
      : g_(inside(parameters[0], g)),
        c_(T(2) / g_),
        inverse_gamma_(T(1) / incomplete_gamma::gamma_one_plus(c_)) {}

  T zero_or_nan() const { return T(0) * g_; }
  T P22(const double_double<T>& r2) const { return times_exp_minus(norm(), power(r2)); }
  T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    return times_exp_minus(T(square(reciprocal) * norm()), power(quotient(h2, two_prod(z, z), reciprocal)));
  }
  T survival(const double_double<T>& r2) const { return minimum(tails(r2.high, power(r2).high).above, T(1)); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  T radius(const T& xi) const { return select(xi == T(1), infinite<T>(), radius_at(xi, T(-log1p(-xi)))); }
  T radius_at_odds(const T& odds) const { return radius_at(T(odds / (T(1) + odds)), log1p(odds)); }

  T P2(const slope<T>& t) const { return marginal(slope<T>(abs(t.value), t.squared)).density(); }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [this](const slope<T>& x) { return minimum(marginal(x).sf(), T(0.5)); });
  }
  T mean_excess(const slope<T>& x) const { return marginal(x).excess(); }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  T norm() const { return T(1 / pi) * inverse_gamma_; }
  // z, up to where exp(-z) is nothing; of a slope of 0 nearly 0.
  double_double<T> power(const double_double<T>& r2) const {
    return minimum(T(pow(maximum(r2.high, smallest<T>()), T(T(0.5) * g_))), T(single ? 1e3 : 1e4));
  }
  detail::generalised_exponential_marginal<T> marginal(const slope<T>& t) const { return {t, g_, norm()}; }

  struct masses {
    T below, above, rise;  // d below/d log r2
  };
  masses tails(const T& r2_argument, const T& z) const {
    const T r2 = minimum(r2_argument, T(single ? 1e30 : 1e250)),
            rise = times_exp_minus(T(r2 * inverse_gamma_), double_double<T>(z));
    const auto small_z = incomplete_gamma::is_near(c_, z);
    const T part = select_lazy(
        small_z, [&] { return T(rise * incomplete_gamma::series(c_, T(select(small_z, z, T(1))))); },
        [&] {
          const T outside = select(small_z, T(c_ + T(1.5)), z);
          return T(rise * c_ / incomplete_gamma::fraction(c_, outside));
        });
    return {select(small_z, part, T(T(1) - part)), select(small_z, T(T(1) - part), part), rise};
  }
  // Newton's method, below the median on log(1 - survival) against log r2, above on log survival against z.
  T radius_at(const T& xi_argument, const T& depth) const {
    const T xi = maximum(xi_argument, T(T(4096) * smallest<T>()));  // products stay normal
    const auto lower = xi < T(0.5);
    const T target = log(xi);
    const T start =
        select(lower, T(target - log(inverse_gamma_)), T(c_ * log(c_ + depth + sqrt(T(2) * c_ * depth))));
    const T M = iterate(60, start, start == start, [&](const T& now) {
      const masses at = tails(T(exp(now)), T(exp(T(T(0.5) * g_) * now)));
      const T up = (target - log(at.below)) * at.below / at.rise;
      const T stretch = (depth + log(at.above)) * at.above / (c_ * at.rise);
      const T change = select(lower, up, T(c_ * log1p(maximum(stretch, T(-0.5)))));
      return iteration{T(now + change), abs(change) > T(single ? 1e-4 : 1e-9)};
    });
    // Below the median the quotient of P by r2 is known better than its logarithm.
    const T z = exp(T(T(0.5) * g_) * select(lower, M, T(0)));
    const T inner = sqrt(xi_argument) * sqrt(exp(z) / (inverse_gamma_ * incomplete_gamma::series(c_, z)));
    return select(lower, inner, T(exp(T(0.5) * M)));
  }

  T g_, c_, inverse_gamma_;
};

static_assert(radial_family<generalised_exponential<float>> &&
              radial_family<generalised_exponential<double>>);

}  // namespace microfacet
