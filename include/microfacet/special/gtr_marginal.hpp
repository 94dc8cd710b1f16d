// Slope marginals of GTR (family/gtr.hpp): closed for gamma = 1, else integrals over the circles of one
// radius.
//
// A circle of radius r about the normal has L = log((max + r^2)/(min + r^2)), max and min being the larger
// and the smaller of 1 and alpha^2; it runs from 0 (r = inf) to L(x^2) for those that reach beyond the slope
// x. With A^2 = x^2 + min, a = exp(L) - 1, b = exp(L(x^2) - L) - 1:
//
//   rho^2 = r^2 - x^2 = A^2 b (1 + 1/a),  -d(r^2) = (max - min) (1 + 1/a)/a dL,  survival = expm1(g
//   L)/expm1(g beta)
//
//   mean_excess(x) = 1/(2 pi) int survival rho/r^2 d(r^2)
//   slope_sf(x)     = x/(2 pi) int survival/(rho r^2) d(r^2)
//   P2(x)           = 1/pi int 1/rho d(survival)
#pragma once

#include "microfacet/approx/midpoint.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/logarithms.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/slope.hpp"
#include "microfacet/special/gtr_wide_circles.hpp"

namespace microfacet::detail {

// gamma = 1. With A = sqrt(alpha^2 + x^2), B = sqrt(1 + x^2) and m the smaller of the two, log((x + B)/(x +
// A)) is log(1 + t) or its negative, t = |1 - alpha^2|/((A + B)(x + m)).
template <class T>
class gtr_logarithmic {
 public:
  gtr_logarithmic(const T& x, const T& alpha2, const T& span, const T& omega)
      : x_(x), a_(sqrt(alpha2 + x * x)), b_(sqrt(T(1) + x * x)), m_(minimum(a_, b_)) {
    const T sum = a_ + b_;
    lambda_ = log1p_over(T(span / (sum * (x + m_))));
    scale_ = T(1) / (omega * sum);
  }
  T density() const { return scale_ / (a_ * b_); }
  T sf() const { return scale_ * lambda_ / (x_ + m_); }
  T excess() const { return scale_ * (m_ + x_ * (T(1) - lambda_)) / (x_ + m_); }

 private:
  T x_, a_, b_, m_, lambda_, scale_;
};

template <class T>
class gtr_marginal {
 public:
  // span = max - min, ratio = (exp(L(0) - L(x^2)) - 1)/span, and scale = beta/span (1 - exp(-|g| beta))/(|g|
  // beta), the denominator of survival.
  gtr_marginal(const slope<T>& x, const T& smaller, const double_double<T>& span,
               const double_double<T>& ratio, const T& g, const T& scale)
      : x_(x.value.high),
        amplitude_(sqrt(x.squared.high + smaller)),
        g_(select(abs(g) < T(least), T(least), g)),
        rising_(g_ > T(0)),
        span_(span.high),
        scale_(scale) {
    const T a2 = x.squared.high + smaller, excess = span.high / a2;
    const T whole = maximum(T(log1p(excess)), T(least));
    whole_over_span_ = select(excess > T(least), T(whole / excess), T(1)) / a2;
    const double_double<T> lift = span * ratio, beyond = log1p_double_double(lift);  // L(0) - L(x^2)
    const double_double<T> decay = beyond * double_double<T>(maximum(g_, T(0)));
    fall_ = exp(-decay);
    const T beyond_over_span = select(lift.high > T(least), T(beyond.high / span.high), ratio.high);
    // Where survival grows by many orders of magnitude, its upper end is all that counts: also of the excess,
    // as survival over sqrt(r).
    const T growth_rate = g_ - T(0.5);
    const auto steep = growth_rate * whole > T(negligible);
    length_ = select(steep, T(T(negligible) / growth_rate), whole), part_ = length_ / whole;
    growth_of_length_ = select(steep, T(expm1(length_)), maximum(excess, T(least)));
    shrunk_ = T(1) / (T(1) + growth_of_length_), omitted_ = exp(length_ - whole);
    height_ = abs(g_) * length_;
    early_ = (abs(g_) > T(2)) & (height_ > T(late));
    const T growth = expm1(minimum(height_, T(single ? 80 : 600)));
    all_ = T(1) / (T(1) + growth), rest_of_all_ = growth * all_;
    // The pole lies past the end x of the interval by L(0) - L(x^2).
    const T t = T(2) * beyond_over_span / (whole_over_span_ * part_);
    log_rho_ = log1p(t + sqrt(t * (t + T(2))));
    pairs_ = enough_pairs(decay.high);
  }

  T excess() const {
    return select_lazy(
        early_,
        [&] { return wide().mean([&](const T& rho, const T& angle) { return T(rho - x_ * angle); }); },
        [&] { return excess_of_circles(); });
  }
  T sf() const {
    return select_lazy(
        early_, [&] { return wide().mean([](const T&, const T& angle) { return angle; }); },
        [&] { return sf_of_circles(); });
  }
  T density() const {
    return select_lazy(
        early_, [&] { return wide().mean([](const T& rho, const T&) { return T(T(1) / rho); }); },
        [&] { return density_of_circles(); });
  }

 private:
  gtr_wide_circles<T> wide() const { return {x_, amplitude_, span_, T(select(early_, T(abs(g_)), T(1)))}; }
  T excess_of_circles() const {
    const T x = x_ / amplitude_, x2 = x * x;
    const T sum =
        integral_of_survival([&](const T& nearer, const T& farther, const T& rho2, const T& rho2_far) {
          const T d = x2 + rho2, d_far = x2 + rho2_far;
          return (nearer * sqrt(rho2) * d_far + farther * sqrt(rho2_far) * d) / (d * d_far);
        });
    return maximum(T(sum / amplitude_ - x_ * pole()), T(0));
  }
  T sf_of_circles() const {
    const T x = x_ / amplitude_, x2 = x * x;
    const T sum =
        integral_of_survival([&](const T& nearer, const T& farther, const T& rho2, const T& rho2_far) {
          const T rho = sqrt(rho2), rho_far = sqrt(rho2_far), d = rho * (x2 + rho2),
                  d_far = rho_far * (x2 + rho2_far);
          return (nearer * d_far + farther * d) / (d * d_far);
        });
    return sum * x / square(amplitude_) + pole();
  }
  T density_of_circles() const {
    const T sum = integral([&](const nodes& n) {
      const T fallen = all_ * (T(1) + n.growth), rho = sqrt(n.rho2), rho_far = sqrt(n.rho2_far);
      const T nearer = select(rising_, n.inverse_growth, fallen),
              farther = select(rising_, fallen, n.inverse_growth);
      return (nearer * rho_far + farther * rho) / (rho * rho_far);
    });
    return fall_ * (sum * part_ * (whole_over_span_ / (T(pi) * amplitude_ * scale_)));
  }

  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double negligible = single ? 28 : 50;
  static constexpr double least = single ? 1e-9 : 1e-110;  // stands for zero, where only quotients count
  static constexpr double late = single ? 40 : 100;

  // At L = L(x^2) - near length and L = L(x^2) - far length, with growth = exp(|g| near length) - 1:
  // r = 1/(a omitted), (rho/A)^2.
  struct nodes {
    T growth, inverse_growth, r, r_far, rho2, rho2_far;
  };

  template <class Function>
  T integral(const Function& f) const {
    const T base = T(1) - omitted_;
    const auto pair = [&](const T& nearer, const T&) {
      const T b = expm1(length_ * nearer), b_far = growth_of_length_ - b;
      const T growth = expm1(minimum(T(height_ * nearer), T(single ? 30 : 130)));
      // Times (1 + b) omitted over exp(length), and omitted.
      const T a = (b_far + base * (T(1) + b)) * shrunk_, a_far = b + base;
      const T grown = T(1) + growth, inverse = T(1) / (a * a_far * grown),
              inverse_a = inverse * (a_far * grown);
      const T inverse_a_far = inverse * (a * grown);
      return f(nodes{growth, T(inverse * (a * a_far)), T((T(1) + b) * (shrunk_ * inverse_a)), inverse_a_far,
                     T(b * inverse_a), T(b_far * inverse_a_far)});
    };
    return integral_between_roots<T>(pair, pairs_);
  }

  // (1/2 pi) int survival (1 + 1/a)/a f dL, f being the sum for both nodes.
  template <class Function>
  T integral_of_survival(const Function& f) const {
    const T sum = integral([&](const nodes& n) {
      const T nearer = (rest_of_all_ - all_ * n.growth) * select(rising_, n.inverse_growth, T(1));
      const T farther = n.growth * select(rising_, all_, n.inverse_growth);
      return f(T(nearer * n.r * (T(1) + omitted_ * n.r)), T(farther * n.r_far * (T(1) + omitted_ * n.r_far)),
               n.rho2, n.rho2_far);
    });
    return fall_ * (omitted_ * sum * (length_ / (T(2 * pi) * abs(g_) * scale_)));
  }

  // What limits the rule are the poles at L = +-2 pi i and the growth of exp(g L).
  T enough_pairs(const T& decay) const {
    const T turns = sqrt(T(0.5) * abs(g_) * length_);
    const T pairs = single ? maximum(T(T(2) + T(0.28) * length_), T(T(2) + T(1.4) * turns))
                           : maximum(T(T(3.3) + T(0.48) * length_), T(T(3) + T(2) * turns));
    // The pole beyond the interval is the rule's error as long as survival does not grow too much up to
    // there; else it must not count.
    const T for_pole = (decay + T(single ? 22 : 41)) / (T(4) * log_rho_);
    return floor(maximum(pairs, select(decay > T(8), minimum(for_pole, T(47)), T(0)))) + T(1);
  }

  // The rule's error due to the pole of both integrands at r = 0, where survival is 1.
  T pole() const {
    const T exponent = T(4) * pairs_ * log_rho_;
    // Infinity is no number to a compiler that may assume there is none.
    if constexpr (records<T>) return T(1) / (T(1) + exp(minimum(exponent, T(single ? 80 : 600))));
    return T(1) / (T(1) + exp(exponent));
  }

  T x_, amplitude_, g_;
  decltype(T() > T()) rising_, early_;
  T span_, scale_, whole_over_span_, fall_, length_, part_, growth_of_length_, shrunk_, omitted_;
  T height_, all_, rest_of_all_, log_rho_, pairs_;
};

}  // namespace microfacet::detail
