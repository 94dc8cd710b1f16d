// What smith/visible/inversion.hpp asks of a family, from the functions of any radial family: quotients of tails
// by the density of slopes along an axis, and inverses. Meant for prepared densities, whose functions cost
// alike; a family itself takes their place where there are no tables of it that keep the contract.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/approx/gauss.hpp"
#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet {

namespace detail {
// Gauss' rule on [0, 1].
struct gauss_of_unit {
  std::array<double, 24> node, weight;
  gauss_of_unit() {
    const gauss_legendre<24> rule;
    for (std::size_t i = 0; i < node.size(); ++i)
      node[i] = 0.5 * (1 + rule.node[i]), weight[i] = 0.5 * rule.weight[i];
  }
};
inline const gauss_of_unit rule_across;
}  // namespace detail

template <class Family, class T>
class visible_tails {
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

 public:
  explicit visible_tails(const Family& family) : family_(family) {}

  const auto& start() const
    requires requires(const Family f) { f.visible().start.steps; }
  {
    return family_.visible().start;
  }
  // Smaller probabilities leave the range of P2.
  static T least_share() { return T(single ? 1e-30 : 1e-250); }
  T density(const T& t) const { return maximum(P2(off_zero(t)), smallest<T>()); }
  T slope_sf(const T& t) const {
    return called([&] { return family_.slope_sf(slope<T>(off_zero(t))); });
  }
  T mean_excess(const T& t) const {
    return called([&] { return family_.mean_excess(slope<T>(off_zero(t))); });
  }
  T sf_over_density(const T& t) const { return slope_sf(t) / density(t); }
  // Nearly: exact for an exponential, and far out for a power and a Gaussian.
  // Beyond the end of a light tail all of it is 0.
  T score(const T& t, const T& sf, const T& excess) const {
    const T ratio = sf * sf / excess;
    const T value = (ratio - T(2)) * t * t / (sf * (t * t + T(0.25) * sf * sf));
    return select(excess > T(0), value, T(0));
  }
  T survival_radius(const T& depth) const {
    if constexpr (radius_by_odds<Family>) {
      return family_.radius_at_odds(expm1(depth));
    } else {
      const T xi = minimum(T(-expm1(-depth)), T(single ? 1 - 0x1p-24 : 1 - 0x1p-53));
      if constexpr (direct_radius<Family>) {
        return family_.radius(xi);
      } else {
        return sqrt(family_.radius2(xi));
      }
    }
  }
  T moment_radius(const T& t, const T& depth) const {
    const T moment = mean_excess(t) / density(t) + t * sf_over_density(t);
    // As of a Gaussian: exact for small depths.
    const T twice = T(2) * depth * moment;
    const T light = twice / (t + sqrt(t * t + twice) + smallest<T>());
    if constexpr (tabulated_inverses<Family>) {
      const T all(family_.visible().first_moment);
      const T odds = all / (moment * density(t)) * exp(minimum(depth, T(single ? 60 : 500))) - T(1);
      const T outer = family_.visible().moment_radius(double_double<T>(odds)) - t;
      return select((odds > T(0.4)) & (outer > T(0.1) * t), outer, light);
    } else {
      return select(t > T(0), light, maximum(light, survival_radius(depth)));
    }
  }
  T inverse_tail() const { return T(0); }

  // By Gauss' rule, away from the cusp that a density may have at 0.
  auto is_near(const T& t, const T& d, const T& sf) const { return (d < T(0.25) * sf) & (d < T(0.25) * t); }
  near_integrals<T> near_moments(const T& t, const T& d) const {
    constexpr std::array<double, 4> node{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                         0.93056815579702629},
        weight{0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
    const T reciprocal = T(1) / density(t);
    using sums = std::array<T, 2>;
    const auto [mass, moment] = accumulate(4, sums{T(0), T(0)}, [&](const term<T>& i, const sums& now) {
      const T s = T(i.of(node)) * d, part = T(i.of(weight)) * density(T(t + s)) * reciprocal;
      return sums{T(now[0] + part), T(now[1] + s * part)};
    });
    return {d * mass, d * moment};
  }

  // Whether P2, from here on, is the marginal of a density in three dimensions, as `across` takes for granted.
  auto lifts(const T& along) const {
    if constexpr (tabulated_inverses<Family>) {
      return abs(along) >= T(family_.visible().fall);
    } else if constexpr (conditional_fall<Family>) {
      return family_.falls();
    } else {
      return along == along;
    }
  }
  // Otherwise: the slope across by the quantile of its size, from shells, or |q| = scale tan(angle) from an integral.
  T across_by_integral(const T& along, const T& xi) const
    requires tabulated_inverses<Family>
  {
    return family_.visible().shells.across(T(abs(along)), xi);
  }
  T across_by_integral(const T& along_argument, const T& xi) const {
    const auto& rule = detail::rule_across;
    const T along = abs(along_argument), scale = along + sf_over_density(along);
    const auto part = [&](const T& angle) {
      const elementary::circle<T> at = elementary::cos_sin_of_turns(T(angle * T(0.25)));
      const T cosine = maximum(at.cosine, T(1e-6)), q = scale * at.sine / cosine;
      return T(family_.P22(double_double<T>(along * along + q * q)) * scale / (cosine * cosine));
    };
    const auto integral = [&](const T& angle) {
      const auto add = [&](const term<T>& i, const T& sum) {
        return T(sum + T(i.of(rule.weight)) * part(T(angle * T(i.of(rule.node)))));
      };
      return T(accumulate(static_cast<int>(rule.node.size()), T(0), add) * angle);
    };
    const T target = xi * integral(T(1));
    const T angle = iterate(10, xi, xi == xi, [&](const T& now) {
      const T next = now - (integral(now) - target) / maximum(part(now), smallest<T>());
      return iteration{maximum(minimum(next, T(T(0.5) + T(0.5) * now)), T(T(0.5) * now)), xi == xi};
    });
    const elementary::circle<T> at = elementary::cos_sin_of_turns(T(angle * T(0.25)));
    return scale * at.sine / maximum(at.cosine, T(1e-6));
  }

  // sqrt(R^2 - along^2) at P2(R) = exp(-depth) P2(along): Newton's method on log P2 in R^2.
  T across(const T& along_argument, const T& depth) const {
    const T along = abs(along_argument), sf = sf_over_density(along);
    const T twice = T(2) * depth * sf;
    T rest = twice * (along + sf) + square(T(depth * sf));
    if constexpr (tabulated_inverses<Family>) {
      const T start(family_.visible().inverse_P2);
      const T inverse = exp(minimum(depth, T(single ? 40 : 500))) / density(along) - start;
      const T R = family_.visible().marginal_radius(double_double<T>(inverse));
      rest = select((R > T(1.2) * along) & (inverse > T(0.03) * start), T((R - along) * (R + along)), rest);
    }
    // In the variable log(R^2 - along^2), between bounds.
    const T start = density(along);
    using states = std::array<T, 3>;
    const auto step = [&](const states& now) {
      const T before = now[0], R = off_zero(sqrt(along * along + before)), value = density(R);
      const T r = log(start / value) - depth;
      const T least = select(r < T(0), before, now[1]), most = select(r > T(0), before, now[2]);
      const T h = R * T(single ? 0x1p-6 : 0x1p-16), slope = log(value / density(T(R + h))) / h;
      const T change = T(2) * R * r / maximum(T(slope * before), smallest<T>());
      const T to = before * exp(maximum(minimum(T(-change), T(4)), T(-4)));
      // A long step that ends at the other bound would come back from there: light tails are flat, then steep.
      const auto within = (to > T(1.02) * least) & (to < T(0.98) * most);
      const auto inside = (to >= least) & (to <= most) & (within | (abs(change) < T(1)));
      const T moved = select(inside | (least == T(0)), to, T(sqrt(least) * sqrt(most)));
      const T after = select(elementary::is_number(moved) & (moved >= T(0)), moved, before);
      return iteration{states{after, least, most},
                       decltype(r < T(0))(abs(moved - before) > T(single ? 1e-3 : 1e-9) * before)};
    };
    const auto moving = elementary::is_number(rest) & (rest > T(0));
    rest = iterate(40, states{rest, T(0), square(largest_slope<T>())}, moving, step)[0];
    return select(depth == T(0), T(0), T(sqrt(rest)));  // where rounding would leave its root
  }

 private:
  T P2(const T& t) const {
    return called([&] { return family_.P2(slope<T>(t)); });
  }
  // The functions of a family itself are long: calls.
  template <class Function>
  MICROFACET_INLINE static T called(const Function& function) {
    if constexpr (tabulated_inverses<Family>) {
      return function();
    } else {
      return call(function);
    }
  }
  template <class Function>
  [[gnu::noinline]] static T call(const Function& function) {
    return function();
  }
  static T off_zero(const T& t) { return maximum(t, T(single ? 1e-30 : 1e-200)); }

  const Family& family_;
};

}  // namespace microfacet
