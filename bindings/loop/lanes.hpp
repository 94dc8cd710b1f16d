// How arrays become lanes and lanes become arrays: any stride, any count up to the number of lanes.
#pragma once

#include <cstddef>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lanes.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#else
#include <cfenv>
#endif

namespace microfacet::bindings {

#if defined(__AVX512F__)
inline constexpr std::size_t register_bytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t register_bytes = 32;
#else
inline constexpr std::size_t register_bytes = 16;
#endif

// The widest thing that the kernels of this build compute on: a pack, or where the compiler has none, a
// number. Two registers interleave the chains of a kernel that is one long chain.
#if MICROFACET_VECTOR_EXTENSIONS
template <class T, int Registers = 1>
using lanes = pack<T, register_bytes, Registers>;
#else
template <class T, int = 1>
using lanes = T;
#endif
inline constexpr int most_registers = 2;

// Kernels compute with nan and inf on purpose, and subnormal numbers cost ten times as much as others: flush
// them to zero inside a loop, and give the caller back the control word and flags as they were.
class quiet_floating_point {
 public:
#if defined(__SSE2__)
  quiet_floating_point() : control_(_mm_getcsr()) { _mm_setcsr(masked_and_flushing); }
  ~quiet_floating_point() { _mm_setcsr(control_); }
#else
  quiet_floating_point() { std::feholdexcept(&control_); }
  ~quiet_floating_point() { std::fesetenv(&control_); }
#endif
  quiet_floating_point(const quiet_floating_point&) = delete;
  quiet_floating_point& operator=(const quiet_floating_point&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned masked_and_flushing = 0x9fc0;  // FTZ, DAZ, all exceptions masked, to nearest
  unsigned control_;
#else
  std::fenv_t control_;
#endif
};

}  // namespace microfacet::bindings
