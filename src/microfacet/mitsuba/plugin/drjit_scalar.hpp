// What Dr.Jit's arrays (packets, traced arrays, differentiable arrays) lack of the scalar contract
// (core/math.hpp). To be included before the headers of families.
#pragma once

#include <drjit/math.h>

#include <concepts>
#include <numbers>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace drjit {

template <class V>
concept real_array = is_array_v<V> && std::floating_point<scalar_t<V>>;

template <class M>
concept mask_array = is_array_v<M> && is_mask_v<M>;

// Nothing is known of a traced mask while a kernel is being traced: branches and loops are taken whole.
template <mask_array M>
bool any_lane(const M& mask) {
  if constexpr (is_jit_v<M>) {
    return true;
  } else {
    return any_nested(mask);
  }
}
template <real_array V>
V multiply_add(const V& a, const V& b, const V& c) {
  return fmadd(a, b, c);
}
template <real_array V>
V two_prod_error(const V& a, const V& b, const V& p) {
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
  if constexpr (sizeof(scalar_t<V>) == 4) {
    V series(1);  // of (exp(x) - 1)/x
    for (int k = 9; k >= 2; --k) series = fmadd(series, x * V(1.0 / k), V(1));
    return select(abs(x) < V(0.5), x * series, u - V(1));
  } else {
    return select(u == V(1), x, select(abs(x) < V(0.5), (u - V(1)) * x / log(u), u - V(1)));
  }
}

}  // namespace drjit

template <drjit::real_array V>
struct microfacet::scalar_traits<V> {
  using real = drjit::scalar_t<V>;
};

namespace microfacet::elementary {

template <drjit::real_array V>
circle<V> cos_sin_of_turns(const V& x) {
  const auto [sine, cosine] = drjit::sincos(x * V(2 * std::numbers::pi));
  return {cosine, sine};
}

}  // namespace microfacet::elementary
