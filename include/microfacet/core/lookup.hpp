// Small tables looked up lane by lane: in registers where the hardware permutes them, else number by number.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/pack.hpp"

namespace microfacet {

// The element index mod N of the first N in the table; N is a power of two.
template <std::size_t N, class Element, std::size_t Size, std::integral Integer>
MICROFACET_INLINE Element lookup(const std::array<Element, Size>& table, Integer index) {
  return table[static_cast<std::size_t>(index) % N];
}
// a >> n without regard to a sign, n chosen lane by lane.
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
