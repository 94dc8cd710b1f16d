// A thin SIMD type: K registers of `Bytes` bytes on the vector extensions of GCC and Clang (K > 1 interleaves
// chains of dependent operations). A kernel that is written on a scalar T runs on it unchanged; its
// mathematics is core/elementary.hpp. A pack of integers is the mask of a comparison, or the bits of a pack
// of numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "microfacet/core/math.hpp"
#include "microfacet/core/registers.hpp"

#if defined(__GNUC__)
#define MICROFACET_VECTOR_EXTENSIONS 1

namespace microfacet {

template <class T, std::size_t Bytes, int K = 1>
struct pack {
  static constexpr int size = static_cast<int>(Bytes / sizeof(T)) * K;
  using lane = T;
  using integers = pack<integer_of<T>, Bytes, K>;
  typedef T vector __attribute__((vector_size(Bytes)));
  vector v[static_cast<std::size_t>(K)];

  pack() = default;
  template <class A>
    requires std::is_arithmetic_v<A>
  MICROFACET_INLINE explicit pack(A a) {
    for (vector& r : v) r = static_cast<T>(a) - vector{};
  }
  template <class Lanes>
  MICROFACET_INLINE static pack from(const Lanes& lanes) {  // lanes(k) is register k
    pack r;
    for (int k = 0; k < K; ++k) r.v[k] = lanes(k);
    return r;
  }
  T operator[](int i) const { return v[i * K / size][i % (size / K)]; }
  void set(int i, T x) { v[i * K / size][i % (size / K)] = x; }

  // Integers wrap round, as the instructions do; of signed ones the language does not say so.
  using modular_lane =
      typename std::conditional_t<std::is_integral_v<T>, std::make_unsigned<T>, std::type_identity<T>>::type;
  typedef modular_lane modular __attribute__((vector_size(Bytes)));
// Evaluates an expression for each register k: a loop rather than a function, which compilers would have to
// inline.
#define MICROFACET_EACH(RESULT, EXPRESSION)                                                         \
  {                                                                                                 \
    RESULT r;                                                                                       \
    for (int k = 0; k < K; ++k) {                                                                   \
      r.v[k] = (typename RESULT::vector)(EXPRESSION);                                               \
      if constexpr (std::is_floating_point_v<typename RESULT::lane>) MICROFACET_HOLD_LANES(r.v[k]); \
    }                                                                                               \
    return r;                                                                                       \
  }
#define MICROFACET_ARITHMETIC(OP)                                         \
  MICROFACET_INLINE friend pack operator OP(const pack& a, const pack& b) \
      MICROFACET_EACH(pack, (modular)a.v[k] OP(modular) b.v[k])
  MICROFACET_ARITHMETIC(+)
  MICROFACET_ARITHMETIC(-)
  MICROFACET_ARITHMETIC(*)
#undef MICROFACET_ARITHMETIC
#define MICROFACET_BINARY(RESULT, OP)                                       \
  MICROFACET_INLINE friend RESULT operator OP(const pack& a, const pack& b) \
      MICROFACET_EACH(RESULT, a.v[k] OP b.v[k])
  MICROFACET_BINARY(pack, /)
  MICROFACET_BINARY(pack, &)
  MICROFACET_BINARY(pack, |)
  MICROFACET_BINARY(pack, ^)
  MICROFACET_BINARY(integers, <)
  MICROFACET_BINARY(integers, >)
  MICROFACET_BINARY(integers, <=)
  MICROFACET_BINARY(integers, >=)
  MICROFACET_BINARY(integers, ==)
  MICROFACET_BINARY(integers, !=)
#undef MICROFACET_BINARY
  // clang-format off
  MICROFACET_INLINE friend pack operator-(const pack& a) MICROFACET_EACH(pack, -a.v[k])
  MICROFACET_INLINE friend pack operator!(const pack& a) MICROFACET_EACH(pack, ~a.v[k])
  MICROFACET_INLINE friend pack operator<<(const pack& a, int n) MICROFACET_EACH(pack, a.v[k] << n)
  MICROFACET_INLINE friend pack operator>>(const pack& a, int n) MICROFACET_EACH(pack, a.v[k] >> n)
  MICROFACET_INLINE friend pack select(const integers& mask, const pack& a, const pack& b)
    MICROFACET_EACH(pack, mask.v[k] ? a.v[k] : b.v[k])
  MICROFACET_INLINE friend integers bits(const pack& a) MICROFACET_EACH(integers, a.v[k])
  MICROFACET_INLINE friend pack from_bits(const integers& a, const pack&)  // the pack only names the type
    MICROFACET_EACH(pack, a.v[k])
  MICROFACET_INLINE friend pack sqrt(const pack& a) MICROFACET_EACH(pack, registers::sqrt(a.v[k]))
  MICROFACET_INLINE friend pack maximum(const pack& a, const pack& b)
    MICROFACET_EACH(pack, registers::maximum(a.v[k], b.v[k]))
  MICROFACET_INLINE friend pack minimum(const pack& a, const pack& b)
    MICROFACET_EACH(pack, registers::minimum(a.v[k], b.v[k]))
#if MICROFACET_FUSED
  MICROFACET_INLINE friend pack multiply_add(const pack& a, const pack& b, const pack& c)
    MICROFACET_EACH(pack, registers::fused(a.v[k], b.v[k], c.v[k]))
#else
  MICROFACET_INLINE friend pack multiply_add(const pack& a, const pack& b, const pack& c) {
    return a * b + c;
  }
#endif
  // clang-format on
#undef MICROFACET_EACH
};

template <class T, std::size_t B, int K>
MICROFACET_INLINE bool any_lane(const pack<T, B, K>& mask) {
  typename pack<T, B, K>::vector all = mask.v[0];
  for (int k = 1; k < K; ++k) all |= mask.v[k];
  return registers::any_lane(all);
}

template <class T, std::size_t B, int K>
struct scalar_traits<pack<T, B, K>> {
  using real = T;
};

}  // namespace microfacet
#endif
