// Scattering of all orders: the random walk of bsdf/walk/step.hpp as one traced loop. Random numbers are
// functions of two words and of the number of facets met.
#pragma once

#include <drjit/while_loop.h>

#include <array>
#include <tuple>

#include "microfacet/bsdf/walk/step.hpp"
#include "rough_bsdf.hpp"

namespace microfacet::plugin {

// What one facet does with light, where light may change its colour: its direction in coordinates in which
// the facet is seen from above, whether it crossed, and what is left of it.
struct facet_event {
  vec3<Float> w;
  Mask passed;
  Unpolarized factor;
};

// Two words for the numbers of a walk, from whatever tells it from others.
struct walk_seed {
  UInt32 a = UInt32(0x9e3779b9U), b = UInt32(0x7f4a7c15U);

  template <class... Numbers>
  static walk_seed of(const Numbers&... numbers) {
    walk_seed seed;
    (seed.add(bits_of(numbers)), ...);
    return seed;
  }

 private:
  void add(const UInt32& word) { std::tie(a, b) = mi::sample_tea_32<UInt32>(a ^ word, b, 3); }
};

// `Facets` says what facets do:
//   scatter(back, m, below, xi)      a facet_event
//   phase(back, side, below, sigma)  what they send from `back`, which sees the area `sigma`, to `side`,
//                                    per steradian
template <class Facets>
class facet_walk {
 public:
  facet_walk(const distribution& normals, const roughness& r, const Facets& facets, const walk_seed& seed)
      : normals_(normals), roughness_(r), facets_(facets), seed_(seed) {}

  // Where light from wi leaves, in coordinates in which wi is above, what is left of it, and whether it met
  // one facet alone.
  struct end_of_walk {
    vec3<Float> wo;
    Unpolarized left;
    Mask once;
  };
  end_of_walk sample(const vec3<Float>& wi, const Mask& active) const {
    const state end = run(start(wi, active), [](state&, const vec3<Float>&, const Float&) {});
    const Float turned = select(end.below, Float(-1), Float(1));
    // The step on which it leaves counts, too.
    return {scaled(local(end.w), turned), end.throughput & (end.depth < Float(0)) & active,
            end.met == UInt32(2)};
  }

  // f |cos wo| of the second order and above, by one walk.
  Unpolarized rest(const vec3<Float>& wi, const vec3<Float>& wo, const Mask& active) const {
    const auto leaves_below = wo.z < Float(0);
    const vec3<Float> out = scaled(wo, select(leaves_below, Float(-1), Float(1)));
    const walk_target<Float> target{out, normals_.sigma(roughness_, scaled(out, Float(-1)))};
    const auto send = [&](state& s, const vec3<Float>& back, const Float& sigma) {
      const auto crosses = leaves_below ^ s.below;
      const Unpolarized part = s.throughput * facets_.phase(back, target.seen_from(crosses), s.below, sigma) *
                               target.reached_from(s.depth, crosses);
      s.sum += part & (s.alive & (s.met > UInt32(0)));
    };
    const state end = run(start(wi, active), send);
    return end.sum & active;
  }

 private:
  struct state {
    Vector3 w;
    Float depth;
    Mask below, alive;
    Unpolarized throughput, sum;
    UInt32 met;
    DRJIT_STRUCT(state, w, depth, below, alive, throughput, sum, met)
  };

  static state start(const vec3<Float>& wi, const Mask& active) {
    state s = dr::zeros<state>(dr::width(wi.x, active));
    s.w = -local(wi), s.alive = active, s.throughput = Unpolarized(1.F);
    return s;
  }

  template <class Send>
  state run(const state& first, const Send& send) const {
    const auto end = dr::while_loop(
        dr::make_tuple(first), [](const state& s) { return s.alive; },
        [this, &send](state& s) { step(s, send); }, "Random walk among facets");
    return dr::get<0>(end);
  }

  std::array<Float, 8> uniforms(const UInt32& met) const {
    std::array<Float, 8> xi;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const auto [a, b] = mi::sample_tea_32<UInt32>(seed_.a + met * 4U + k, seed_.b, 6);
      xi[2 * k] = uniform_of_word(a), xi[2 * k + 1] = uniform_of_word(b);
    }
    return xi;
  }

  template <class Send>
  void step(state& s, const Send& send) const {
    const std::array<Float, 8> xi = uniforms(s.met);
    const vec3<Float> back = scaled(local(s.w), Float(-1));
    const Float sigma = normals_.sigma(roughness_, back);
    s.depth = select(s.alive, depth_after(s.depth, Float(s.w.z()), sigma, xi[0]), s.depth);
    s.alive &= s.depth >= Float(0);  // also where it is nan
    send(s, back, sigma);
    const vec3<Float> m = normals_.sample_visible(roughness_, back, {xi[1], xi[2], xi[3], xi[4]});
    const facet_event e = facets_.scatter(back, m, s.below, xi[5]);
    const Unpolarized throughput = s.throughput * e.factor;
    const light_behind<Float> light =
        behind_facet(e.w, e.passed, s.depth, Float(dr::max(throughput)), Float(s.met), xi[6]);
    s.w = dr::select(s.alive, local(light.w), s.w);
    s.depth = select(s.alive, light.depth, s.depth);
    s.below = s.below ^ (e.passed & s.alive);
    s.throughput = dr::select(s.alive, throughput * Unpolarized(light.factor), s.throughput);
    s.alive &= dr::max(s.throughput) > Float(0);
    s.met += 1U;
  }

  const distribution& normals_;
  roughness roughness_;
  const Facets& facets_;
  walk_seed seed_;
};

}  // namespace microfacet::plugin
