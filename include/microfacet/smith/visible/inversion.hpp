// The slope in the plane of incidence of the facets that a direction sees, by inversion of its distribution.
//
// In standard space the direction has x = cot(theta) of any sign. Of slopes P, positive ones leaning towards
// it, it sees the density (x + P)_+ P2(P)/(max(x, 0) + J(|x|)), J = mean_excess. With c = max(x, 0) and
// p0 = max(-x, 0), the slope from which on it leans towards the direction, there are two sides:
//
//   upper, P = p0 + v:       Pr(slope > P) ~ (x + P) slope_sf(P) + J(P)
//   lower, P = -v, 0<v<x:    Pr(slope < P) ~ (x - v) slope_sf(v) - J(v) + J(x)
//
// Each over P2(t), t = |P|, is a function that neither over- nor underflows, and log(probability/target) is
// solved by Halley's method: above in the variable (x + P)^2/2, below in log(x + P), which are straight where
// the probability has its double zeros. The other side of the quotient is an exponent. What a family states
// (`tails`): slope_sf/P2, J/P2, int_t^inf y P2(y) dy/P2, (log P2)', log_density_ratio = log P2(t) - log P2(t + v).
#pragma once

#include <array>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/choices.hpp"
#include "microfacet/core/logarithms.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/smith/visible/point.hpp"

namespace microfacet {

namespace detail {

template <class Family, class T>
class visible_slope_solver : visible_functions<Family, T> {
  using base = visible_functions<Family, T>;
  using base::at, base::excess, base::moment, base::score, base::log_density_ratio, base::family_;
  using typename base::point;
  using Mask = decltype(T(0) < T(0));
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

 public:
  // below: where x <= 0, which who knows it may say.
  visible_slope_solver(const Family& family, const T& x, const T& share, const Mask& below)
      : base(family),
        x_(x),
        nothing_(T(0) * (x + share)),
        below_(below),
        start_(select(below_, T(-x), T(0))),
        c_(select(below_, T(0), x)),
        at_start_(at(start_)),
        at_x_(at(abs(x))) {
    const T above = upper(at_start_, T(0));
    T under(0);
    if (any_lane(!below_)) {
      const auto nearby = family_.is_near(start_, c_, at_start_.sf);
      const near_integrals<T> s = moments_where(nearby, start_, c_);
      under = select(below_, T(0), lower(nearby, s, at_start_, c_));
    }
    const T whole = above + under, rest = T(1) - share;
    on_lower_ = select(share > T(0.5), under - rest * whole, share * whole - above) > T(0);
    part_ = select(on_lower_, under, above);
    const T of_part = select(on_lower_, rest, share) * rounded(T(whole / part_));
    depth_ = maximum(T(-log(maximum(of_part, smallest<T>()))), T(0));
    // On the upper side, what lies between its start and the result.
    between_ = maximum(T(rest * whole - under), T(0));
  }

  T operator()() const {
    const T start = first();
    const auto moving = elementary::is_number(start) & (start >= T(0));
    // Where log(probability) bends, bounds help; beyond the range of the family's functions there is no residual.
    const auto bracketed = [this](const std::array<T, 3>& state) {
      const auto [v, above, under] = state;
      const auto [to, residual] = next(v);
      const auto too_far = (residual < T(0)) | !elementary::is_number(residual);
      const T least = select(residual > T(0), v, above), most = select(too_far, v, under);
      const T other = select(least > T(0), least, minimum(most, T(1)) * T(0.0625));
      const T middle = select(most > T(4) * other, T(sqrt(other) * sqrt(most)), T(T(0.5) * (other + most)));
      const auto inside = elementary::is_number(to) & (((to >= least) & (to <= most)) | (least == T(0)));
      const T moved = select(inside, to, middle), size = select(on_lower_, minimum(v, T(c_ - v)), v);
      return iteration{std::array<T, 3>{moved, least, most},
                       Mask(abs(moved - v) > T(single ? 3e-3 : 1e-8) * size)};
    };
    const std::array<T, 3> from{select(moving, start, T(0)), T(0), select(on_lower_, c_, largest_slope<T>())};
    const T v = iterate(40, from, moving, bracketed)[0];
    return select(on_lower_, T(-v), T(start_ + v)) + nothing_;
  }

 private:
  // `usual` but in the lanes of a mask that seldom has any.
  template <class Rare>
  static T unless(const Mask& mask, const T& usual, const Rare& rare) {
    return select_seldom(mask, rare, usual);
  }
  near_integrals<T> moments_where(const Mask& mask, const T& t, const T& d) const {
    return select_seldom(mask, [&] { return family_.near_moments(t, d); }, near_integrals<T>{T(0), T(0)});
  }

  // Over P2(t), the probability of what lies above t = start + v, and of what lies below -t = d - x.
  T upper(const point& p, const T& v) const {
    return unless(below_, T(multiply_add(x_, p.sf, moment(p))),
                  [&] { return multiply_add(v, p.sf, excess(p)); });
  }
  T lower(const Mask& nearby, const near_integrals<T>& s, const point& p, const T& d) const {
    const T general = (d * p.sf - excess(p)) + excess(at_x_) * exp(-log_density_ratio(p, at_x_, d));
    return select(nearby, T(d * s.mass - s.moment), general);
  }

  // Exact for x = 0, for small depths and in the tail.
  T first() const {
    const T b = c_ / part_, root = sqrt(depth_);
    if constexpr (!base::tabled && started_inversion<Family>) {
      const T bend = T(2) * (b * b + T(1) / part_);
      const T parabola = T(2) * depth_ / (b + sqrt(b * b + bend * depth_) + smallest<T>());
      const visible_depth<T, Mask> at_depth{abs(x_), depth_, root, on_lower_};
      return unless(below_, family_.start().above(at_depth, parabola),
                    [&] { return family_.start().below(at_depth, excess(at_start_)); });
    } else {
      return first_in_closed_form(b, root);
    }
  }
  T first_in_closed_form(const T& b, const T& root) const {
    const T s0 = T(2) * depth_ / (b + sqrt(b * b + T(4) * depth_) + smallest<T>());
    const T t1 = family_.survival_radius(maximum(T(depth_ - log1p(b * s0)), T(0)));
    const T J = excess(at_x_), width = abs(x_) * sqrt(T(2) * J) / (J + abs(x_) * at_start_.sf);
    const T grown = select(below_, T(width * root * (T(1) + width * root * T(1.0 / 3))), T(0));
    const T ratio = select(below_, T(1), T(moment(at_start_) / part_));
    const T change = grown / (T(1) + family_.inverse_tail() * grown) * ratio + (ratio - T(1));
    const T t2 = family_.moment_radius(start_, maximum(T(depth_ + log1p(change)), T(0)));
    const T above = select(below_, t2, maximum(t1, t2));
    const auto under = [&] {
      const T by_angle = -x_ * expm1(T(-0.5) * depth_);
      const T less = minimum(t1, by_angle), more = maximum(maximum(t1, by_angle), smallest<T>());
      const T blend = less / (T(1) + T(0.19) * square(square(T(less / more))));
      // At its end the probability is P2(x) (x - v)^2/2.
      const T square_end = T(2) * part_ * exp(log_density_ratio(at_start_, at_x_, abs(x_)) - depth_);
      const T end = x_ - sqrt(minimum(square_end, largest<T>()));  // a fast root of infinity may be nan
      return select(end > T(0.5) * x_, end, blend);
    };
    return unless(on_lower_, above, under);
  }

  // Where to go from v, and log(probability/target) there, which falls with v.
  struct step {
    T to, residual;
  };
  step next(const T& v) const {
    const T t = start_ + v;
    const point p = at(t);
    const T least = maximum(T(abs(x_) * T(single ? 0x1p-30 : 0x1p-60)), T(smallest<T>() * T(4096)));
    const T d = maximum(select(on_lower_, T(c_ - v), T(c_ + v)), least);
    // Close to its end each side is an integral over little, else the difference of two.
    const T origin = select(on_lower_, t, start_), distance = select(on_lower_, d, v);
    const auto nearby = family_.is_near(origin, distance, select(on_lower_, p.sf, at_start_.sf));
    const near_integrals<T> s = moments_where(nearby, origin, distance);
    const T N = unless(on_lower_, upper(p, v), [&] { return lower(nearby, s, p, d); });
    const T change = (between_ - (c_ * s.mass + s.moment)) / (part_ - between_);
    const auto from_start = nearby & !on_lower_;
    const T r = select(from_start, T(0), T(depth_ - log_density_ratio(at_start_, p, v))) +
                log_of_sum(T(select(from_start, T(1), T(N / part_))), T(select(from_start, change, T(0))));

    const T per_d = N / d, twice = select(on_lower_, T(T(2) * per_d / d), T(0));
    const T newton =
        r * N / minimum(maximum(T(T(1) + T(0.5) * r * (T(1) + score(p) * per_d - twice)), T(0.5)), T(2));
    const T square_change = maximum(newton, T(T(-0.48) * d * d));
    const T by_square = T(2) * square_change / (sqrt(d * d + T(2) * square_change) + d);
    const auto by_ratio = [&] { return T(d * relative_step(T(newton / (d * d)))); };
    const T moved = v + unless(on_lower_, by_square, by_ratio);
    return {minimum(maximum(moved, T(T(0x1p-10) * v)), largest_slope<T>()), r};
  }
  // 1 - exp(-z), |z| held below 2, to a few percent.
  static T relative_step(const T& z_argument) {
    const T z = minimum(maximum(z_argument, T(-2)), T(2));
    return z / (T(1) + z * (T(0.5) + z * T(1.0 / 12)));
  }

  T x_, nothing_;
  Mask below_;
  T start_, c_;
  point at_start_, at_x_;
  Mask on_lower_;
  T part_, depth_, between_;
};

}  // namespace detail

// `share` in (0, 1) is the probability of a slope above the result.
template <class Family, class T, class Mask>
T visible_slope(const Family& family, const T& x, const T& share, const Mask& below) {
  return detail::visible_slope_solver<Family, T>(family, x, share, below)();
}
template <class Family, class T>
T visible_slope(const Family& family, const T& x, const T& share) {
  return visible_slope(family, x, share, x <= T(0));
}

}  // namespace microfacet
