// A SIMD batch of the strictest kind, to prove the headers generic: 4 doubles or 8 floats in a vector of the
// compiler. It converts from a number only explicitly, compares to a mask that is no bool, and finds its
// mathematics by ADL in this namespace alone, lane by lane from <cmath>.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "microfacet/core/math.hpp"

namespace lanes {

template <class T>
struct mask {
  using lane = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  typedef lane vector __attribute__((vector_size(32)));
  vector v;  // all bits of a lane set, or none

  friend mask operator&(const mask& a, const mask& b) { return {a.v & b.v}; }
  friend mask operator|(const mask& a, const mask& b) { return {a.v | b.v}; }
  friend mask operator!(const mask& a) { return {~a.v}; }
};

template <class T>
struct batch {
  static constexpr int size = 32 / static_cast<int>(sizeof(T));
  using value_type = T;
  typedef T vector __attribute__((vector_size(32)));
  vector v;

  batch() = default;
  template <class A>
    requires std::is_arithmetic_v<A>
  explicit batch(A a) {
    for (int i = 0; i < size; ++i) v[i] = static_cast<T>(a);
  }
  static batch of(const vector& w) {
    batch b;
    b.v = w;
    return b;
  }
  T operator[](int i) const { return v[i]; }
  void set(int i, T x) { v[i] = x; }

  friend batch operator+(const batch& a) { return a; }
  friend batch operator-(const batch& a) { return of(-a.v); }
  friend batch operator+(const batch& a, const batch& b) { return of(a.v + b.v); }
  friend batch operator-(const batch& a, const batch& b) { return of(a.v - b.v); }
  friend batch operator*(const batch& a, const batch& b) { return of(a.v * b.v); }
  friend batch operator/(const batch& a, const batch& b) { return of(a.v / b.v); }
  batch& operator+=(const batch& b) { return *this = *this + b; }
  batch& operator-=(const batch& b) { return *this = *this - b; }
  batch& operator*=(const batch& b) { return *this = *this * b; }
  batch& operator/=(const batch& b) { return *this = *this / b; }

  friend mask<T> operator<(const batch& a, const batch& b) { return {a.v < b.v}; }
  friend mask<T> operator>(const batch& a, const batch& b) { return {a.v > b.v}; }
  friend mask<T> operator<=(const batch& a, const batch& b) { return {a.v <= b.v}; }
  friend mask<T> operator>=(const batch& a, const batch& b) { return {a.v >= b.v}; }
  friend mask<T> operator==(const batch& a, const batch& b) { return {a.v == b.v}; }
  friend mask<T> operator!=(const batch& a, const batch& b) { return {a.v != b.v}; }
};

template <class T>
batch<T> select(const mask<T>& m, const batch<T>& a, const batch<T>& b) {
  batch<T> r;
  for (int i = 0; i < batch<T>::size; ++i) r.v[i] = m.v[i] ? a.v[i] : b.v[i];
  return r;
}

template <class T>
bool any_lane(const mask<T>& m) {
  for (int i = 0; i < batch<T>::size; ++i)
    if (m.v[i]) return true;
  return false;
}

// a * b - p for the rounded product p.
template <class T>
batch<T> two_prod_error(const batch<T>& a, const batch<T>& b, const batch<T>& p) {
  batch<T> r;
  for (int i = 0; i < batch<T>::size; ++i) r.v[i] = std::fma(T(a.v[i]), T(b.v[i]), -T(p.v[i]));
  return r;
}

#define LANES_UNARY(name)                                                   \
  template <class T>                                                        \
  batch<T> name(const batch<T>& x) {                                        \
    batch<T> r;                                                             \
    for (int i = 0; i < batch<T>::size; ++i) r.v[i] = std::name(T(x.v[i])); \
    return r;                                                               \
  }
#define LANES_BINARY(name)                                                             \
  template <class T>                                                                   \
  batch<T> name(const batch<T>& x, const batch<T>& y) {                                \
    batch<T> r;                                                                        \
    for (int i = 0; i < batch<T>::size; ++i) r.v[i] = std::name(T(x.v[i]), T(y.v[i])); \
    return r;                                                                          \
  }

LANES_UNARY(abs)
LANES_UNARY(sqrt)
LANES_UNARY(exp)
LANES_UNARY(expm1)
LANES_UNARY(log)
LANES_UNARY(log1p)
LANES_UNARY(floor)
LANES_BINARY(pow)

#undef LANES_UNARY
#undef LANES_BINARY

}  // namespace lanes

template <class T>
struct microfacet::scalar_traits<lanes::batch<T>> {
  using real = T;
};
