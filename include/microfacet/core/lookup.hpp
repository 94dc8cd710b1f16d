// Small tables, looked up lane by lane: in registers where the hardware permutes them, else number by number.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"

namespace microfacet {

// Gives the element index mod N of the first N in the table; N is a power of two.
template <std::size_t N, class Element, std::size_t Size, std::integral Integer>
MICROFACET_INLINE Element lookup(const std::array<Element, Size>& table, Integer index) {
  return table[static_cast<std::size_t>(index) % N];
}
// Shifts in zeros, each lane by its own n.
template <std::integral Integer>
MICROFACET_INLINE Integer shift_right(Integer a, Integer n) {
  return static_cast<Integer>(static_cast<std::make_unsigned_t<Integer>>(a) >> n);
}

#if MICROFACET_VECTOR_EXTENSIONS
namespace registers {

template <std::size_t N, class Vector, class Element, class Indices>
MICROFACET_INLINE Vector lookup(const Element* table, const Indices& index) {
#if defined(__AVX512F__)
  if constexpr (sizeof(Vector) == 64) {
    const auto at = std::bit_cast<__m512i>(index);
    const auto part = [table](std::size_t i) { return _mm512_loadu_si512(table + i * 64 / sizeof(Element)); };
    if constexpr (sizeof(Element) == 4 && N == 16) {
      return std::bit_cast<Vector>(_mm512_permutexvar_epi32(at, part(0)));
    } else if constexpr (sizeof(Element) == 4 && N == 32) {
      return std::bit_cast<Vector>(_mm512_permutex2var_epi32(part(0), at, part(1)));
    } else if constexpr (sizeof(Element) == 8 && N == 16) {
      return std::bit_cast<Vector>(_mm512_permutex2var_epi64(part(0), at, part(1)));
    } else if constexpr (sizeof(Element) == 8 && N == 32) {
      const __m512i lower = _mm512_permutex2var_epi64(part(0), at, part(1));
      const __m512i upper = _mm512_permutex2var_epi64(part(2), at, part(3));
      const __mmask8 second = _mm512_test_epi64_mask(at, _mm512_set1_epi64(16));
      return std::bit_cast<Vector>(_mm512_mask_blend_epi64(second, lower, upper));
    }
  }
#endif
#if defined(__AVX2__)
  constexpr std::size_t bytes = N * sizeof(Element);
  if constexpr (sizeof(Vector) == 32 && (bytes == 64 || bytes == 128)) {
    // Permutes each register of the table and blends them by the higher bits of the index.
    constexpr bool wide = sizeof(Element) == 8;
    const auto number = std::bit_cast<__m256i>(index);
    // The halves of a double are permuted as two numbers.
    const auto at = wide ? _mm256_add_epi32(_mm256_shuffle_epi32(_mm256_slli_epi64(number, 1), 0xa0),
                                            _mm256_set1_epi64x(std::int64_t{1} << 32))
                         : number;
    const auto part = [&](std::size_t i) {
      return _mm256_permutevar8x32_ps(_mm256_loadu_ps(reinterpret_cast<const float*>(table) + 8 * i), at);
    };
    const auto by_bit = [&](int bit, __m256 clear, __m256 set) {
      if constexpr (wide) {
        return _mm256_castpd_ps(_mm256_blendv_pd(_mm256_castps_pd(clear), _mm256_castps_pd(set),
                                                 _mm256_castsi256_pd(_mm256_slli_epi64(number, 63 - bit))));
      } else {
        return _mm256_blendv_ps(clear, set, _mm256_castsi256_ps(_mm256_slli_epi32(number, 31 - bit)));
      }
    };
    constexpr int first = wide ? 2 : 3;
    const auto four = [&](std::size_t i) { return by_bit(first, part(i), part(i + 1)); };
    if constexpr (bytes == 64) {
      return std::bit_cast<Vector>(four(0));
    } else {
      return std::bit_cast<Vector>(by_bit(first + 1, four(0), four(2)));
    }
  } else if constexpr (sizeof(Vector) == 32 && sizeof(Element) == 4) {
    const auto at = _mm256_and_si256(std::bit_cast<__m256i>(index), _mm256_set1_epi32(N - 1));
    return std::bit_cast<Vector>(_mm256_i32gather_ps(reinterpret_cast<const float*>(table), at, 4));
  } else if constexpr (sizeof(Vector) == 32) {
    const auto at = _mm256_and_si256(std::bit_cast<__m256i>(index), _mm256_set1_epi64x(N - 1));
    return std::bit_cast<Vector>(_mm256_i64gather_pd(reinterpret_cast<const double*>(table), at, 8));
  }
#endif
  Vector result;
  for (std::size_t i = 0; i < sizeof(Vector) / sizeof(Element); ++i)
    result[i] = table[static_cast<std::size_t>(index[i]) % N];
  return result;
}

}  // namespace registers

template <std::size_t N, class Element, std::size_t Size, class Integer, std::size_t B, int K>
MICROFACET_INLINE pack<Element, B, K> lookup(const std::array<Element, Size>& table,
                                             const pack<Integer, B, K>& index) {
  using vector = typename pack<Element, B, K>::vector;
  return pack<Element, B, K>::from(
      [&](int k) { return registers::lookup<N, vector>(table.data(), index.v[k]); });
}
template <std::integral Integer, std::size_t B, int K>
MICROFACET_INLINE pack<Integer, B, K> shift_right(const pack<Integer, B, K>& a,
                                                  const pack<Integer, B, K>& n) {
  using vector = typename pack<Integer, B, K>::vector;
  typedef std::make_unsigned_t<Integer> plain __attribute__((vector_size(B)));
  return pack<Integer, B, K>::from([&](int k) {
    return std::bit_cast<vector>(std::bit_cast<plain>(a.v[k]) >> std::bit_cast<plain>(n.v[k]));
  });
}
#endif

}  // namespace microfacet
