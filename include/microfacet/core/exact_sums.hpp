// What roundings lose, and sums whose terms cancel (T. J. Dekker, Numerische Mathematik 18, 1971).
#pragma once

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// What s = a + b rounded lacks of the sum, whatever the order of a and b.
template <class T>
MICROFACET_INLINE T two_sum_error(const T& a, const T& b, const T& s) {
  const T t = rounded(T(s - a));
  return rounded(T(a - rounded(T(s - t)))) + rounded(T(b - t));
}
// A sum of products that keeps the digits which cancellation leaves, in any format.
template <class T>
struct sum_of_products {
  T high, low;

  MICROFACET_INLINE sum_of_products(const T& a, const T& b)
      : high(rounded(T(a * b))), low(two_prod_error(a, b, high)) {}
  MICROFACET_INLINE sum_of_products plus(const T& a, const T& b) const {
    const sum_of_products product(a, b);
    sum_of_products sum = *this;
    sum.high = rounded(T(high + product.high));
    sum.low = low + (two_sum_error(high, product.high, sum.high) + product.low);
    return sum;
  }
  MICROFACET_INLINE T value() const { return high + low; }
};

// a - b * c where b * c is a rounded: without error.
template <class T>
MICROFACET_INLINE T residual(const T& a, const T& b, const T& c) {
  if constexpr (MICROFACET_FUSED) {
    return multiply_add(T(-b), c, a);
  } else {
    const T p = rounded(T(b * c));
    return rounded(T(a - p)) - two_prod_error(b, c, p);
  }
}

}  // namespace microfacet
