// What random walks carry along, side by side in arrays; those that end make room for the others.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "microfacet/core/math.hpp"
#include "microfacet/core/threefry.hpp"

namespace microfacet {

// Walks at a time.
inline constexpr int walk_block = 256;
template <class T>
using block = std::array<T, walk_block>;
template <class T>
struct block3 {
  block<T> x, y, z;
};

// The walks to be made: for `count` elements up to walk_block, from directions wi of unit length, wi.z < 0
// for light from below. All random numbers are functions of (seed, element), the number of the walk and the
// number of the draw.
template <class T>
struct walk_task {
  int count = 0;
  block3<T> wi{};
  std::array<block<T>, 2> parameters{};  // of the material
  block<std::uint64_t> element{};
  std::uint64_t seed = 0;
};

template <class T>
struct walk_rays {
  static constexpr unsigned uniforms = 8;  // of a step: flight, facet (4), material (2), roulette

  int alive = 0, padded = 0;  // arrays are valid up to `padded`, a multiple of any number of lanes
  block3<T> w{}, back{};      // where light goes, and where it comes from
  block<T> below{}, depth{}, throughput{}, sigma{};  // 1 below the facets; of back
  std::array<block<T>, uniforms> xi{};

  int slot(int i) const { return slot_[index(i)]; }
  T parameter(int k, int i) const { return parameters_[index(k)][index(i)]; }
  const block<T>& parameter(int k) const { return parameters_[index(k)]; }

  void start(const walk_task<T>& t, std::uint64_t walk) {
    walk_ = walk, seed_ = t.seed, alive = t.count, element_ = t.element, parameters_ = t.parameters;
    for (std::size_t i = 0; i < index(t.count); ++i) {
      // Light moves against wi; from below it moves along wi, turned over.
      const bool under = t.wi.z[i] < 0;
      const T turned = under ? T(1) : T(-1);
      w.x[i] = turned * t.wi.x[i], w.y[i] = turned * t.wi.y[i], w.z[i] = turned * t.wi.z[i];
      below[i] = under ? T(1) : T(0), depth[i] = T(0), throughput[i] = T(1), slot_[i] = static_cast<int>(i);
    }
    fill_up();
  }

  void draw(long met) {
    const std::uint64_t number = (walk_ << 24) + static_cast<std::uint64_t>(met);
    const std::size_t n = index(padded);
    for (unsigned k = 0; k < uniforms / 2; ++k) {
      words_.x0.fill(number), words_.x1.fill(k);
      words_.scramble(n, seed_, element_);
      for (std::size_t i = 0; i < n; ++i) xi[2 * k][i] = uniform_of<T>(words_.x0[i]);
      for (std::size_t i = 0; i < n; ++i) xi[2 * k + 1][i] = uniform_of<T>(words_.x1[i]);
    }
  }

  // Keeps the rays for which stays(i), and reports the others.
  template <class Stays, class Report>
  void keep(const Stays& stays, const Report& report) {
    int kept = 0;
    for (int i = 0; i < alive; ++i) {
      if (stays(i)) {
        if (kept != i) move(i, kept);
        ++kept;
      } else {
        report(i);
      }
    }
    alive = kept;
    fill_up();
  }

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

 private:
  // Copies of the last walk, so that lanes are full.
  void fill_up() {
    constexpr int lanes = 32;
    padded = (alive + lanes - 1) / lanes * lanes;
    for (int i = alive; i < padded; ++i) move(alive - 1, i);
  }
  void move(int from_, int to_) {
    const std::size_t from = index(from_), to = index(to_);
    for (block3<T>* v : {&w, &back}) v->x[to] = v->x[from], v->y[to] = v->y[from], v->z[to] = v->z[from];
    below[to] = below[from], depth[to] = depth[from], throughput[to] = throughput[from];
    sigma[to] = sigma[from], element_[to] = element_[from], slot_[to] = slot_[from];
    for (auto& p : parameters_) p[to] = p[from];
    for (auto& u : xi) u[to] = u[from];
  }

  std::uint64_t walk_ = 0, seed_ = 0;
  threefry_words<walk_block> words_{};
  block<std::uint64_t> element_{};
  block<int> slot_{};
  std::array<block<T>, 2> parameters_{};
};

}  // namespace microfacet
