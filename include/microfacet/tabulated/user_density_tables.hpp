// The functions of a density of the user's own as tables (plain values of a fixed size), and a family that
// reads them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "microfacet/approx/piecewise_many.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet {

template <class T>
struct user_density_tables {
  using table = piecewise_many<T>;

  table root_P22;      // the square root of P22 at r2: D = (sqrt(P22)/z^2)^2 where P22 itself underflows
  table survival;      // at r2
  table radius;        // at the odds xi/(1 - xi)
  table P2, slope_sf;  // at t > 0
  table slope_excess;  // at t^2; nan where the mean slope is infinite

  // From a family in double precision.
  template <class Family>
  void build(const Family& family);

  double error() const {
    double most = 0;
    for (const table* t : {&root_P22, &survival, &radius, &P2, &slope_sf, &slope_excess})
      most = (std::max)(most, t->error);
    return most;
  }
};

// On scalars R, from tables that must outlive it.
template <class R>
class tabulated_user_density : public radial_defaults<R, part::direct_radius> {
 public:
  using tables = user_density_tables<typename scalar_traits<R>::real>;
  static constexpr std::string_view name = "radial";
  static constexpr std::array<std::string_view, 0> sources{};

  explicit tabulated_user_density(const tables& t) : t_(&t) {}

  R P22(const double_double<R>& r2) const { return square(t_->root_P22(r2)); }
  R D(const R& z_argument, const double_double<R>& h2) const {
    const R z = maximum(z_argument, R(R(4) * sqrt(smallest<R>()))), reciprocal = R(1) / (z * z);
    return square(R(t_->root_P22(quotient(h2, two_prod(z, z), reciprocal)) * reciprocal));
  }
  R survival(const double_double<R>& r2) const { return t_->survival(r2); }
  R radius(const R& xi) const {
    return t_->radius(quotient(double_double<R>(xi), fast_two_sum(R(1), R(-xi))));
  }
  R radius_of_odds(const R& odds) const { return t_->radius(double_double<R>(odds)); }
  R radius2(const R& xi) const { return square(radius(xi)); }
  R P2(const slope<R>& t) const { return t_->P2(abs(t.value)); }
  R slope_sf(const slope<R>& t) const {
    return symmetric_sf(t, [this](const slope<R>& x) { return t_->slope_sf(x.value); });
  }
  R slope_excess(const slope<R>& x) const { return t_->slope_excess(x.squared); }

 private:
  const tables* t_;
};

template <class T>
template <class Family>
void user_density_tables<T>::build(const Family& family) {
  // Logarithms of the smallest slope, of its square, and of slopes and squares beyond which all is a power.
  constexpr bool single = sizeof(T) == 4;
  constexpr double least = single ? -87 : -700, slope_end = single ? 46 : 60, square_end = 2 * slope_end;
  constexpr double tiny = (std::numeric_limits<T>::min)();
  const auto fill = [](table& t, const auto& function, const piecewise_many_range& range) {
    const auto sample = [&](const double* L, double* f, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) f[i] = function(L[i]);
    };
    t = piecewise_many_fit<T>(sample, range)();
  };
  const auto square_of = [](double L) {
    const double r = std::exp(0.5 * L);
    return two_prod(r, r);
  };
  const double_double<double> zero(0.0);
  fill(root_P22, [&](double L) { return std::sqrt(family.P22(square_of(L))); },
       {least, least, square_end, std::sqrt(family.P22(zero)), single ? double{tiny} : 1e-180});
  fill(survival, [&](double L) { return family.survival(square_of(L)); },
       {least, least, square_end, 1, tiny});
  fill(P2, [&](double L) { return family.P2(std::exp(L)); }, {least, least, slope_end, family.P2(0.0), tiny});
  fill(slope_sf, [&](double L) { return family.slope_sf(std::exp(L)); },
       {least, least, slope_end, 0.5, tiny});
  if (const double mean = family.slope_excess(0.0); mean <= largest<double>()) {
    fill(slope_excess, [&](double L) { return family.slope_excess(std::exp(0.5 * L)); },
         {least, least, square_end, mean, tiny});
  } else {
    slope_excess = table::zero_or_nan();
  }
  // Above the median 1 - xi loses what the odds have.
  fill(radius, [&](double L) { return family.radius_of_odds(std::exp(L)); },
       {least, 0, single ? 17 : 37, 0, 0});
}

}  // namespace microfacet
