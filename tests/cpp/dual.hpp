// A number with one derivative (forward automatic differentiation), to prove the headers generic and their
// derivatives right. Like the batch it converts from a number only explicitly and is found by ADL alone; its
// comparisons look at the value and give bool.
#pragma once

#include <cmath>
#include <type_traits>

#include "microfacet/core/math.hpp"

namespace autodiff {

struct dual {
  double x = 0;  // value
  double d = 0;  // derivative

  dual() = default;
  template <class A>
    requires std::is_arithmetic_v<A>
  explicit dual(A value) : x(static_cast<double>(value)) {}
  dual(double value, double derivative) : x(value), d(derivative) {}
  static dual variable(double value) { return {value, 1}; }

  friend dual operator+(dual a) { return a; }
  friend dual operator-(dual a) { return {-a.x, -a.d}; }
  friend dual operator+(dual a, dual b) { return {a.x + b.x, a.d + b.d}; }
  friend dual operator-(dual a, dual b) { return {a.x - b.x, a.d - b.d}; }
  friend dual operator*(dual a, dual b) { return {a.x * b.x, a.d * b.x + a.x * b.d}; }
  friend dual operator/(dual a, dual b) { return {a.x / b.x, (a.d - a.x / b.x * b.d) / b.x}; }
  dual& operator+=(dual b) { return *this = *this + b; }
  dual& operator-=(dual b) { return *this = *this - b; }
  dual& operator*=(dual b) { return *this = *this * b; }
  dual& operator/=(dual b) { return *this = *this / b; }

  friend bool operator<(dual a, dual b) { return a.x < b.x; }
  friend bool operator>(dual a, dual b) { return a.x > b.x; }
  friend bool operator<=(dual a, dual b) { return a.x <= b.x; }
  friend bool operator>=(dual a, dual b) { return a.x >= b.x; }
  friend bool operator==(dual a, dual b) { return a.x == b.x; }
  friend bool operator!=(dual a, dual b) { return a.x != b.x; }
};

// A selected constant branch may carry an infinite or nan derivative in the branch not taken: select drops
// it.
inline dual select(bool m, dual a, dual b) { return m ? a : b; }

// f(a) with derivative f'(a) a'. A zero derivative stays zero where f' is infinite.
inline dual chain(double value, double slope, dual a) { return {value, a.d == 0 ? 0 : slope * a.d}; }

inline dual abs(dual a) { return chain(std::abs(a.x), std::copysign(1.0, a.x), a); }
inline dual sqrt(dual a) { return chain(std::sqrt(a.x), 0.5 / std::sqrt(a.x), a); }
inline dual exp(dual a) { return chain(std::exp(a.x), std::exp(a.x), a); }
inline dual expm1(dual a) { return chain(std::expm1(a.x), std::exp(a.x), a); }
inline dual log(dual a) { return chain(std::log(a.x), 1 / a.x, a); }
inline dual log1p(dual a) { return chain(std::log1p(a.x), 1 / (1 + a.x), a); }
// The rounding of a product, which is constant to the derivative.
inline dual two_prod_error(dual a, dual b, dual p) { return dual(std::fma(a.x, b.x, -p.x)); }
inline dual floor(dual a) { return dual(std::floor(a.x)); }
inline dual pow(dual a, dual b) {
  const double value = std::pow(a.x, b.x);
  const double from_base = a.d == 0 ? 0 : b.x * std::pow(a.x, b.x - 1) * a.d;
  const double from_exponent = b.d == 0 ? 0 : value * std::log(a.x) * b.d;
  return {value, from_base + from_exponent};
}

}  // namespace autodiff

template <>
struct microfacet::scalar_traits<autodiff::dual> {
  using real = double;
};
