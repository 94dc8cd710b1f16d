// Slope marginals of GTR (family/gtr.hpp): closed for gamma = 1, else integrals over the circles of one radius.
//
// A circle of radius r about the normal has L = log((max + r^2)/(min + r^2)), max and min being the larger and the
// smaller of 1 and alpha^2; it runs from 0 (r = inf) to L(x^2) for those that reach beyond the slope x. With
// A^2 = x^2 + min, a = exp(L) - 1, b = exp(L(x^2) - L) - 1:
//
//   rho^2 = r^2 - x^2 = A^2 b (1 + 1/a),  -d(r^2) = (max - min) (1 + 1/a)/a dL,  survival = expm1(g L)/expm1(g beta)
//
//   slope_excess(x) = 1/(2 pi) int survival rho/r^2 d(r^2)
//   slope_sf(x)     = x/(2 pi) int survival/(rho r^2) d(r^2)
//   P2(x)           = 1/pi int 1/rho d(survival)
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/quadrature.hpp"
#include "microfacet/core/twofold.hpp"

namespace microfacet::detail {

// gamma = 1. With A = sqrt(alpha^2 + x^2), B = sqrt(1 + x^2) and m the smaller of the two, log((x + B)/(x + A)) is
// log(1 + t) or its negative, t = |1 - alpha^2|/((A + B)(x + m)).
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
  // scale = beta/(max - min) times (1 - exp(-|g| beta))/(|g| beta), the denominator of survival.
  gtr_marginal(const T& x, const T& span, const T& smaller, const T& larger, const T& g, const T& scale)
      : x_(x), x2_(x * x), a2_(x2_ + smaller), g_(select(abs(g) < T(least), T(least), g)), scale_(scale) {
    const T excess = span / a2_;
    whole_ = maximum(T(log1p(excess)), T(least));
    whole_over_span_ = log1p_over(excess) / a2_;
    const T ratio = (x2_ / smaller) / (larger + x2_), lift = span * ratio;
    beyond_over_span_ = log1p_over(lift) * ratio;
    const twofold<T> beyond = log1p_twofold(twofold<T>(lift)), decay = beyond * twofold<T>(maximum(g_, T(0)));
    fall_ = exp(-decay);
    rising_ = g_ > T(0);
    // Where survival grows by many orders of magnitude, its upper end is all that counts.
    concentrated_ = g_ * whole_ > T(negligible);
    length_ = select(concentrated_, T(T(negligible) / g_), whole_);
    const T rest = whole_ - length_;
    rest_factor_ = exp(rest), rest_excess_ = expm1(rest);
    pairs_ = enough_pairs(beyond.high, decay.high);
  }

  T excess() const {
    const auto node = [this](const T& survival, const T& r, const T& rho) {
      return survival * (r * (T(1) + r)) * rho / (x2_ + rho * rho);
    };
    return integral_of_survival(node) - x_ * pole();
  }
  T sf() const {
    const auto node = [this](const T& survival, const T& r, const T& rho) {
      return survival * (r * (T(1) + r)) / (rho * (x2_ + rho * rho));
    };
    return x_ * integral_of_survival(node) + pole();
  }
  T density() const {
    const T top = select(rising_, T(-g_ * length_), T(0)), bottom = select(rising_, T(0), T(g_ * length_));
    const T sum = integral([&](const T& near, const T& far, const T&, const T& rho) {
      return exp(multiply_add(top, near, T(bottom * far))) / rho;
    });
    return fall_ * sum * (length_ / whole_) * whole_over_span_ / (T(pi) * scale_);
  }

 private:
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  static constexpr double negligible = single ? 20 : 50;
  static constexpr double least = single ? 1e-9 : 1e-20;  // stands for zero, where only quotients count

  // int_0^1 of f(near, 1 - near, 1/a, rho) over near = (L(x^2) - L)/length.
  template <class Function>
  T integral(const Function& f) const {
    const T amplitude = sqrt(a2_);
    const auto pair = [&](const T& near, const T& far) {
      const T e_near = expm1(length_ * near), e_far = expm1(length_ * far);
      const auto node = [&](const T& n, const T& m, const T& above, const T& below) {
        const T r = T(1) / multiply_add(below, rest_factor_, rest_excess_);
        return f(n, m, r, T(amplitude * sqrt(above * (T(1) + r))));
      };
      return node(near, far, e_near, e_far) + node(far, near, e_far, e_near);
    };
    return integral_between_roots<T>(pair, pairs_);
  }

  template <class Function>
  T integral_of_survival(const Function& f) const {
    const T height = g_ * length_, top = select(concentrated_, T(-height), T(0));
    const T bottom = select(concentrated_, T(0), height), one = select(concentrated_, T(1), T(0));
    const T sum = integral([&](const T& near, const T& far, const T& r, const T& rho) {
      return f(T(expm1(multiply_add(top, near, T(bottom * far))) + one), r, rho);
    });
    const T fall = fall_ * exp(select(rising_ & !concentrated_, T(-height), T(0)));
    return fall * length_ * sum / (T(2 * pi) * g_ * scale_);
  }

  // What limits the rule are the growth of exp(g L) and the poles at L = +-2 pi i and, if survival is small in the
  // interval, at L(0) +- 2 pi i.
  T enough_pairs(const T& beyond, const T& decay) const {
    const T turns = sqrt(T(0.5) * abs(g_) * length_);
    const T pairs = single ? maximum(T(T(1.5) + T(0.25) * length_), T(T(1.5) + T(1.2) * turns))
                           : maximum(T(T(3.3) + T(0.48) * length_), T(T(3) + T(2) * turns));
    const auto small = decay > T(8);
    const T far = choose(
        small,
        [&] {
          const T real = T(1) + T(2) * beyond / length_, imaginary = T(4 * pi) / length_;
          return (decay + T(single ? 18 : 37)) /
                 (T(4) * log(T(2) * sqrt(real * real + imaginary * imaginary) - T(1)));
        },
        [&] { return T(0); });
    return floor(maximum(pairs, select(small, far, T(0)))) + T(1);
  }

  // The rule's error due to the pole of both integrands at r = 0, where survival is 1: past the end x of the interval by
  // L(0) - L(x^2).
  T pole() const {
    const T t = T(2) * beyond_over_span_ / whole_over_span_ * (whole_ / length_), log_rho = log1p(t + sqrt(t * (t + T(2))));
    return T(1) / (T(1) + exp(minimum(T(T(4) * pairs_ * log_rho), T(single ? 80 : 700))));
  }

  T x_, x2_, a2_, g_, scale_, whole_, whole_over_span_, beyond_over_span_, fall_, length_, rest_factor_, rest_excess_, pairs_;
  decltype(T() > T()) rising_, concentrated_;
};

}  // namespace microfacet::detail
