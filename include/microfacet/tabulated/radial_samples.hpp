// What the tables of a density hold, as functions of logarithms, of a family in double precision.
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet::detail {

template <class Family>
class radial_samples {
  using R = typename Family::scalar;

 public:
  explicit radial_samples(const Family& family) : family_(family) {}

  R root_D(const R& L) const {
    const R r = elementary::exp(R(R(0.5) * L)), r2 = r * r;
    const auto inner = [&] {
      if constexpr (P22_by_slope<Family>) {
        return R(sqrt(family_.P22_of_slope(r)) * (R(1) + r2));
      } else {
        return R(sqrt(family_.P22(double_double<R>(r2))) * (R(1) + r2));
      }
    };
    // Beyond 1 through D at a small cosine, where it underflows much later.
    const R z(0x1p-32), z2 = z * z;
    const auto outer = [&] { return R(sqrt(family_.D(z, double_double<R>(r2 * z2))) * (z2 + r2 * z2)); };
    return select_lazy(r <= R(1), inner, outer);
  }
  R survival(const R& L) const { return family_.survival(square_of(elementary::exp(R(R(0.5) * L)))); }
  R root_P2(const R& L) const { return sqrt(family_.P2(slope<R>(elementary::exp(L)))); }
  R slope_sf(const R& L) const { return family_.slope_sf(slope<R>(elementary::exp(L))); }
  R mean_excess(const R& L) const { return family_.mean_excess(slope<R>(elementary::exp(R(R(0.5) * L)))); }

  R radius(const R& L) const {
    const R odds = elementary::exp(L);
    if constexpr (radius_by_odds<Family>) {
      return family_.radius_at_odds(odds);
    } else {
      const R xi = minimum(R(odds / (R(1) + odds)), R(1 - 0x1p-53));
      if constexpr (direct_radius<Family>) {
        return refined(family_.radius(xi), L, odds);
      } else {
        return refined(sqrt(family_.radius2(xi)), L, odds);
      }
    }
  }

 private:
  // Above the median xi = 1 - rest loses what rest has: Newton's method on log survival against log r^2.
  R refined(const R& start, const R& L, const R& odds) const {
    const auto refine = [&] {
      R M = R(2) * log(start);
      for (int i = 0; i < 4; ++i) {
        const double_double<R> r2 = square_of(elementary::exp(R(R(0.5) * M)));
        const R above = family_.survival(r2),
                change = log(above * (R(1) + odds)) * above / (R(pi) * r2.high * family_.P22(r2));
        M = M + minimum(maximum(change, R(-2)), R(2));
      }
      return R(elementary::exp(R(R(0.5) * M)));
    };
    return select_lazy((L > R(0)) & (start < R(1e100)), refine, [&] { return start; });
  }
  static double_double<R> square_of(const R& r) { return two_prod(r, r); }
  const Family& family_;
};

}  // namespace microfacet::detail
