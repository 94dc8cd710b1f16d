// The slope across the plane of incidence, given that in it, of any radial density: one whose P2 does not fall, as
// that of a ring, is no marginal of a density in three dimensions (smith/visible/sample_visible.hpp).
//
// The density is cut into shells in which it is a parabola of the squared slope y = P^2 + Q^2. A line at distance P
// crosses each from Q = sqrt(max(y_k - P^2, 0)) to the next, where Gauss' rule of three points is exact: sums of
// positive terms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

template <class T>
class radial_shells {
 public:
  static constexpr std::size_t count = 64;

  // From functions of numbers: the density of the squared slope, and the slope that a normal exceeds with a
  // probability.
  template <class Density, class Radius>
  void build(const Density& at, const Radius& beyond);

  // Q >= 0, exceeded with the probability 1 - xi; nothing where the line passes all shells.
  template <class R>
  R across(const R& along, const R& xi) const {
    const R square_along = along * along;
    const auto end_of = [&](const R& y) { return R(sqrt(maximum(R(y - square_along), R(0)))); };
    const auto parabola_of = [&](const term<R>& k) {
      return std::array<R, 4>{R(R(k.of(start_)) - square_along), R(k.of(value_)), R(k.of(slope_)),
                              R(k.of(bend_))};
    };
    const R first = end_of(R(start_[0]));
    using pair = std::array<R, 2>;
    const pair all =
        accumulate(static_cast<int>(count), pair{R(0), first}, [&](const term<R>& k, const pair& now) {
          const R to = end_of(R(k.of(end_)));
          return pair{R(now[0] + integral(parabola_of(k), now[1], to)), to};
        });
    const R target = xi * all[0];
    // The sum before the shell that the target lies in, where that starts and ends, and its parabola.
    using found = std::array<R, 9>;
    const found start{R(0), first, R(0), first, first, R(0), R(0), R(0), R(0)};
    const found at = accumulate(static_cast<int>(count), start, [&](const term<R>& k, const found& now) {
      const R to = end_of(R(k.of(end_)));
      const std::array<R, 4> p = parabola_of(k);
      const R sum = now[0] + integral(p, now[1], to);
      const auto here = now[0] <= target;
      const auto kept = [&](const R& a, std::size_t i) { return R(select(here, a, now[i])); };
      return found{sum,
                   to,
                   kept(now[0], 2),
                   kept(now[1], 3),
                   kept(to, 4),
                   kept(p[0], 5),
                   kept(p[1], 6),
                   kept(p[2], 7),
                   kept(p[3], 8)};
    });
    const R rest = target - at[2], from = at[3], to = at[4];
    const std::array<R, 4> p{at[5], at[6], at[7], at[8]};
    const R part = minimum(R(rest / maximum(integral(p, from, to), smallest<R>())), R(1));
    return accumulate(5, R(from + part * (to - from)), [&](const term<R>&, const R& q) {
      const R less = integral(p, from, q) - rest;
      return minimum(maximum(R(q - less / maximum(density(p, q), smallest<R>())), from), to);
    });
  }

 private:
  // At Q = q, of a shell that starts at y = P^2 + p[0].
  template <class R>
  static R density(const std::array<R, 4>& p, const R& q) {
    const R s = multiply_add(q, q, R(-p[0]));
    return multiply_add(multiply_add(p[3], s, p[2]), s, p[1]);
  }
  template <class R>
  static R integral(const std::array<R, 4>& p, const R& from, const R& to) {
    const R half = R(0.5) * (to - from), middle = from + half, off = half * R(0.77459666924148338);
    return half * (R(5.0 / 9) * (density(p, R(middle - off)) + density(p, R(middle + off))) +
                   R(8.0 / 9) * density(p, middle));
  }

  std::array<T, count> start_{}, end_{}, value_{}, slope_{}, bend_{};  // parabolas of y - start
};

namespace detail {

// A shell while they are being placed: f = value + (y - from) (slope + (y - from) bend).
struct shell {
  double from, to, value = 0, slope = 0, bend = 0, error = 0;

  template <class Density>
  static shell between(double from, double to, const Density& at) {
    shell s{from, to};
    // A density may be infinite at 0.
    const double width = to - from, inner = from > 0 ? 0 : 1e-3, x0 = inner, x1 = 0.5;
    const double f0 = at(from + x0 * width), f1 = at(from + x1 * width), f2 = at(to);
    const double d1 = (f1 - f0) / (x1 - x0), d2 = (f2 - f1) / (1 - x1), second = (d2 - d1) / (1 - x0);
    s.bend = second / (width * width);
    s.slope = (d1 - second * (x0 + x1)) / width;
    s.value = f0 - x0 * (d1 - second * x1);
    for (const double x : {0.1, 0.25, 0.75, 0.9}) {
      const double y = x * width;
      s.error = (std::max)(s.error, std::abs(s.value + y * (s.slope + y * s.bend) - at(from + y)) * width);
    }
    return s;
  }
};

}  // namespace detail

template <class T>
template <class Density, class Radius>
void radial_shells<T>::build(const Density& at, const Radius& beyond) {
  std::array<detail::shell, count> shells;
  std::size_t n = 0;
  double from = elementary::is_number(at(0.0)) ? 0 : square(beyond(1 - 1e-12));
  for (const double above : {0.9, 0.6, 0.3, 0.1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    const double to = square(beyond(above));
    if (!(to > from * (1 + 1e-12))) continue;
    shells[n++] = detail::shell::between(from, to, at);
    from = to;
  }
  if (n == 0) return value_.fill(nan<T>());  // the density could not be met
  while (n < count) {
    auto& worst = *std::max_element(shells.begin(), shells.begin() + static_cast<std::ptrdiff_t>(n),
                                    [](const auto& a, const auto& b) { return a.error < b.error; });
    const detail::shell whole = worst;
    const double middle = whole.to > 4 * whole.from && whole.from > 0 ? std::sqrt(whole.from * whole.to)
                                                                      : 0.5 * (whole.from + whole.to);
    worst = detail::shell::between(whole.from, middle, at);
    shells[n++] = detail::shell::between(middle, whole.to, at);
  }
  std::sort(shells.begin(), shells.end(), [](const auto& a, const auto& b) { return a.from < b.from; });
  for (std::size_t k = 0; k < count; ++k) {
    const detail::shell& s = shells[k];
    start_[k] = static_cast<T>(s.from), end_[k] = static_cast<T>(s.to), value_[k] = static_cast<T>(s.value);
    slope_[k] = static_cast<T>(s.slope), bend_[k] = static_cast<T>(s.bend);
  }
}

}  // namespace microfacet
