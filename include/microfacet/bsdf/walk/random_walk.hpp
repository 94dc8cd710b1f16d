// Scattering of all orders, by the steps of walk/step.hpp.
//
// Many walks go side by side, one step of all of them at a time, and those that have left make room: the
// functions of the distribution see full arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "microfacet/bsdf/scattered.hpp"
#include "microfacet/bsdf/walk/rays.hpp"
#include "microfacet/bsdf/walk/step.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// Lanes: a number, or a pack of them. Distribution: functions on arrays, of which it may take `size` elements
// for valid:
//   sigma(size, w, out)
//   D(size, m, out)
//   visible(size, w, xi, out)   normals that w sees, by four arrays of uniform numbers
template <class Lanes, class Distribution, template <class> class Material>
class random_walk {
  using T = lane_of<Lanes>;
  using material = Material<Lanes>;

 public:
  explicit random_walk(const Distribution& distribution) : distribution_(distribution) {}

  // Where light goes, what is left of it, and how many facets it met.
  void sample(const walk_task<T>& t, block3<T>& wo, block<T>& weight, block<T>& order) {
    rays_.start(t, 0);
    for (long met = 0; rays_.alive > 0; ++met) {
      fly(met);
      leave([&](int ray) {
        const std::size_t i = rays_.index(ray), slot = rays_.index(rays_.slot(ray));
        const T turned = rays_.below[i] != T(0) ? T(-1) : T(1);
        wo.x[slot] = turned * rays_.w.x[i], wo.y[slot] = turned * rays_.w.y[i];
        wo.z[slot] = turned * rays_.w.z[i], order[slot] = static_cast<T>(met);
        weight[slot] = rays_.depth[i] == rays_.depth[i] ? rays_.throughput[i] : rays_.depth[i];
      });
      meet(met, [] {});
    }
  }

  // Adds to `sum` what one walk says of f |cos wo|, of the orders from first to last.
  void evaluate(const walk_task<T>& t, const block3<T>& wo, std::uint64_t walk, long first, long last,
                block<T>& sum) {
    rays_.start(t, walk);
    aim(t, wo);
    for (long met = 0; rays_.alive > 0 && met < last; ++met) {
      fly(met);
      leave([](int) {});
      meet(met, [&] {
        if (met + 1 >= first) send(sum);
      });
    }
  }

 private:
  static constexpr int step = width<Lanes>;
  static Lanes at(const block<T>& a, int i) { return load<Lanes>(a.data() + i); }
  static void put(const Lanes& x, block<T>& a, int i) { store(x, a.data() + i); }
  static vec3<Lanes> at(const block3<T>& a, int i) { return {at(a.x, i), at(a.y, i), at(a.z, i)}; }
  static void put(const vec3<Lanes>& v, block3<T>& a, int i) {
    put(v.x, a.x, i), put(v.y, a.y, i), put(v.z, a.z, i);
  }
  // The material as light on this side of it meets it.
  material material_at(int i) const {
    const std::array<Lanes, 2> p{at(rays_.parameter(0), i), at(rays_.parameter(1), i)};
    const material above(p.data());
    if constexpr (material::transmits) {
      return above.flipped(at(rays_.below, i) != Lanes(0));
    } else {
      return above;
    }
  }

  void fly(long met) {
    rays_.draw(met);
    for (int i = 0; i < rays_.padded; i += step) put(scaled(at(rays_.w, i), Lanes(-1)), rays_.back, i);
    distribution_.sigma(rays_.padded, rays_.back, rays_.sigma);
    for (int i = 0; i < rays_.padded; i += step)
      put(depth_after(at(rays_.depth, i), at(rays_.w.z, i), at(rays_.sigma, i), at(rays_.xi[0], i)),
          rays_.depth, i);
  }
  // Those that have left, were stopped, or are nan.
  template <class Report>
  void leave(const Report& report) {
    rays_.keep(
        [&](int ray) {
          const std::size_t i = rays_.index(ray);
          return rays_.depth[i] >= T(0) && rays_.throughput[i] > T(0);
        },
        report);
  }

  template <class Before>
  void meet(long met, const Before& before) {
    if (rays_.alive == 0) return;
    distribution_.visible(rays_.padded, rays_.back, &rays_.xi[1], facet_);
    before();
    for (int i = 0; i < rays_.padded; i += step) scatter(i, met);
  }
  void scatter(int i, long met) {
    const scattered<Lanes> s =
        material_at(i).scatter(at(rays_.back, i), at(facet_, i), at(rays_.xi[5], i), at(rays_.xi[6], i));
    const Lanes throughput = at(rays_.throughput, i) * s.weight, below = at(rays_.below, i);
    const light_behind<Lanes> light = behind_facet(s.w, s.passed, at(rays_.depth, i), throughput,
                                                   Lanes(static_cast<T>(met)), at(rays_.xi[7], i));
    put(light.w, rays_.w, i), put(light.depth, rays_.depth, i);
    put(select(s.passed, Lanes(Lanes(1) - below), below), rays_.below, i);
    put(Lanes(throughput * light.factor), rays_.throughput, i);
  }

  // Directions out as the side on which they leave names them, and the areas in their way.
  void aim(const walk_task<T>& t, const block3<T>& wo) {
    for (int k = 0; k < rays_.padded; ++k) {
      const std::size_t i = rays_.index(k), from = rays_.index(rays_.slot(k));
      const T turned = wo.z[from] > 0 ? T(1) : T(-1);
      out_.x[i] = turned * wo.x[from], out_.y[i] = turned * wo.y[from], out_.z[i] = turned * wo.z[from];
      leaves_below_[i] = turned > 0 ? T(0) : T(1);
      side_.x[i] = -out_.x[i], side_.y[i] = -out_.y[i], side_.z[i] = -out_.z[i];
    }
    if (t.count > 0) distribution_.sigma(rays_.padded, side_, sigma_out_);
  }
  // What the facets that light has met send to its target.
  void send(block<T>& sum) {
    for (int k = 0; k < rays_.padded; ++k) {
      const std::size_t i = rays_.index(k), slot = rays_.index(rays_.slot(k));
      crosses_[i] = leaves_below_[slot] != rays_.below[i] ? T(1) : T(0);
      target_.x[i] = out_.x[slot], target_.y[i] = out_.y[slot], target_.z[i] = out_.z[slot];
      sigma_of_target_[i] = sigma_out_[slot];
    }
    if constexpr (material::closed) {
      for (int i = 0; i < rays_.padded; i += step)
        put(material_at(i).half_vector(at(rays_.back, i), side(i)).m, side_, i);
      distribution_.D(rays_.padded, side_, D_);
    }
    block<T> part;
    for (int i = 0; i < rays_.padded; i += step)
      put(at(rays_.throughput, i) * phase(i) * target(i).reached_from(at(rays_.depth, i), crosses(i)), part,
          i);
    for (int k = 0; k < rays_.alive; ++k) sum[rays_.index(rays_.slot(k))] += part[rays_.index(k)];
  }
  walk_target<Lanes> target(int i) const { return {at(target_, i), at(sigma_of_target_, i)}; }
  auto crosses(int i) const { return at(crosses_, i) != Lanes(0); }
  vec3<Lanes> side(int i) const { return target(i).seen_from(crosses(i)); }
  Lanes phase(int i) const {
    const material here = material_at(i);
    const vec3<Lanes> back = at(rays_.back, i), towards = side(i);
    if constexpr (material::closed) {
      return here.phase(back, towards, here.half_vector(back, towards), at(D_, i),
                        Lanes(Lanes(1) / at(rays_.sigma, i)));
    } else {  // of the facet that was drawn
      return here.phase(towards, at(facet_, i));
    }
  }

  const Distribution& distribution_;
  walk_rays<T> rays_;
  block3<T> facet_{}, out_{}, target_{}, side_{};
  block<T> D_{}, sigma_out_{}, leaves_below_{}, crosses_{}, sigma_of_target_{};
};

}  // namespace microfacet
