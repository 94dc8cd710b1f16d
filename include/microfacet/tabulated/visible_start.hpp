// Where smith/visible/started.hpp starts for a density that is tables in float32: what is left of a slope when its
// leading behaviour is divided off, as a polynomial of the root of the depth, by pieces of the direction that end where
// the leading bits of 1 + X/scale change. Made from the tables themselves, without a solver: slopes give depths, and
// the slopes at the depths wanted lie between.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>
#include <type_traits>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/tabulated/visible_curves.hpp"

namespace microfacet {

class visible_start {
  static constexpr std::size_t pieces = 16, of_x = 3, of_depth = 10, terms = of_x * of_depth;
  // The roots of the largest depths; where a slope leans away 1 - xi is 2^-24 at least.
  static constexpr double deepest = 6, deepest_lower = 4.1;
  static constexpr float farthest = 8192 - 0x1p-11F;  // of 1 + X/scale

 public:
  int steps = 0;  // that end within the rounding of float32; 0 where the start is too far
  float peak{}, inverse_peak{}, excess_at_0{};

  // From P2, slope_sf and mean_excess at numbers.
  template <class Functions>
  void build(const Functions& f);

  template <class T, class Mask>
  MICROFACET_INLINE T above(const visible_depth<T, Mask>& at, const T& parabola) const {
    const place<T> here(at, *this);
    const T p = value<2 * pieces>(above_, here, shifted(here.piece, at.lower));
    const T grown = expm1(select(at.lower, T(-at.depth * p), p));
    // Far from the density a slope that leans away no longer depends on X.
    const T X = minimum(at.X, T((farthest - 1) / per_scale_));
    return select(at.lower, T(-X * grown), multiply_add(parabola, grown, parabola));
  }
  template <class T, class Mask>
  MICROFACET_INLINE T below(const visible_depth<T, Mask>& at, const T& excess_over_density) const {
    const place<T> here(at, *this);
    return at.root * sqrt(T(2) * excess_over_density) * exp(value<pieces>(below_, here, here.piece));
  }

 private:
  template <class T>
  struct place {
    elementary::integers<T> piece;
    T x, depth;  // both in [-1, 1]

    template <class Mask>
    MICROFACET_INLINE place(const visible_depth<T, Mask>& at, const visible_start& s) {
      using integers = elementary::integers<T>;
      using elementary::bits;
      using elementary::from_bits;
      const T y = minimum(multiply_add(at.X, T(s.per_scale_), T(1)), T(farthest));
      const integers above_one = elementary::wrapping_difference(integers(bits(y)), integers(one));
      // Half octaves up to 8, then whole ones.
      const auto in_halves = y < T(8);
      const auto fraction = [&](int width) {
        return from_bits(integers((above_one & integers((1 << width) - 1)) | integers(one)), y);
      };
      piece = chosen(in_halves, integers(above_one >> 22), integers((above_one >> 23) + integers(3)));
      x = select(in_halves, multiply_add(T(4), fraction(22), T(-5)), multiply_add(T(2), fraction(23), T(-3)));
      depth = multiply_add(minimum(at.root, select(at.lower, T(deepest_lower), T(deepest))),
                           select(at.lower, T(2 / deepest_lower), T(2 / deepest)), T(-1));
    }
  };
  static constexpr std::int32_t one = 0x3f800000;

  template <class Mask, class Integers>
  MICROFACET_INLINE static Integers chosen(const Mask& mask, const Integers& a, const Integers& b) {
    if constexpr (std::is_same_v<Mask, bool>) {
      return mask ? a : b;
    } else {
      return select(mask, a, b);
    }
  }
  // The second half of the rows belongs to slopes that lean away.
  template <class Integers, class Mask>
  MICROFACET_INLINE static Integers shifted(const Integers& piece, const Mask& lower) {
    return piece + chosen(lower, Integers(16), Integers(0));
  }
  template <std::size_t N, class Rows, class T>
  MICROFACET_INLINE static T value(const Rows& rows, const place<T>& at, const elementary::integers<T>& i) {
    T sum(0);
    for (std::size_t k = of_depth; k-- > 0;) {
      T row = lookup<N>(rows[of_x * k + of_x - 1], i);
      for (std::size_t j = of_x - 1; j-- > 0;)
        row = multiply_add(row, at.x, lookup<N>(rows[of_x * k + j], i));
      sum = multiply_add(sum, at.depth, row);
    }
    return sum;
  }

  alignas(64) std::array<std::array<float, 2 * pieces>, terms> above_{};
  std::array<std::array<float, pieces>, terms> below_{};
  float per_scale_{};
};

template <class Functions>
void visible_start::build(const Functions& f) {
  using curves = detail::visible_curves<Functions>;
  const double scale = 2 * f.mean_excess(0);
  peak = static_cast<float>(f.P2(0)), inverse_peak = 1 / peak, excess_at_0 = static_cast<float>(0.5 * scale);
  per_scale_ = static_cast<float>(1 / scale);
  steps = 0;
  if (!(peak > 1e-30F && peak < 1e30F)) return;
  const auto direction = [&](std::size_t piece, double u) {
    const double half = std::exp2(static_cast<double>(piece / 2)) * ((piece % 2 ? 1.5 : 1) + (u + 1) / 4),
                 whole = std::exp2(static_cast<double>(piece) - 3) * (1 + (u + 1) / 2),
                 y = piece < 6 ? half : whole;
    return curves(f, scale * (y - 1), scale);
  };
  double error = 0;
  curves farthest_seen = direction(0, -0.98);
  const bool below = farthest_seen.seen_from_below();
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto at_node = [&](std::size_t j) { return direction(piece, detail::chebyshev_node<of_x>(j)); };
    const std::array<curves, of_x> at{at_node(0), at_node(1), at_node(2)};
    // From where next to nothing is seen from below, it is seen as from the last direction that sees more.
    std::array<curves, of_x> under = at;
    for (std::size_t j = of_x; j-- > 0;) {  // away from the normal
      if (!at[j].complete()) return;
      if (at[j].seen_from_below()) farthest_seen = at[j];
      under[j] = farthest_seen;
    }
    const auto fill = [&](auto& rows, std::size_t column, const auto& seen, auto member, double most) {
      std::array<std::array<double, of_x>, of_depth> by_depth{};
      for (std::size_t j = 0; j < of_x; ++j) {
        std::array<double, of_depth> values{};
        for (std::size_t k = 0; k < of_depth; ++k)
          values[k] = (seen[j].*member)(square(0.5 * most * (detail::chebyshev_node<of_depth>(k) + 1)));
        const auto powers = detail::powers_at_nodes(values);
        for (std::size_t k = 0; k < of_depth; ++k) by_depth[k][j] = powers[k];
      }
      for (std::size_t k = 0; k < of_depth; ++k) {
        const auto powers = detail::powers_at_nodes(by_depth[k]);
        for (std::size_t j = 0; j < of_x; ++j) rows[of_x * k + j][column] = static_cast<float>(powers[j]);
      }
    };
    fill(above_, piece, at, &curves::upper, deepest);
    fill(above_, piece + pieces, at, &curves::lower, deepest_lower);
    if (below) fill(below_, piece, under, &curves::below, deepest);
    // Between the nodes and at the ends, as far as float32 has uniform numbers.
    for (const double u : {-0.98, -0.5, 0.5}) {
      const curves there = direction(piece, u);
      for (double L = 1e-3; L < 17; L = 1.4 * L + 0.2) {
        visible_depth<float, bool> depth{static_cast<float>(there.X()), static_cast<float>(L),
                                         static_cast<float>(std::sqrt(L)), false};
        const auto differs = [&](const auto& rows, const curves& c, auto member, auto weight) {
          const place<float> here(depth, *this);
          constexpr std::size_t n = std::tuple_size_v<typename std::decay_t<decltype(rows)>::value_type>;
          const auto p = static_cast<double>(
              value<n>(rows, here, n > pieces ? shifted(here.piece, depth.lower) : here.piece));
          error = (std::max)(error, std::abs(p - (c.*member)(L)) * (c.*weight)(L));
        };
        differs(above_, there, &curves::upper, &curves::weight_upper);
        if (below && there.seen_from_below()) differs(below_, there, &curves::below, &curves::weight_below);
        depth.lower = true;
        differs(above_, there, &curves::lower, &curves::weight_lower);
      }
    }
  }
  steps = error < 0.03 ? 1 : error < 0.15 ? 2 : 0;
}

}  // namespace microfacet
