// Small tables looked up lane by lane: in registers where the hardware permutes them, else number by number.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"

namespace microfacet {

// Of the first N numbers of the table.
template <std::size_t N, std::floating_point T, std::size_t Size>
MICROFACET_INLINE T lookup(const std::array<T, Size>& table, integer_of<T> index) {
  return table[static_cast<std::size_t>(index)];
}

#if MICROFACET_VECTOR_EXTENSIONS
namespace registers {

// clang-format off
template <std::size_t N, class Vector, class T, class Indices>
MICROFACET_INLINE Vector lookup(const T* table, const Indices& index) {
#if defined(__AVX512F__)
  if constexpr (sizeof(Vector) == 64 && sizeof(T) == 4 && N == 16) {
    return _mm512_permutexvar_ps((__m512i)index, _mm512_loadu_ps(table));
  } else if constexpr (sizeof(Vector) == 64 && sizeof(T) == 4 && N == 32) {
    return _mm512_permutex2var_ps(_mm512_loadu_ps(table), (__m512i)index, _mm512_loadu_ps(table + 16));
  } else if constexpr (sizeof(Vector) == 64 && sizeof(T) == 8 && N == 16) {
    return _mm512_permutex2var_pd(_mm512_loadu_pd(table), (__m512i)index, _mm512_loadu_pd(table + 8));
  } else if constexpr (sizeof(Vector) == 64 && sizeof(T) == 8 && N == 32) {
    const __m512d lower = _mm512_permutex2var_pd(_mm512_loadu_pd(table), (__m512i)index, _mm512_loadu_pd(table + 8));
    const __m512d upper = _mm512_permutex2var_pd(_mm512_loadu_pd(table + 16), (__m512i)index, _mm512_loadu_pd(table + 24));
    return _mm512_mask_blend_pd(_mm512_test_epi64_mask((__m512i)index, _mm512_set1_epi64(16)), lower, upper);
  } else
#endif
  {
    Vector result;
    for (std::size_t i = 0; i < sizeof(Vector) / sizeof(T); ++i) result[i] = table[index[i]];
    return result;
  }
}
// clang-format on

}  // namespace registers

template <std::size_t N, class T, std::size_t Size, class I, std::size_t B, int K>
MICROFACET_INLINE pack<T, B, K> lookup(const std::array<T, Size>& table, const pack<I, B, K>& index) {
  using result = pack<T, B, K>;
  return result::from(
      [&](int k) { return registers::lookup<N, typename result::vector>(table.data(), index.v[k]); });
}
#endif

}  // namespace microfacet
