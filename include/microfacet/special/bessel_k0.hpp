// The modified Bessel functions K_0 and K_1, in the form in which slopes need them.
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/special/coefficients/special.hpp"

namespace microfacet {

namespace detail {

// 2 K_0(2y) and 2y K_1(2y) at y^2, or at y itself: round 0 as log(y) A(y^2) + B(y^2), fitted together, beyond
// as exp(-2y) times a rational function.
template <class T>
class k0_functions {
 public:
  // A fast root of infinity may be nan.
  explicit k0_functions(const double_double<T>& y2)
      : k0_functions(T(sqrt(minimum(y2.high, T(most)))), y2.high, y2.high < T(square(meeting))) {
    const auto finite = y2.high < T(most);
    if constexpr (!one_number<T>)
      rest_ = select(finite, T(residual(y2.high, root_, root_) + low_of(y2)), T(0));
  }
  k0_functions(const T& y, const T& y2) : k0_functions(y, y2, y < T(meeting)) {}

  // factor 2 K_0(2y)
  MICROFACET_INLINE T density(const T& factor = T(1)) const {
    using namespace coefficients;
    const auto inside = [&] {
      return T(factor * multiply_add(logarithm(),
                                     polynomial(by_precision<T>(k0_near_log_32, k0_near_log_64), y2_),
                                     T(y2_ * polynomial(by_precision<T>(k0_near_32, k0_near_64), y2_))));
    };
    const auto outside = [&] {
      const T denominator = polynomial(by_precision<T>(k0_far_denominator_32, k0_far_denominator_64), y_);
      const T inverse = T(1) / (denominator * sqrt(y_));
      const T numerator = polynomial(by_precision<T>(k0_far_numerator_32, k0_far_numerator_64), y_);
      return times_exp(T(factor * (numerator * inverse)), square(T(denominator * inverse)));
    };
    return select_lazy(near_, inside, outside);
  }
  T survival() const {  // 2y K_1(2y)
    return select_lazy(near_, [&] { return T(T(1) - within()); }, [&] { return beyond(); });
  }
  // 1 - survival near 0, survival elsewhere, both to full relative accuracy.
  T within() const {
    using namespace coefficients;
    return y2_ * multiply_add(logarithm(), polynomial(by_precision<T>(k1_near_log_32, k1_near_log_64), y2_),
                              polynomial(by_precision<T>(k1_near_32, k1_near_64), y2_));
  }
  T beyond() const {
    using namespace coefficients;
    const T denominator = polynomial(by_precision<T>(k1_far_denominator_32, k1_far_denominator_64), y_);
    const T inverse = T(1) / (denominator * y_);
    const T numerator = polynomial(by_precision<T>(k1_far_numerator_32, k1_far_numerator_64), y_);
    return times_exp(T((numerator * inverse) * (y_ * sqrt(y_))), T(denominator * inverse));
  }

 private:
  using mask = decltype(T(0) < T(0));
  static constexpr double meeting = 0.5625, most = 1e30;

  k0_functions(const T& y, const T& y2, const mask& nearby)
      : near_(nearby), y_(minimum(maximum(y, smallest<T>()), T(1e3))), y2_(y2), root_(y) {}

  T logarithm() const { return T(-0.57721566490153286061) - log(y_); }
  // factor exp(-2y), for y^2 = root^2 + rest.
  T times_exp(const T& factor, const T& inverse_y) const {
    T corrected = factor;
    if constexpr (!one_number<T>) corrected = multiply_add(T(-factor * inverse_y), rest_, factor);
    return times_exp_minus(corrected, double_double<T>(root_ + root_));
  }

  mask near_;
  T y_, y2_, root_, rest_ = T(0);
};

}  // namespace detail

}  // namespace microfacet
