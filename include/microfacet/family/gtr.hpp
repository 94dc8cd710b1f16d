// GTR (generalised Trowbridge-Reitz): exponent gamma, through GGX at gamma = 2.
//
// GTR is a stretch of one density only for gamma = 2: alpha is a parameter of the density, and standard space
// is slope space itself. With beta = |ln alpha^2|, g = (gamma - 1) sign(1 - alpha), phi(x) = (e^x - 1)/x,
// lambda(x) = log(1 + x)/x, Omega = 2 ln(alpha)/(alpha^2 - 1) (1 at alpha = 1), and
// L(r2) = |log((1 + r2)/(alpha^2 + r2))|, which falls from beta at r2 = 0 to 0, V = beta - L:
//
//   P22(r2)      = C (1 + r2)^(gamma-2) (r2 + alpha^2)^(-gamma)
//   survival(r2) = exp(-g V) L phi(-g L)/(beta phi(-g beta))
//
// The limits gamma = 1 and alpha = 1 are ordinary points of these forms. The slope marginals are integrals of
// positive terms over L, closed for gamma = 1. Burley 2012; d'Eon's notebook "GTR NDF".
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/choices.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/logarithms.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/gtr_marginal.hpp"

namespace microfacet {

template <class T>
class gtr : public radial_defaults<T, part::direct_radius | part::conditional_fall, of_all & ~of_P22> {
 public:
  static constexpr std::string_view name = "gtr";
  static constexpr std::array<parameter, 1> parameters{{{"gamma", 0.0, 1e100, 0.0}}};
  static constexpr std::array<std::string_view, 2> sources{"burley2012disney", "deon2020hitchhiker"};
  static constexpr bool shape_invariant = false;

  MICROFACET_INLINE gtr(const T& alpha, const T& gamma)
      : alpha_(inside(roughness, alpha)), gamma_(inside(parameters[0], gamma)) {
    a2_ = alpha_ * alpha_;
    const auto narrow = alpha_ <= T(1);
    const T difference = (T(1) - alpha_) * (T(1) + alpha_);  // 1 - alpha^2
    const auto one = difference == T(0);
    span_ = abs(difference);
    const T log_alpha = T(-2) * log(alpha_), beta = abs(log_alpha);
    omega_ = select(one, T(1), T(log_alpha / select(one, T(1), difference)));
    smaller_ = minimum(a2_, T(1));
    larger_ = maximum(a2_, T(1));
    g_ = select(narrow, T(gamma_ - T(1)), T(T(1) - gamma_));
    up_ = expm1_over(T(g_ * beta));
    down_ = expm1_over(T(-g_ * beta));
    beta_ = beta;
    // 1/(pi min Omega phi(x)), x = -(gamma - 1) beta, by one division
    const T x = (T(1) - gamma_) * beta;
    const auto zero = x == T(0);
    norm_ = select(one, T(1), span_) * select(zero, T(1), x) /
            (T(pi) * smaller_ * select(one, T(1), beta) * select(zero, T(T(1) + T(0.5) * x), expm1(x)));
  }

  T zero_or_nan() const { return T(0) * norm_; }
  T P22(const double_double<T>& r2) const { return D(T(1), r2); }

  // P22 = norm exp(-gamma X)/(1 + r2)^2, X being V for alpha < 1, else L: as B^-2 exp((2 - gamma) X) with
  // B = exp(X) (1 + r2)/min.
  MICROFACET_INLINE T D(const T& z, const double_double<T>& h2_argument) const {
    const double_double<T> h2 = bounded(h2_argument), z2 = two_prod(z, z);
    const auto narrow = alpha_ < T(1);
    const log_of_quotient<T> X =
        log1p_of_quotient(exact_span() * select(narrow, h2, z2), smaller() * (z2 + h2));
    const T inverse_B = smaller_ * X.reciprocal;
    return times_exp_minus(T(norm_ * inverse_B), two_sum(gamma_, T(-2)) * X.log) * inverse_B;
  }

  T survival(const double_double<T>& r2) const {
    // exp(L) - 1 = |1 - alpha^2|/(r2 + min), exp(V) - 1 = |1 - alpha^2| r2/(min (r2 + max)).
    const T sum = r2.high + smaller_, l_over_span = log1p_over(T(span_ / sum)) / sum;
    const double_double<T> v = log1p_double_double(exact_span() * ratio(r2));
    // phi(-x) = exp(-x) phi(x): the two forms are equal, and each overflows where the other does not.
    const T gl = g_ * span_ * l_over_span;
    const T ratio =
        select(g_ > T(0), T(exp(-(g_ * v)) * expm1_over(T(-gl)) / down_), T(expm1_over(gl) / up_));
    return minimum(T(l_over_span / omega_ * ratio), T(1));
  }

  T radius2(const T& xi) const { return square(radius(xi)); }
  // V and L at survival 1 - xi, each over beta; r2 = max(alpha^2, 1) (1 - exp(-V))/(exp(L) - 1), which
  // underflows before its root.
  T radius(const T& xi) const {
    const T rest = T(1) - xi;
    const T v = log_mean_exp(xi, rest, T(-g_ * beta_), down_), l = log_mean_exp(rest, xi, T(g_ * beta_), up_);
    const T rise = sqrt(v * expm1_over(T(-beta_ * v))), fall = sqrt(l * expm1_over(T(beta_ * l)));
    return select(xi == T(0), zero_or_nan(), T(maximum(alpha_, T(1)) * rise / fall));
  }

  // Whether P22, and with it P2, falls everywhere: the logarithmic derivative of P22 at r2 = 0 is the
  // largest.
  auto falls() const { return (gamma_ - T(2)) * a2_ <= gamma_; }
  T P2(const slope<T>& t_argument) const {
    const slope<T> t = microfacet::bounded(slope<T>(abs(t_argument.value), t_argument.squared));
    return select_special(
        gamma_ == T(1), [&] { return closed_marginal(t).density(); }, [&] { return marginal(t).density(); });
  }
  T slope_sf(const slope<T>& t) const {
    return symmetric_sf(t, [this](const slope<T>& above) {
      const slope<T> x = microfacet::bounded(above);
      return select_special(
          gamma_ == T(1), [&] { return closed_marginal(x).sf(); }, [&] { return marginal(x).sf(); });
    });
  }
  T mean_excess(const slope<T>& x) const {
    return select_special(
        gamma_ == T(1), [&] { return closed_marginal(x).excess(); }, [&] { return marginal(x).excess(); });
  }

 private:
  // log(rest + weight exp(x))/x for weight + rest = 1, given phi = (exp(x) - 1)/x; the limit at x = 0 is
  // weight.
  static T log_mean_exp(const T& weight, const T& rest, const T& x, const T& phi) {
    const T change = weight * x * phi;
    const auto lost = (change < T(-0.5)), large = (x > T(80));
    const T shrunk = log(rest + weight * exp(x)) / select(lost, x, T(1));
    const T grown = T(1) + log(weight + rest * exp(-x)) / select(large, x, T(1));
    const T between = weight * phi * log1p_over(select(lost | large, T(0), change));
    return select(large, grown, select(lost, shrunk, between));
  }

  static double_double<T> bounded(const double_double<T>& r2) {
    const T most = square(largest_slope<T>());
    return {minimum(r2.high, most), low_where(r2.high <= most, r2)};
  }
  detail::gtr_logarithmic<T> closed_marginal(const slope<T>& x) const {
    return {x.value.high, a2_, span_, omega_};
  }
  detail::gtr_marginal<T> marginal(const slope<T>& x) const {
    if constexpr (records<T>) {
      // At gamma = 1 it is the derivative that is wanted, a quotient that vanishes.
      const T g =
          select(g_ == T(0), T(g_ + T(sizeof(typename scalar_traits<T>::real) == 4 ? 1e-3 : 1e-7)), g_);
      return {x, smaller_, exact_span(), ratio(x.squared), g, T(omega_ * expm1_over(T(-abs(g) * beta_)))};
    } else {
      return {x, smaller_, exact_span(), ratio(x.squared), g_, T(omega_ * select(g_ > T(0), down_, up_))};
    }
  }
  // |1 - alpha^2|, and (exp(V) - 1) over it, with the digits that an exponent needs.
  double_double<T> exact_span() const {
    if constexpr (one_number<T>) return span_;
    const double_double<T> span = larger() + -smaller();
    return fast_two_sum(span.high, low_of(span));
  }
  double_double<T> ratio(const double_double<T>& r2_argument) const {
    const double_double<T> r2 = bounded(r2_argument);
    return quotient(r2, smaller() * (larger() + r2));
  }
  double_double<T> smaller() const { return {smaller_, select(alpha_ < T(1), a2_low(), T(0))}; }
  double_double<T> larger() const { return {larger_, select(alpha_ < T(1), T(0), a2_low())}; }
  T a2_low() const { return two_prod_error(alpha_, alpha_, a2_); }

  T alpha_, gamma_, a2_;
  T span_, omega_, beta_, g_, up_, down_, smaller_, larger_, norm_;
};

static_assert(radial_family<gtr<float>> && radial_family<gtr<double>>);

}  // namespace microfacet
