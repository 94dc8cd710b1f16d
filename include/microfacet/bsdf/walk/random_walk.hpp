// Scattering of all orders: the random walk of light on a Smith microsurface, without approximation (Heitz,
// Hanika, d'Eon and Dachsbacher, Multiple-scattering microfacet BSDFs with the Smith model, 2016; d'Eon, A
// Hitchhiker's Guide to Multiple Scattering).
//
// With depth = -log of the share of heights below, Smith's surface is a half-space in which light towards w
// meets facets at the rate sigma(-w) per length and leaves upwards at depth 0; heights have the uniform
// distribution, on which nothing depends. Light that passes a facet goes on in coordinates that are turned
// over (w -> -w), in which the share of heights below is 1 minus what it was.
//
// Many walks go side by side, one step of all of them at a time, and those that have left make room: the
// functions of the distribution see full arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "microfacet/bsdf/scattered.hpp"
#include "microfacet/bsdf/walk/rays.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

// The depth after a flight, negative for light that has left. Optical lengths are exponential.
template <class T>
T depth_after(const T& depth, const T& w_z, const T& area, const T& xi) {
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T least(single ? 0x1p-25 : 0x1p-54);  // so that light that sees no facet leaves
  return depth + w_z * (log1p(T(-maximum(xi, least))) / maximum(area, smallest<T>()));
}
// The probability to leave towards w from a depth without meeting a facet; area = sigma(-w).
template <class T>
T escape(const T& depth, const T& w_z, const T& area) {
  return select(w_z > T(0), exp(-depth * area / maximum(w_z, smallest<T>())), T(0));
}
// The same place, in coordinates that are turned over.
template <class T>
T depth_from_below(const T& depth) {
  return -log(maximum(T(-expm1(-depth)), smallest<T>()));
}

// Lanes: a number, or a pack of them. Distribution: functions on arrays, of which it may take `size` elements
// for valid:
//   area(size, w, out)           sigma(w)
//   D(size, m, out)
//   visible(size, w, xi, out)    normals that w sees, by four arrays of uniform numbers
template <class Lanes, class Distribution, template <class> class Material>
class random_walk {
  using T = lane_of<Lanes>;
  using material = Material<Lanes>;
  static constexpr bool closed = requires(const material m, vec3<Lanes> w) { m.facet(w, w); };

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
    if constexpr (requires { above.flipped(Lanes(0) < Lanes(0)); }) {
      return above.flipped(at(rays_.below, i) != Lanes(0));
    } else {
      return above;
    }
  }

  void fly(long met) {
    rays_.draw(met);
    for (int i = 0; i < rays_.padded; i += step) put(scaled(at(rays_.w, i), Lanes(-1)), rays_.back, i);
    distribution_.area(rays_.padded, rays_.back, rays_.area);
    for (int i = 0; i < rays_.padded; i += step)
      put(depth_after(at(rays_.depth, i), at(rays_.w.z, i), at(rays_.area, i), at(rays_.xi[0], i)),
          rays_.depth, i);
  }
  // Those that have left, were stopped, or are nan.
  template <class Tell>
  void leave(const Tell& tell) {
    rays_.keep(
        [&](int ray) {
          const std::size_t i = rays_.index(ray);
          return rays_.depth[i] >= T(0) && rays_.throughput[i] > T(0);
        },
        tell);
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
    const Lanes depth = at(rays_.depth, i), below = at(rays_.below, i);
    put(scaled(s.w, select(s.passed, Lanes(-1), Lanes(1))), rays_.w, i);
    put(select(s.passed, depth_from_below(depth), depth), rays_.depth, i);
    put(select(s.passed, Lanes(Lanes(1) - below), below), rays_.below, i);
    // Russian roulette: faint light goes on seldom, with more weight; so does any, after very many facets.
    const Lanes throughput = at(rays_.throughput, i) * s.weight;
    Lanes chance(1);
    if (met >= 4) chance = minimum(maximum(Lanes(throughput * Lanes(4)), Lanes(0.05)), Lanes(1));
    if (met >= 1024) chance = Lanes(0.5);
    put(select(at(rays_.xi[7], i) < chance, Lanes(throughput / chance), Lanes(Lanes(0) * throughput)),
        rays_.throughput, i);
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
    if (t.count > 0) distribution_.area(rays_.padded, side_, blocking_);
  }
  // What the facets that light has met send to its target.
  void send(block<T>& sum) {
    block<T> crossed, z, blocking, part;
    for (int k = 0; k < rays_.padded; ++k) {
      const std::size_t i = rays_.index(k), slot = rays_.index(rays_.slot(k));
      crossed[i] = leaves_below_[slot] != rays_.below[i] ? T(1) : T(0);
      const T turned = crossed[i] != T(0) ? T(-1) : T(1);
      side_.x[i] = turned * out_.x[slot], side_.y[i] = turned * out_.y[slot];
      side_.z[i] = turned * out_.z[slot];
      z[i] = out_.z[slot], blocking[i] = blocking_[slot];
    }
    if constexpr (closed) {
      for (int i = 0; i < rays_.padded; i += step)
        put(material_at(i).facet(at(rays_.back, i), at(side_, i)), facet_to_target_, i);
      distribution_.D(rays_.padded, facet_to_target_, D_);
    }
    for (int i = 0; i < rays_.padded; i += step) {
      const Lanes depth = at(rays_.depth, i);
      const Lanes from = select(at(crossed, i) != Lanes(0), depth_from_below(depth), depth);
      put(at(rays_.throughput, i) * phase(i) * escape(from, at(z, i), at(blocking, i)), part, i);
    }
    for (int k = 0; k < rays_.alive; ++k) sum[rays_.index(rays_.slot(k))] += part[rays_.index(k)];
  }
  Lanes phase(int i) const {
    const material here = material_at(i);
    if constexpr (closed) {
      return here.phase(at(rays_.back, i), at(side_, i), at(facet_to_target_, i),
                        {at(D_, i), at(rays_.area, i), Lanes(0)});
    } else {  // of the facet that was drawn
      return here.phase(at(side_, i), at(facet_, i));
    }
  }

  const Distribution& distribution_;
  walk_rays<T> rays_;
  block3<T> facet_{}, facet_to_target_{}, out_{}, side_{};
  block<T> D_{}, blocking_{}, leaves_below_{};
};

}  // namespace microfacet
