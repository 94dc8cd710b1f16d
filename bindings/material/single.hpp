// Single scattering of blocks of elements, fused: one pass from directions to results, by the assembly of
// bsdf/scattering_pair.hpp. Only visible normals are drawn on arrays before, by the kernels of
// sample_visible.
#pragma once

#include <array>
#include <cstddef>

#include "bindings/loop/lanes.hpp"
#include "bindings/material/distribution.hpp"
#include "microfacet/bsdf/single_scattering.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"

namespace microfacet::bindings {

template <class Distribution>
inline constexpr bool has_bounded_scheme = false;
template <class Family, class T, class Shape>
inline constexpr bool has_bounded_scheme<ndf<Family, T, Shape>> = bounded_facet_sampling<Family>;

// `Source` makes the distribution of an array_distribution.
template <template <class> class Material, class Source, class Real>
struct single_scattering {
  using L = lanes<Real>;
  using material = Material<L>;
  using pair = scattering_pair<material, L>;
  using blocks = material_blocks<Real>;
  using distribution = typename Source::distribution;

  // wi, wo, material | correlated, radiance
  [[gnu::flatten]] static void eval(const array_distribution<Real>& d, blocks& b) {
    const distribution ndf = Source::of(d);
    const bool correlated = b.constant[0] != 0, radiance = b.constant[1] != 0;
    while (b.next()) {
      const materials made(b, 6);
      for (int i = 0; i < b.padded; i += width<L>) {
        const pair given(made[i], wi(b, i), b.template direction<L>(3, i));
        write(given.eval(ndf, correlated, radiance), b, 0, i);
      }
    }
  }
  // wi, wo, material | bounded
  [[gnu::flatten]] static void pdf(const array_distribution<Real>& d, blocks& b) {
    const distribution ndf = Source::of(d);
    const bool bounded = b.constant[0] != 0 && d.has(quantity::visible_bounded);
    while (b.next()) {
      const materials made(b, 6);
      for (int i = 0; i < b.padded; i += width<L>) {
        const vec3<L> from = wi(b, i), wo = b.template direction<L>(3, i);
        write(bounded ? bounded_density(ndf, from, wo) : pair(made[i], from, wo).pdf(ndf), b, 0, i);
      }
    }
  }
  // wi, xi (4), material | correlated, radiance, bounded
  [[gnu::flatten]] static void sample(const array_distribution<Real>& d, blocks& b) {
    const distribution ndf = Source::of(d);
    const bool correlated = b.constant[0] != 0, radiance = b.constant[1] != 0,
               bounded = b.constant[2] != 0 && d.has(quantity::visible_bounded);
    const kept_numbers<L> kept(b.narrow_results);
    block3<Real> above, m;
    while (b.next()) {
      const materials made(b, 7);
      for (int i = 0; i < b.padded; i += width<L>) put(pair(made[i], wi(b, i), wi(b, i)).wi(), above, i);
      d.draw(bounded ? quantity::visible_bounded : quantity::visible, b.padded, above,
             {b.in[3], b.in[4], b.in[5], b.in[6]}, m);
      for (int i = 0; i < b.padded; i += width<L>) {
        drawn_direction<L> r = sample_at(made[i], ndf, wi(b, i), at<L>(m, i), b.template at<L>(6, i),
                                         correlated, radiance, kept);
        if (bounded) {
          const L density = bounded_density(ndf, wi(b, i), r.wo);
          r.weight = select(density > L(0), L(r.weight * (r.pdf / density)), L(L(0) * r.weight));
          r.pdf = density;
        }
        write(r.wo.x, b, 0, i), write(r.wo.y, b, 1, i), write(r.wo.z, b, 2, i), write(r.weight, b, 3, i);
        write(r.pdf, b, 4, i);
      }
    }
  }
  // wi, m, material | correlated: what the facets m send on their way and out, of light from wi, per
  // steradian of normals: mirrored, and passed.
  [[gnu::flatten]] static void facets(const array_distribution<Real>& d, blocks& b) {
    const distribution ndf = Source::of(d);
    const bool correlated = b.constant[0] != 0;
    while (b.next()) {
      const materials made(b, 6);
      for (int i = 0; i < b.padded; i += width<L>) {
        const vec3<L> m = b.template direction<L>(3, i);
        const pair given(made[i], wi(b, i), wi(b, i));
        const L D = ndf.D(m), inverse = inverse_sigma(ndf, given.wi());
        const auto part = [&](const pair& drawn) {
          return drawn.of_facet(m, {D, inverse, sigma_out(ndf, drawn.wo())}, correlated);
        };
        write(part(given.drawn(m, L(0))), b, 0, i);
        L passed(0);
        if constexpr (material::transmits) {
          // Beyond the critical angle nothing passes.
          const pair drawn = given.drawn(m, L(1));
          passed = select(drawn.passed() > L(0), part(drawn), L(L(0) * drawn.passed()));
        }
        write(passed, b, 1, i);
      }
    }
  }

  static constexpr std::array<material_kernel<Real>, static_cast<std::size_t>(event::count)> kernels{
      &eval, &pdf, &sample, &facets};

 private:
  // The material of each element, whose parameters start at value k; one of them, where it is the same for
  // all.
  class materials {
   public:
    materials(const blocks& b, std::size_t k) : b_(b), k_(k), first_(made(0)) {}
    material operator[](int i) const { return b_.one_material ? first_ : made(i); }

   private:
    material made(int i) const {
      const std::array<L, 2> p{b_.template at<L>(k_, i), b_.template at<L>(k_ + material::parameters - 1, i)};
      return material(p.data());
    }
    const blocks& b_;
    std::size_t k_;
    material first_;
  };
  static vec3<L> wi(const blocks& b, int i) { return b.template direction<L>(0, i); }
  static void write(const L& x, const blocks& b, std::size_t k, int i) { store(x, b.out[k] + i); }
  // Of the bounded scheme of a family that has one, for a metal.
  static L bounded_density(const distribution& ndf, const vec3<L>& wi, const vec3<L>& wo) {
    if constexpr (!material::transmits && has_bounded_scheme<distribution>) {
      const half_vector<L> half = half_vector_reflection(wi, wo);
      const L density = pdf_visible_bounded(ndf, half.m, wi);
      return select((half.cosine > L(0)) & (wi.z > L(0)), L(density * (L(0.25) / half.cosine)),
                    L(L(0) * density));
    } else {
      return wi.z;
    }
  }
};

template <class Source, class Real>
inline constexpr fused_kernels<Real> fused_kernels_of{single_scattering<conductor, Source, Real>::kernels,
                                                      single_scattering<dielectric, Source, Real>::kernels};

// The distribution itself; a copy, which no store to an array can change.
template <class Distribution>
struct known_distribution {
  using distribution = Distribution;
  template <class Real>
  static Distribution of(const array_distribution<Real>& d) {
    return *static_cast<const Distribution*>(d.fused_distribution);
  }
};

}  // namespace microfacet::bindings
