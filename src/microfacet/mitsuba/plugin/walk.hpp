// Scattering of all orders: the random walk of bsdf/walk/random_walk.hpp as one traced loop. Random numbers are
// functions of two words and of the number of facets met.
#pragma once

#include <drjit/while_loop.h>

#include <array>
#include <tuple>

#include "microfacet/bsdf/walk/random_walk.hpp"
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
//   phase(back, side, below, area)   what they send from `back`, which sees `area`, to `side`, per steradian
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
    // As the side on which light leaves names the direction, and the area in its way.
    const auto leaves_below = wo.z < Float(0);
    const vec3<Float> out = scaled(wo, select(leaves_below, Float(-1), Float(1)));
    const Float blocking = normals_.sigma(roughness_, scaled(out, Float(-1)));
    const auto send = [&](state& s, const vec3<Float>& back, const Float& area) {
      const auto crossed = leaves_below ^ s.below;
      const vec3<Float> side = scaled(out, select(crossed, Float(-1), Float(1)));
      const Float from = select(crossed, depth_from_below(s.depth), s.depth);
      const Unpolarized part =
          s.throughput * facets_.phase(back, side, s.below, area) * escape(from, out.z, blocking);
      s.sum += part & (s.alive & (s.met > UInt32(0)));
    };
    const state end = run(start(wi, active), send);
    return end.sum & active;
  }

 private:
  static constexpr std::uint32_t most_facets = 1024, first_roulette = 4;

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
    const Float area = normals_.sigma(roughness_, back);
    s.depth = select(s.alive, depth_after(s.depth, Float(s.w.z()), area, xi[0]), s.depth);
    s.alive &= s.depth >= Float(0);  // also where it is nan
    send(s, back, area);
    const vec3<Float> m = normals_.sample_visible(roughness_, back, {xi[1], xi[2], xi[3], xi[4]});
    const facet_event e = facets_.scatter(back, m, s.below, xi[5]);
    const auto passed = e.passed & s.alive;
    s.w = dr::select(s.alive, local(scaled(e.w, select(e.passed, Float(-1), Float(1)))), s.w);
    s.depth = select(passed, depth_from_below(s.depth), s.depth);
    s.below = s.below ^ passed;
    // Russian roulette as in bsdf/walk/random_walk.hpp; but after very many facets light is lost.
    const Unpolarized throughput = s.throughput * e.factor;
    const Float faint = minimum(maximum(Float(dr::max(throughput) * 4.F), Float(0.05F)), Float(1));
    const Float chance = select(s.met >= UInt32(first_roulette), faint, Float(1));
    const auto goes_on = (xi[6] < chance) & (s.met < UInt32(most_facets));
    s.throughput = dr::select(s.alive, throughput / Unpolarized(chance), s.throughput);
    const auto stopped = s.alive & !goes_on;
    s.throughput = dr::select(stopped, Unpolarized(0.F), s.throughput);
    s.alive &= goes_on;
    s.met += 1U;
  }

  const distribution& normals_;
  roughness roughness_;
  const Facets& facets_;
  walk_seed seed_;
};

}  // namespace microfacet::plugin
