// Part of the light from a direction that a surface sends back: a mean over draws that are the same
// everywhere, so that it varies as smoothly as the surface does.
#pragma once

#include <drjit/while_loop.h>

#include <array>
#include <cstdint>

#include "rough_bsdf.hpp"
#include "walk.hpp"

namespace microfacet::plugin {

// Four uniform numbers for a normal; or the seed of a walk.
struct draw {
  std::array<Float, 4> facet;

  walk_seed seed() const { return walk_seed::of(facet[0], facet[1], facet[2], facet[3]); }
};

// The mean of value(draw) over a lattice in four dimensions: that of Korobov's which fills pairs of axes
// best.
template <class Value>
Unpolarized mean_of_draws(const Interaction& si, const Mask& active, const Value& value) {
  static constexpr std::uint32_t count = 64;
  struct state {
    UInt32 k;
    Mask active;
    Unpolarized sum;
    DRJIT_STRUCT(state, k, active, sum)
  };
  const walk_seed seed = walk_seed::of(si.wi.x(), si.wi.y(), si.wi.z(), si.p.x(), si.p.y(), si.p.z());
  const auto [a, b] = mi::sample_tea_32<UInt32>(seed.a, seed.b, 3);
  const std::array<UInt32, 4> shift{seed.a, seed.b, a, b};
  state first = dr::zeros<state>(dr::width(active));
  first.active = active;
  const auto end = dr::while_loop(
      dr::make_tuple(first), [](const state& s) { return s.active; },
      [&](state& s) {
        draw xi;
        static constexpr std::array<std::uint32_t, 4> generator{1, 29, 9, 5};  // powers of 29
        // Words as fractions of 1, which go round.
        for (std::size_t i = 0; i < 4; ++i)
          xi.facet[i] = uniform_of_word(shift[i] + s.k * (generator[i] * (0x80000000U / count * 2U)));
        s.sum += value(xi);
        s.k += 1U;
        s.active &= s.k < UInt32(count);
      },
      "Mean over facets");
  // Rounding may exceed 1.
  return dr::minimum(Unpolarized(dr::get<0>(end).sum * (1.F / float(count))), 1.F) & active;
}

}  // namespace microfacet::plugin
