// The slope in the plane of incidence in float32, by inversion of its distribution (smith/visible/inversion.hpp has the
// sides) without a loop: polynomials of two variables, the direction and the depth L = -log(share of the side), start
// so near that one step of Halley's method ends within rounding. The sides start at
//
//   above, x > 0:   P = v p(x, L),  v where log(probability) is a parabola that has its slope and bend at P = 0
//   from below:     P = v as the family or its tables say
//   lower:          P = -t,  x - t = x exp(-L q(x, L))
//
// and step in (x + P)^2/2: above and from below on the logarithm of the probability, whose tail is long, on the lower
// side on the probability itself, which is a difference there.
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/smith/visible/point.hpp"

namespace microfacet {

namespace detail {

template <class Family, class T>
class started_slope : visible_functions<Family, T> {
  using base = visible_functions<Family, T>;
  using base::at, base::excess, base::moment, base::score, base::over_density, base::family_;
  using typename base::point;

 public:
  explicit started_slope(const Family& family) : base(family) {}

  // `share` in (0, 1) is the probability of a slope above the result.
  MICROFACET_INLINE T operator()(const T& x, const T& share) const {
    const auto& starts = family_.start();
    const auto up = x > T(0);
    const T X = abs(x), start = select(up, T(0), X), c = select(up, x, T(0));
    // Of the area that x > 0 sees, the parts with P > 0 and with P < 0.
    const T J = J_of(X), whole = c + J;
    const T upper = multiply_add(T(0.5), c, T(starts.excess_at_0)), beyond = share * whole;
    const decltype(x > T(0)) lower = up & (beyond > upper);
    const T part = select(lower, maximum(T(whole - upper), smallest<T>()), upper),
            rest = (T(1) - share) * whole;
    const T inverse = T(1) / part, of_part = select(up, T(select(lower, rest, beyond) * inverse), share);
    const T depth = maximum(T(-log(maximum(of_part, smallest<T>()))), T(0));
    const visible_depth<T, decltype(up)> at_depth{X, depth, sqrt(depth), lower};

    // Where to start.
    const T e = T(starts.peak) * inverse, b = c * e, bend = T(2) * (b * b + e);
    const T parabola = T(2) * depth / (b + sqrt(multiply_add(bend, depth, T(b * b))) + smallest<T>());
    T v = starts.above(at_depth, parabola), over_start = part * T(starts.inverse_peak);
    if (any_lane(!up)) {
      const T ratio = excess(at(start));
      v = select(up, v, starts.below(at_depth, ratio)), over_start = select(up, over_start, ratio);
    }
    v = minimum(maximum(v, T(0)), largest_slope<T>());

    const T least = maximum(T(X * T(0x1p-30)), T(smallest<T>() * T(4096)));
    for (int i = 0; i < starts.steps; ++i) {
      // On the lower side v is -P, and x + P what is left of x.
      const T t = start + v, d = maximum(select(lower, T(x - v), T(c + v)), least), d2 = d * d;
      const point p = at(t);
      // The probability of the side over P2(t), and what it is too much on the lower side.
      const T over = over_density(p), difference = multiply_add(c, p.sf, -moment(p));
      T N = select(lower, T(multiply_add(J, over, difference)), T(multiply_add(c, p.sf, moment(p))));
      if (any_lane(!up)) N = select(up, N, multiply_add(v, p.sf, excess(p)));
      T r;
      if constexpr (base::tabled) {
        r = log(maximum(T(N * p.density), smallest<T>()) /
                maximum(select(lower, rest, beyond), smallest<T>()));
      } else {
        const T exponent = select(lower, T(0), T(depth - family_.log_density_ratio(start, v)));
        r = exponent + log(maximum(T(N / select(lower, T(rest * over), over_start)), smallest<T>()));
      }
      const auto nearby = lower & (d < v);
      const T newton = select(nearby, T(difference + (J - rest) * over), T(r * N));
      const T half = select(nearby, T(1), multiply_add(T(0.5), r, T(1))),
              bent = T(0.5) * score(p) * newton / d;
      const T halley = newton / minimum(maximum(T(half + bent), T(0.5)), T(2));
      const T change = maximum(minimum(select(lower, T(-halley), halley), select(lower, d2, largest<T>())),
                               T(T(-0.48) * d2));
      const T moved = T(2) * change / (sqrt(multiply_add(T(2), change, d2)) + d);
      v = maximum(T(v + select(lower, T(-moved), moved)), T(0));
    }
    const T along = select(lower, T(-minimum(v, x)), T(start + minimum(v, largest_slope<T>())));
    if constexpr (base::tabled) {
      return nan_unless(up | (J > T(1e-30)), along);  // as far as tables in float32 reach
    } else {
      return along;
    }
  }

 private:
  MICROFACET_INLINE T J_of(const T& X) const {
    if constexpr (base::tabled) {
      return family_.mean_excess(X);
    } else {
      return family_.mean_excess(slope<T>(X));
    }
  }
};

}  // namespace detail

}  // namespace microfacet
