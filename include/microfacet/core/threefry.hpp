// Random numbers by their place: the numbers of a walk are a function of a key (seed, element) and a counter
// (walk, draw), so that they depend on no order, no thread and no length of an array. Threefry-2x64 with 20
// rounds: J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3,
// SC 2011.
#pragma once

#include <array>
#include <cstdint>

namespace microfacet {

using words = std::array<std::uint64_t, 2>;

inline words threefry(const words& key, const words& counter) {
  constexpr std::array<int, 8> rotations{16, 42, 12, 31, 16, 32, 24, 21};
  const std::array<std::uint64_t, 3> k{key[0], key[1], 0x1bd11bdaa9fc1a22 ^ key[0] ^ key[1]};
  words x{counter[0] + k[0], counter[1] + k[1]};
  for (unsigned round = 0; round < 20; ++round) {
    const int r = rotations[round % 8];
    x[0] += x[1];
    x[1] = ((x[1] << r) | (x[1] >> (64 - r))) ^ x[0];
    if (round % 4 == 3) {
      const unsigned s = round / 4 + 1;
      x[0] += k[s % 3], x[1] += k[(s + 1) % 3] + s;
    }
  }
  return x;
}

// In [0, 1), with all the bits that T has there.
template <class T>
T uniform_of(std::uint64_t word) {
  constexpr int digits = sizeof(T) == 4 ? 24 : 53;
  return static_cast<T>(word >> (64 - digits)) * static_cast<T>(1.0 / static_cast<double>(1ULL << digits));
}

}  // namespace microfacet
