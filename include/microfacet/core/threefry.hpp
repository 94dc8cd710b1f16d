// Random numbers by their place: the numbers of a walk are a function of a key (seed, element) and a counter
// (walk, draw), so that they depend on no order, no thread and no length of an array. Threefry-2x64 with 20
// rounds: J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3,
// SC 2011.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace microfacet {

// Words of n places at a time, for which compilers have vectors: on entry x is the counters, on return the
// random words, under the keys k.
template <std::size_t Most>
struct threefry_words {
  using words = std::array<std::uint64_t, Most>;
  words x0, x1;

  // k0 is the same for all.
  void scramble(std::size_t n, std::uint64_t k0, const words& k1) {
    for (std::size_t i = 0; i < n; ++i) x0[i] += k0, x1[i] += k1[i];
    four_rounds<16, 42, 12, 31>(n), inject(n, k0, k1, 1);
    four_rounds<16, 32, 24, 21>(n), inject(n, k0, k1, 2);
    four_rounds<16, 42, 12, 31>(n), inject(n, k0, k1, 3);
    four_rounds<16, 32, 24, 21>(n), inject(n, k0, k1, 4);
    four_rounds<16, 42, 12, 31>(n), inject(n, k0, k1, 5);
  }

 private:
  template <int R>
  void mix(std::size_t i) {
    x0[i] += x1[i];
    x1[i] = ((x1[i] << R) | (x1[i] >> (64 - R))) ^ x0[i];
  }
  template <int A, int B, int C, int D>
  void four_rounds(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) mix<A>(i), mix<B>(i), mix<C>(i), mix<D>(i);
  }
  // The key schedule: k0, k1, and both with a constant.
  void inject(std::size_t n, std::uint64_t k0, const words& k1, std::uint64_t s) {
    constexpr std::uint64_t parity = 0x1bd11bdaa9fc1a22;
    for (std::size_t i = 0; i < n; ++i) {
      const std::array<std::uint64_t, 3> k{k0, k1[i], parity ^ k0 ^ k1[i]};
      x0[i] += k[s % 3], x1[i] += k[(s + 1) % 3] + s;
    }
  }
};

// In [0, 1), with all the bits that T has there.
template <class T>
T uniform_of(std::uint64_t word) {
  constexpr int digits = sizeof(T) == 4 ? 24 : 53;
  return static_cast<T>(static_cast<std::int64_t>(word >> (64 - digits))) *
         static_cast<T>(1.0 / static_cast<double>(1ULL << digits));
}

}  // namespace microfacet
