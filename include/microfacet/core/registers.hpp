// The instructions that a register's operators do not reach: a * b + c rounded once, sqrt, the larger and the
// smaller of two (a unless b is larger, or smaller, so that a nan in a stays), and whether any lane of a mask
// is set. On x86-64 by name, elsewhere by a loop over the lanes that the compiler turns into the instruction
// if it can.
#pragma once

#include <cmath>

#include "microfacet/core/math.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace microfacet::registers {

template <class Vector>
MICROFACET_INLINE Vector sqrt(Vector a) {
  for (unsigned i = 0; i < sizeof a / sizeof a[0]; ++i) a[i] = std::sqrt(a[i]);
  return a;
}
template <class Vector>
MICROFACET_INLINE Vector fused(Vector a, const Vector& b, const Vector& c) {
  for (unsigned i = 0; i < sizeof a / sizeof a[0]; ++i) a[i] = std::fma(a[i], b[i], c[i]);
  return a;
}
template <class Vector>
MICROFACET_INLINE Vector maximum(const Vector& a, const Vector& b) {
  return a < b ? b : a;
}
template <class Vector>
MICROFACET_INLINE Vector minimum(const Vector& a, const Vector& b) {
  return a > b ? b : a;
}
// Whether any lane is set of lanes that are 0 or -1.
template <class Vector>
MICROFACET_INLINE bool any_lane(const Vector& mask) {
#if defined(__x86_64__)
  if constexpr (sizeof mask == 16) return _mm_movemask_epi8(reinterpret_cast<__m128i>(mask)) != 0;
#if defined(__AVX__)
  if constexpr (sizeof mask == 32) {
    const __m256i all = reinterpret_cast<__m256i>(mask);
    return !_mm256_testz_si256(all, all);
  }
#endif
#if defined(__AVX512F__)
  if constexpr (sizeof mask == 64) {
    const __m512i all = reinterpret_cast<__m512i>(mask);
#if defined(__AVX512DQ__)  // the mask as the comparison left it
    if constexpr (sizeof mask[0] == 4) return _mm512_movepi32_mask(all) != 0;
    if constexpr (sizeof mask[0] == 8) return _mm512_movepi64_mask(all) != 0;
#endif
    return _mm512_test_epi64_mask(all, all) != 0;
  }
#endif
#endif
  auto lanes = mask[0];
  for (unsigned i = 1; i < sizeof mask / sizeof mask[0]; ++i) lanes |= mask[i];
  return lanes != 0;
}

#if defined(__x86_64__)
#define MICROFACET_REGISTER(TYPE, PREFIX, SUFFIX)                                        \
  MICROFACET_INLINE TYPE sqrt(TYPE a) { return PREFIX##_sqrt_##SUFFIX(a); }              \
  MICROFACET_INLINE TYPE maximum(TYPE a, TYPE b) { return PREFIX##_max_##SUFFIX(b, a); } \
  MICROFACET_INLINE TYPE minimum(TYPE a, TYPE b) { return PREFIX##_min_##SUFFIX(b, a); }
#define MICROFACET_FUSED_REGISTER(TYPE, PREFIX, SUFFIX) \
  MICROFACET_INLINE TYPE fused(TYPE a, TYPE b, TYPE c) { return PREFIX##_fmadd_##SUFFIX(a, b, c); }
MICROFACET_REGISTER(__m128, _mm, ps)
MICROFACET_REGISTER(__m128d, _mm, pd)
#if defined(__AVX__)
MICROFACET_REGISTER(__m256, _mm256, ps)
MICROFACET_REGISTER(__m256d, _mm256, pd)
#endif
#if defined(__FMA__)
MICROFACET_FUSED_REGISTER(__m128, _mm, ps)
MICROFACET_FUSED_REGISTER(__m128d, _mm, pd)
MICROFACET_FUSED_REGISTER(__m256, _mm256, ps)
MICROFACET_FUSED_REGISTER(__m256d, _mm256, pd)
#endif
#if defined(__AVX512F__)
MICROFACET_REGISTER(__m512, _mm512, ps)
MICROFACET_REGISTER(__m512d, _mm512, pd)
MICROFACET_FUSED_REGISTER(__m512, _mm512, ps)
MICROFACET_FUSED_REGISTER(__m512d, _mm512, pd)
#endif
#undef MICROFACET_REGISTER
#undef MICROFACET_FUSED_REGISTER
#endif

// a 2^n for a whole n, where one instruction does it.
template <class Vector>
void times_power(const Vector& a, const Vector& n) = delete;
#if defined(__AVX512F__)
MICROFACET_INLINE __m512 times_power(__m512 a, __m512 n) { return _mm512_scalef_ps(a, n); }
MICROFACET_INLINE __m512d times_power(__m512d a, __m512d n) { return _mm512_scalef_pd(a, n); }
#endif

}  // namespace microfacet::registers
