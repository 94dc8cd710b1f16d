// Dirac: all facets have the slope 1, at any azimuth: a ring.
//
//   P22(r2)        = delta(r - 1)/(2 pi r), infinite on the ring and 0 elsewhere
//   survival(r2)   = 1 for r2 < 1, else 0
//   P2(t)          = 1/(pi sqrt(1 - t^2)) for |t| < 1, else 0
//   slope_sf(t)    = acos(t)/pi
//   mean_excess(t) = (sqrt(1 - t^2) - t acos(t))/pi
//
// No number is the density, so what needs it beside the ring is 0; what integrates it (P2, sigma, sampling) is
// exact. d'Eon's notebook "Dirac NDF", whose printed projected area lacks the factor 1/(2 pi u_d).
#pragma once

#include <array>
#include <string_view>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/arc.hpp"

namespace microfacet {

template <class T>
class dirac : public radial_defaults<T, part::direct_radius | part::slope_sampling> {
 public:
  static constexpr std::string_view name = "dirac";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool singular = true;
  static constexpr int visible_dimensions = 2, mixture_dimensions = 2;  // the second chooses a side

  T P22(const double_double<T>& r2) const {
    return select(r2.high == T(1), infinite<T>(), T(T(0) * bounded(r2.high)));
  }
  T D(const T& z, const double_double<T>& h2) const {
    const T z2 = bounded(T(z * z)), height2 = bounded(h2.high);
    return select((height2 == z2) & (z2 > T(0)), infinite<T>(), T(T(0) * z2 + T(0) * height2));
  }
  T survival(const double_double<T>& r2) const {
    return select(r2.high < T(1), T(1), T(T(0) * bounded(r2.high)));
  }
  T radius2(const T& xi) const { return radius(xi); }
  T radius(const T& xi) const { return T(1) + T(0) * xi; }
  T P2(const slope<T>& t) const {
    const T size = bounded(T(abs(t.value.high))), q = across(size);
    return select(size == T(1), infinite<T>(), select(size < T(1), T(T(1 / pi) / q), T(T(0) * size)));
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [](const slope<T>& x) { return T(T(1 / pi) * beyond(x.value.high).angle); });
  }
  T mean_excess(const slope<T>& x) const { return T(1 / pi) * beyond(x.value.high).excess; }

  // The slope 1 at the azimuth f from that of the direction x = cot(theta), with a density proportional to
  // max(0, x + cos f): up to `last`, acos(-x) or pi. The angle d = last - f has the cumulative
  //
  //   max(x - 1, 0) d + sin(last) (1 - cos d) - cos(last) (d - sin d),
  //
  // which is convex, so that Newton's method comes down to the solution once it is above.
  visible_slopes<T> visible_slopes_of(const T& x_argument, const T& xi0, const T& xi1, const T&) const {
    // From x = -1 down nothing is seen.
    const T x = nan_unless(x_argument > T(-1), x_argument), turn = minimum(x, T(1)), size = abs(turn),
            q = across(size);
    const arc<T> acute(size, q, T(1));
    const auto below = x < T(0);
    const T last = select(below, acute.angle, T(T(pi) - acute.angle));
    const T all = select(below, acute.excess, multiply_add(x, last, q)), target = (T(1) - xi0) * all;
    const T above = maximum(T(x - T(1)), T(0)), least = smallest<T>();
    // From above where each term alone must reach the target, else by the first term.
    const T by_square = sqrt(capped_quotient(T(target * T(0.5 * pi * pi)), q));
    const T by_cube = exp(log(maximum(capped_quotient(T(target * T(pi * pi)), turn), least)) * T(1.0 / 3));
    const T by_height = capped_quotient(target, above);
    const T start = select(below, T(last * sqrt(T(2.0 / 3) * (T(1) - xi0))),
                           minimum(minimum(by_square, by_cube), minimum(by_height, last)));
    const T d = iterate(20, start, start > T(0), [&](const T& now) {
      const elementary::circle<T> half = elementary::cos_sin_of_turns(T(now * T(0.25 / pi)));
      const T less_cosine = T(2) * square(half.sine), sine = T(2) * half.sine * half.cosine;
      const T sum = above * now + q * less_cosine + turn * less_sine(now, sine);
      const T slope = above + q * sine + turn * less_cosine;
      const T next = minimum(maximum(T(now + (target - sum) / maximum(slope, least)), T(T(0.1) * now)), last);
      return iteration{next, abs(next - now) > T(single ? 1e-5 : 1e-10) * now};
    });
    const elementary::circle<T> f = elementary::cos_sin_of_turns(T((last - d) * T(0.5 / pi)));
    return {f.cosine, select(xi1 < T(0.5), f.sine, T(-f.sine)) + T(0) * xi1};
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  // a/b, or 1000, from where it no longer matters how large it is.
  static T capped_quotient(const T& a, const T& b) {
    return a / maximum(maximum(b, T(T(1e-3) * a)), smallest<T>());
  }
  static T bounded(const T& x) { return minimum(x, largest<T>()); }
  static T across(const T& t) { return sqrt(maximum(T((T(1) - t) * (T(1) + t)), T(0))); }
  // x - sin x, by its series where that cancels.
  static T less_sine(const T& x, const T& sine) {
    const T x2 = x * x;
    T series(1);
    for (int n = 17; n >= 5; n -= 2) series = T(1) - series * x2 * T(1.0 / (n * (n - 1)));
    return select(x < T(1), T(x * x2 * series * T(1.0 / 6)), T(x - sine));
  }
  // Beyond 1 there is nothing.
  static arc<T> beyond(const T& t_argument) {
    const T t = minimum(t_argument, T(1));
    return {t, across(t), T(1)};
  }
};

static_assert(radial_family<dirac<float>> && radial_family<dirac<double>>);

}  // namespace microfacet
