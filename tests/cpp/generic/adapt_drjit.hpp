// What Dr.Jit's arrays (packets, traced arrays, differentiable arrays) lack of the scalar contract
// (core/math.hpp).
#pragma once

#include <drjit/math.h>

#include <concepts>

#include "microfacet/core/math.hpp"

namespace drjit {

template <class V>
concept real_array = is_array_v<V> && std::floating_point<scalar_t<V>>;

template <real_array V>
V multiply_add(const V& a, const V& b, const V& c) {
  return fmadd(a, b, c);
}
template <real_array V>
V product_error(const V& a, const V& b, const V& p) {
  return fmsub(a, b, p);
}
template <real_array V>
V square(const V& a) {  // both libraries have one
  return a * a;
}
// W. Kahan's forms: what 1 + x loses of x is lost on both sides of the quotient.
template <real_array V>
V log1p(const V& x) {
  const V u = x + V(1);
  return select(u == V(1), x, select(u < V(microfacet::inf), x * log(u) / (u - V(1)), u));
}
template <real_array V>
V expm1(const V& x) {
  const V u = exp(x);
  return select(u == V(1), x, select(abs(x) < V(0.5), (u - V(1)) * x / log(u), u - V(1)));
}

}  // namespace drjit

template <drjit::real_array V>
struct microfacet::scalar_traits<V> {
  using real = drjit::scalar_t<V>;
};
