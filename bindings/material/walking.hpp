// Random walks of blocks of elements.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "bindings/loop/lanes.hpp"
#include "bindings/material/distribution.hpp"
#include "microfacet/bsdf/walk/random_walk.hpp"

namespace microfacet::bindings {

// A number that is none of the whole ones that a double holds counts as 0.
inline std::uint64_t whole(double x) { return x >= 0 && x < 0x1p53 ? static_cast<std::uint64_t>(x) : 0; }

template <template <class> class Material, class Real>
walk_task<Real> task_of(const material_blocks<Real>& b, std::size_t material) {
  walk_task<Real> t;
  t.count = b.count, t.wi = b.template directions<lanes<Real>>(0), t.seed = whole(b.constant[0]);
  for (std::size_t k = 0; k < 2; ++k)
    std::copy_n(b.in[material + std::min(k, std::size_t{Material<Real>::parameters - 1})], b.padded,
                t.parameters[k].begin());
  for (std::size_t i = 0; i < walk_block; ++i) t.element[i] = whole(b.element[i]);
  return t;
}
template <template <class> class Material, class Real>
using walks = random_walk<lanes<Real>, array_distribution<Real>, Material>;

// What a walk from wi gives, and 1/eta^2 of radiance that ends on the other side; nothing from below an
// opaque surface.
template <template <class> class Material, class Real>
Real factor_of_walk(const material_blocks<Real>& b, std::size_t material, std::size_t i, Real wo_z,
                    bool radiance) {
  const Real wi_z = b.in[2][i];
  if constexpr (Material<Real>::transmits) {
    if (radiance && wi_z * wo_z < 0) {
      const Real eta = b.in[material][i], relative = wi_z > 0 ? 1 / eta : eta;
      return std::min(relative * relative, std::numeric_limits<Real>::max());
    }
    return wi_z == 0 || wo_z == 0 ? Real(0) : Real(1);
  } else {
    return wi_z > 0 && wo_z > 0 ? Real(1) : Real(0);
  }
}

// wi, material | element | seed, radiance
template <template <class> class Material, class Real>
void walk_sample(const array_distribution<Real>& d, material_blocks<Real>& b) {
  const auto walk = std::make_unique<walks<Material, Real>>(d);
  block3<Real> wo{};
  block<Real> weight, order;
  while (b.next()) {
    walk->sample(task_of<Material>(b, 3), wo, weight, order);
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
      const Real factor =
          factor_of_walk<Material>(b, 3, i, wo.z[i], b.constant[1] != 0);  // results may be arguments
      b.out[0][i] = wo.x[i], b.out[1][i] = wo.y[i], b.out[2][i] = wo.z[i];
      b.out[3][i] = weight[i] * factor, b.out[4][i] = order[i];
    }
  }
}
// wi, wo, material | element | seed, radiance, number of walks, first and last order
template <template <class> class Material, class Real>
void walk_eval(const array_distribution<Real>& d, material_blocks<Real>& b) {
  const auto walk = std::make_unique<walks<Material, Real>>(d);
  const std::uint64_t number = whole(b.constant[2]);
  const auto first = static_cast<long>(whole(b.constant[3])), last = static_cast<long>(whole(b.constant[4]));
  while (b.next()) {
    const walk_task<Real> task = task_of<Material>(b, 6);
    const block3<Real> wo = b.template directions<lanes<Real>>(3);
    block<Real> sum{};
    for (std::uint64_t k = 0; k < number; ++k) walk->evaluate(task, wo, k, first, last, sum);
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
      // nan of a direction that is none; of a material that is none the sum is nan.
      const Real invalid =
          Real(0) * (task.wi.x[i] + task.wi.y[i] + task.wi.z[i] + wo.x[i] + wo.y[i] + wo.z[i]);
      const Real factor = factor_of_walk<Material>(b, 6, i, wo.z[i], b.constant[1] != 0);
      b.out[0][i] = (factor == 0 ? Real(0) : sum[i] / static_cast<Real>(number) * factor) + invalid;
    }
  }
}

}  // namespace microfacet::bindings
