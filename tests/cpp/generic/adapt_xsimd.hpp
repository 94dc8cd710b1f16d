// What xsimd's batches lack of the scalar contract (core/math.hpp).
#pragma once

#include <xsimd/xsimd.hpp>

#include "microfacet/core/math.hpp"

namespace xsimd {

template <class T, class A>
bool any_lane(const batch_bool<T, A>& mask) {
  return any(mask);
}
template <class T, class A>
batch<T, A> multiply_add(const batch<T, A>& a, const batch<T, A>& b, const batch<T, A>& c) {
  return fma(a, b, c);
}
template <class T, class A>
batch<T, A> two_prod_error(const batch<T, A>& a, const batch<T, A>& b, const batch<T, A>& p) {
  return fms(a, b, p);
}

}  // namespace xsimd

template <class T, class A>
struct microfacet::scalar_traits<xsimd::batch<T, A>> {
  using real = T;
};
