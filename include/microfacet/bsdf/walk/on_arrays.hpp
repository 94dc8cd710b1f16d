// A distribution on arrays, as random_walk asks for it, from one on numbers or packs.
#pragma once

#include "microfacet/bsdf/walk/rays.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"

namespace microfacet {

// `Distribution` is an ndf on Lanes, which must outlive this.
template <class Lanes, class Distribution>
class on_arrays {
  using T = lane_of<Lanes>;

 public:
  explicit on_arrays(const Distribution& ndf) : ndf_(ndf) {}

  void sigma(int size, const block3<T>& w, block<T>& out) const {
    for (int i = 0; i < size; i += width<Lanes>) store(ndf_.sigma(at(w, i)), out.data() + i);
  }
  void D(int size, const block3<T>& m, block<T>& out) const {
    for (int i = 0; i < size; i += width<Lanes>) store(ndf_.D(at(m, i)), out.data() + i);
  }
  void visible(int size, const block3<T>& w, const block<T>* xi, block3<T>& m) const {
    for (int i = 0; i < size; i += width<Lanes>) {
      const auto u = [&](int k) { return load<Lanes>(xi[k].data() + i); };
      const vec3<Lanes> normal = sample_visible_mixture(ndf_, at(w, i), u(0), u(1), u(2), u(3));
      store(normal.x, m.x.data() + i), store(normal.y, m.y.data() + i), store(normal.z, m.z.data() + i);
    }
  }

 private:
  static vec3<Lanes> at(const block3<T>& v, int i) {
    return {load<Lanes>(v.x.data() + i), load<Lanes>(v.y.data() + i), load<Lanes>(v.z.data() + i)};
  }

  const Distribution& ndf_;
};

}  // namespace microfacet
