// Roughness that varies, of a family of which it is no stretch: between tables of some roughnesses.
#pragma once

#include <drjit/math.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "drjit_scalar.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet::plugin {

namespace dr = drjit;

// Densities of a family whose roughness is no stretch, at equal distances of log alpha.
struct alpha_grid {
  static constexpr std::uint32_t nodes = 24;
  static constexpr float first = -6.9F, spacing = 0.3F, least = 1.1e-3F, most = 1;  // alpha
  static double alpha(std::uint32_t i) { return std::exp(double{first} + i * double{spacing}); }
};

// Where between four nodes of the grid roughness lies: the first of them and their weights, Lagrange's.
template <class R>
struct alpha_between {
  using UInt32 = dr::uint32_array_t<R>;
  R log_alpha;
  UInt32 first;
  std::array<R, 4> weight;

  explicit alpha_between(const R& alpha) : log_alpha(log(alpha)) {
    const R at = (log_alpha - R(alpha_grid::first)) * R(1 / alpha_grid::spacing);
    const R begin = minimum(maximum(R(floor(dr::detach(at)) - R(1)), R(0)), R(alpha_grid::nodes - 4));
    first = UInt32(begin);
    const R t = at - begin;
    weight = {(R(1) - t) * (R(2) - t) * (R(3) - t) * R(1.0 / 6), t * (R(2) - t) * (R(3) - t) * R(0.5),
              t * (t - R(1)) * (R(3) - t) * R(0.5), t * (t - R(1)) * (t - R(2)) * R(1.0 / 6)};
  }
  R log_of_node(std::uint32_t i) const {
    return R(alpha_grid::first) + (R(first) + R(static_cast<float>(i))) * R(alpha_grid::spacing);
  }
};

}  // namespace microfacet::plugin
