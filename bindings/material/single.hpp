// Single scattering of blocks of elements.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "bindings/loop/lanes.hpp"
#include "bindings/material/block.hpp"
#include "microfacet/bsdf/single_scattering.hpp"

namespace microfacet::bindings {

// Single scattering, in steps of all elements.
template <template <class> class Material, class Real>
class single_step {
  using L = lanes<Real>;
  using pair = scattering_pair<Material<L>, L>;

 public:
  single_step(const array_distribution<Real>& distribution, material_block<Real>& block)
      : d_(distribution), b_(block) {}

  // wi, wo, material | correlated, radiance
  [[gnu::flatten]] void eval() {
    each([&](int i) {
      const pair p = given(i);
      put(p.wi(), wi_, i), put(p.blocking(), blocking_, i), put(p.facet(), m_, i);
    });
    look();
    d_.area(b_.padded, blocking_, blocked_);
    each([&](int i) {
      put(given(i).eval(at<L>(m_, i), statistics(i), correlated(), radiance()), b_.out[0], i);
    });
  }
  // wi, wo, material | bounded
  [[gnu::flatten]] void pdf() {
    each([&](int i) {
      const pair p = given(i);
      put(p.wi(), wi_, i), put(p.mirror(), m_, i);
      if constexpr (transmits) put(p.lens(), other_, i);
    });
    look();
    if (transmits) d_.D(b_.padded, other_, D_of_other_);
    if (b_.constant[0] != 0 && d_.has(quantity::pdf_bounded)) {
      d_.pdf_bounded(b_.padded, m_, wi_, D_);
      each([&](int i) { put(bounded_density(at<L>(wi_, i), at<L>(m_, i), at<L>(D_, i)), b_.out[0], i); });
      return;
    }
    each([&](int i) {
      put(given(i).pdf(at<L>(m_, i), at<L>(D_, i), at<L>(other_, i), at<L>(D_of_other_, i), at<L>(area_, i)),
          b_.out[0], i);
    });
  }
  // wi, xi (4), material | correlated, radiance, bounded
  [[gnu::flatten]] void sample() {
    each([&](int i) { put(pair(material(7, i), wi(i), wi(i)).wi(), wi_, i); });
    const bool bounded = b_.constant[2] != 0 && d_.has(quantity::visible_bounded);
    d_.draw(bounded ? quantity::visible_bounded : quantity::visible, b_.padded, wi_, &b_.in[3], m_);
    each([&](int i) {
      const pair p = pair::drawn(material(7, i), wi(i), at<L>(m_, i), b_.template at<L>(6, i));
      put(p.wo(), wo_, i), put(p.passed(), passed_, i);
    });
    if (b_.narrow_results)
      for (auto* part : {&wo_.x, &wo_.y, &wo_.z})
        for (Real& x : *part) x = static_cast<Real>(static_cast<float>(x));
    d_.area(b_.padded, wi_, area_);
    finish(bounded);
    using limits = std::numeric_limits<float>;
    const Real largest = b_.narrow_results ? Real(limits::max()) : std::numeric_limits<Real>::max(),
               rounding = b_.narrow_results ? Real(limits::epsilon()) : std::numeric_limits<Real>::epsilon();
    if (std::none_of(b_.out[4].begin(), b_.out[4].begin() + b_.padded,
                     [&](Real pdf) { return pdf > largest; }))
      return;
    each([&](int i) {
      put(beside_peak(material(7, i), at<L>(wo_, i), at<L>(b_.out[4], i), L(largest), L(rounding)), wo_, i);
    });
    finish(bounded);
  }
  // wi, m, material | correlated: what the facets m send on their way and out, of light from wi, per
  // steradian of normals: mirrored, and passed.
  [[gnu::flatten]] void facets() {
    each([&](int i) {
      put(pair(material(6, i), wi(i), wi(i)).wi(), wi_, i);
      put(b_.template direction<L>(3, i), m_, i);
      put(through(i, L(0)).blocking(), blocking_, i), put(through(i, L(1)).blocking(), other_, i);
    });
    look();
    d_.area(b_.padded, blocking_, blocked_), d_.area(b_.padded, other_, pdf_bounded_);
    each([&](int i) {
      const auto part = [&](const L& xi, const block<Real>& blocked) {
        return through(i, xi).of_facet(at<L>(m_, i), {at<L>(D_, i), at<L>(area_, i), at<L>(blocked, i)},
                                       correlated());
      };
      put(part(L(0), blocked_), b_.out[0], i);
      // Beyond the critical angle nothing passes.
      const L crosses = through(i, L(1)).passed();
      put(select(crosses > L(0), part(L(1), pdf_bounded_), L(L(0) * crosses)), b_.out[1], i);
    });
  }

 private:
  static constexpr bool transmits = requires(const Material<L> m) { m.eta(); };
  using draw = typename pair::draw;

  // From the directions that were drawn: what the distribution says of the facets between them and wi.
  void finish(bool bounded) {
    each([&](int i) {
      const pair p = drawn(i);
      put(p.blocking(), blocking_, i), put(p.mirror(), m_, i);
      if constexpr (transmits) put(p.lens(), other_, i);
    });
    d_.D(b_.padded, m_, D_), d_.area(b_.padded, blocking_, blocked_);
    if (transmits) d_.D(b_.padded, other_, D_of_other_);
    if (bounded) d_.pdf_bounded(b_.padded, m_, wi_, pdf_bounded_);
    each([&](int i) { finish(i, bounded); });
  }
  void finish(int i, bool bounded) {
    draw r = drawn(i).result(at<L>(passed_, i), at<L>(m_, i), statistics(i), at<L>(other_, i),
                             at<L>(D_of_other_, i), correlated(), radiance());
    if (bounded) {
      const L density = bounded_density(at<L>(wi_, i), at<L>(m_, i), at<L>(pdf_bounded_, i));
      r.weight = select(density > L(0), L(r.weight * (r.pdf / density)), L(L(0) * r.weight)), r.pdf = density;
    }
    put(r.wo.x, b_.out[0], i), put(r.wo.y, b_.out[1], i), put(r.wo.z, b_.out[2], i);
    put(r.weight, b_.out[3], i), put(r.pdf, b_.out[4], i);
  }
  static L bounded_density(const vec3<L>& wi, const vec3<L>& m, const L& density) {
    const L cosine = dot(wi, m);
    return select((cosine > L(0)) & (wi.z > L(0)), L(density * reflection_jacobian(wi, m)),
                  L(L(0) * density));
  }

  template <class Function>
  void each(const Function& function) const {
    for (int i = 0; i < b_.padded; i += width<L>) function(i);
  }
  void look() { d_.D(b_.padded, m_, D_), d_.area(b_.padded, wi_, area_); }
  bool correlated() const { return b_.constant[0] != 0; }
  bool radiance() const { return b_.constant[1] != 0; }
  vec3<L> wi(int i) const { return b_.template direction<L>(0, i); }
  Material<L> material(std::size_t k, int i) const {
    const std::array<L, 2> p{b_.template at<L>(k, i), b_.template at<L>(k + Material<L>::parameters - 1, i)};
    return Material<L>(p.data());
  }
  pair given(int i) const { return pair(material(6, i), wi(i), b_.template direction<L>(3, i)); }
  pair drawn(int i) const { return pair(material(7, i), wi(i), at<L>(wo_, i)); }
  pair through(int i, const L& xi) const { return pair::drawn(material(6, i), wi(i), at<L>(m_, i), xi); }
  facet_statistics<L> statistics(int i) const { return {at<L>(D_, i), at<L>(area_, i), at<L>(blocked_, i)}; }

  const array_distribution<Real>& d_;
  material_block<Real>& b_;
  block3<Real> wi_, wo_, m_, other_{}, blocking_;
  block<Real> passed_, D_, D_of_other_{}, area_, blocked_, pdf_bounded_;
};

template <template <class> class Material, class Real>
void single_eval(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).eval();
}
template <template <class> class Material, class Real>
void single_pdf(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).pdf();
}
template <template <class> class Material, class Real>
void single_sample(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).sample();
}
template <template <class> class Material, class Real>
void single_facets(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).facets();
}

}  // namespace microfacet::bindings
