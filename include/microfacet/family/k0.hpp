// K0 slopes: Beckmann with an exponentially distributed squared roughness; Bessel K at a = 1.
//
//   P22(r2)         = 2 K_0(2y)/pi,  y^2 = r2    infinite at 0
//   survival(r2)    = 2 y K_1(2y)
//   P2(t)           = exp(-2|t|)
//   slope_sf(t)     = exp(-2t)/2
//   mean_excess(x) = exp(-2x)/4
//
// d'Eon's notebook "K0 NDF".
#pragma once

#include <array>
#include <numbers>
#include <string_view>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/bessel_k0.hpp"
#include "microfacet/special/coefficients/visible.hpp"

namespace microfacet {

template <class T>
class k0 : public radial_defaults<T, part::scaled_P2 | part::P22_by_slope | part::direct_radius |
                                         part::scaled_sigma | part::slope_sampling> {
 public:
  static constexpr std::string_view name = "k0";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};

  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  T P22(const double_double<T>& r2) const { return peaked(detail::k0_functions<T>(r2), r2.high); }
  T P22_of_slope(const T& y) const { return peaked(detail::k0_functions<T>(y, T(y * y)), y); }
  MICROFACET_INLINE T D(const T& z_argument, const double_double<T>& h2) const {
    // Where 1/z^4 would overflow, D is zero.
    const T z = maximum(z_argument, T(single ? 1e-9 : 1e-75)), reciprocal = T(1) / (z * z);
    const double_double<T> r2 = quotient(h2, two_prod(z, z), reciprocal);
    const T value = detail::k0_functions<T>(r2).density(T(square(reciprocal) * T(1 / pi)));
    return select(r2.high == T(0), infinite<T>(), value);
  }
  T survival(const double_double<T>& r2) const { return detail::k0_functions<T>(r2).survival(); }
  T radius2(const T& xi) const { return square(radius(xi)); }
  // Newton's method: near the normal on log(1 - survival) against log y, beyond on log(survival) against y.
  T radius(const T& xi_argument) const {
    const T xi = maximum(xi_argument, T(T(0x1p40) * smallest<T>()));  // y^2 keeps its digits
    const T rest = T(1) - xi;
    const auto lower = xi < T(0.3);
    const T target = log(select(lower, xi, rest));
    T y = select(lower, T(sqrt(xi / (T(1) - T(0.5) * log(xi)))), T(T(0.25) - T(0.55) * log(rest)));
    y = iterate(40, y, y == y, [&](const T& now) {
      const detail::k0_functions<T> at(now, T(now * now));
      const auto inner = now < T(0.5625);
      const T slope = T(2) * now * at.density();
      const T within = select_lazy(inner, [&] { return at.within(); }, [&] { return T(T(1) - at.beyond()); });
      const T beyond = select_lazy(inner, [&] { return T(T(1) - at.within()); }, [&] { return at.beyond(); });
      const T left = (target - log(within)) * within / (now * slope);
      const T right = (log(beyond) - target) * beyond / slope;
      const T next = select(lower, T(now * exp(minimum(maximum(left, T(-30)), T(1)))),
                            T(now + maximum(right, T(T(-0.5) * now))));
      return iteration{next, abs(next - now) > T(single ? 1e-4 : 1e-9) * now};
    });
    const auto tiny = (xi_argument < xi) & (xi_argument > T(0));
    return select_lazy(
        tiny, [&] { return radius_of_tiny(T(select(tiny, xi_argument, xi))); },
        [&] { return T(select(xi_argument == T(0), T(0), y)); });
  }
  T P2(const slope<T>& t, const T& factor = T(1)) const {
    return times_exp_minus(factor, scaled(T(2), abs(t.value)));
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) { return times_exp_minus(T(0.5), scaled(T(2), x.value)); });
  }
  T mean_excess(const slope<T>& x) const { return times_exp_minus(T(0.25), scaled(T(2), x.value)); }
  fraction<T> sigma_below(const T& c, const double_double<T>& s2) const {
    const horizon<T> seen(c, s2, T(T(16) * smallest<T>()));  // beyond, exp(-2x) is zero
    return {times_exp_minus(T(lifted(T(0.25)) * seen.s), scaled(T(2), seen.x.value)), T(1)};
  }

  // With the probability of the area below the horizon, xi0 small, the slope is that which -|x| sees; else it
  // is one of all slopes, turned towards x where x sees too little of it.
  visible_slopes<T> visible_slopes_of(const T& x, const T& xi0, const T& xi1, const T& xi2) const {
    const auto up = x > T(0);
    const T X = abs(x), c = select(up, x, T(0)), below = mean_excess(slope<T>(X));
    const T share = select(up, T(below / (c + below)), T(1)), other = c / (c + below + smallest<T>());
    const auto first = xi0 <= share;
    const T V = select(first, xi0, T(T(1) - xi0)) / maximum(select(first, share, other), smallest<T>());
    const T length = T(0.5) * excess_quantile(maximum(V, smallest<T>()));

    const T e = T(-0.5) * log1p(-xi1), leaning = X + length;
    const T R = length, v = xi1, all = R * v, root = sqrt(square(T(x - R)) + T(4) * x * all) + X;
    const T inside = (R * R + T(2) * x * R * (T(2) * v - T(1))) / maximum(root, smallest<T>());
    const T outside = select(all >= x, all, T(T(2) * sqrt(maximum(T(x * all), T(0))) - x));
    const T along = select(first, leaning, select(R <= x, inside, outside));
    const T across2 = select(first, T(e * (e + T(2) * along)), T((R - along) * (R + along)));
    const T valid = nan_unless((xi2 >= T(0)) & (xi2 < T(1)), xi2);
    return {along, sqrt(maximum(across2, T(0))) * elementary::cos_sin_of_turns(T(T(0.5) * valid)).cosine};
  }

 private:
  // Where y^2 may underflow: log xi = 2 log y + log(1 - 2 gamma - 2 log y), gamma Euler's (DLMF 10.31.1).
  static T radius_of_tiny(const T& xi) {
    const T target = log(xi);
    T L = T(0.5) * (target - log(T(1) - target));
    for (int i = 0; i < 4; ++i) {
      const T growth = T(1 - 2 * std::numbers::egamma) - T(2) * L;
      L = L - (T(2) * L + log(growth) - target) / (T(2) - T(2) / growth);
    }
    return exp(L);
  }
  // g with (1 + g) exp(-g) = V, a branch of Lambert's W, in the root of -2 log V; in double one step of Halley's
  // method on g - log(1 + g) follows.
  static T excess_quantile(const T& V) {
    using namespace coefficients;
    const T L = -log(V), s = sqrt(maximum(T(T(2) * L), T(0))),
            g = s * polynomial(by_precision<T>(k0_excess_numerator_32, k0_excess_numerator_64), s) /
                polynomial(by_precision<T>(k0_excess_denominator_32, k0_excess_denominator_64), s);
    if constexpr (sizeof(typename scalar_traits<T>::real) == 4) return g;
    const T r = less_log1p(g) - L, more = T(1) + g;
    return maximum(T(g - T(2) * r * g * more / maximum(T(T(2) * g * g - r), smallest<T>())), T(0));
  }
  static T less_log1p(const T& g) {               // g - log(1 + g), by its series where that cancels
    T s = g / (T(2) + g), s2 = s * s, series(0);  // log(1 + g) = 2 atanh(s), g = 2s/(1 - s)
    for (int k = 15; k >= 3; k -= 2) series = s2 * series + T(1.0 / k);
    return select(g < T(0.5), T(s * (g - T(2) * s2 * series)), T(g - log1p(g)));
  }

  static T peaked(const detail::k0_functions<T>& at, const T& y) {
    return select(y == T(0), infinite<T>(), T(at.density() * T(1 / pi)));
  }
};

static_assert(radial_family<k0<float>> && radial_family<k0<double>>);

}  // namespace microfacet
