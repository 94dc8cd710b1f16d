// Packs of several sizes, for tests that a lane's result does not depend on the pack that it travels in.
#pragma once

#include <bit>
#include <cstddef>
#include <vector>

#include "microfacet/core/pack.hpp"

namespace packs {

// visit.operator()<Pack>() for a few sizes of packs of T.
template <class T, class Visitor>
void each(const Visitor& visit) {
#if MICROFACET_VECTOR_EXTENSIONS
  visit.template operator()<microfacet::pack<T, 16>>();
#if !defined(TEST_ONE_PACK)
  visit.template operator()<microfacet::pack<T, 32, 2>>();
  visit.template operator()<microfacet::pack<T, 64>>();
#endif
#endif
}

template <class T>
std::vector<microfacet::integer_of<T>> bits_of(const std::vector<T>& values) {
  std::vector<microfacet::integer_of<T>> bits;
  for (const T x : values) bits.push_back(std::bit_cast<microfacet::integer_of<T>>(x));
  return bits;
}

// The bits of function(x) for all values, computed in packs whose lanes are far apart in `values`.
template <class Pack, class T, class Function>
std::vector<microfacet::integer_of<T>> apply(const std::vector<T>& values, const Function& function) {
  std::vector<T> results(values.size());
  const std::size_t count = values.size(), stride = count / Pack::size + 1;
  for (std::size_t first = 0; first < stride; ++first) {
    Pack x(T(0));
    for (int i = 0; i < Pack::size; ++i)
      x.set(i, values[(first + static_cast<std::size_t>(i) * stride) % count]);
    const Pack y = function(x);
    for (int i = 0; i < Pack::size; ++i)
      results[(first + static_cast<std::size_t>(i) * stride) % count] = y[i];
  }
  return bits_of(results);
}

}  // namespace packs
