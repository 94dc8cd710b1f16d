// What smith/visible/inversion.hpp takes from a family at one slope: from tables every function is looked up
// once.
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet::detail {

template <class Family, class T>
class visible_functions {
 protected:
  explicit visible_functions(const Family& family) : family_(family) {}

  // The family's functions at t >= 0; from tables all of them, once.
  struct point {
    T t, sf, excess, density;
  };
  static constexpr bool tabled = requires(const Family f, T t) { f.density(t); };
  point at(const T& t) const {
    if constexpr (tabled) {
      const T density = family_.density(t), reciprocal = T(1) / density;
      return {t, family_.slope_sf(t) * reciprocal, family_.mean_excess(t) * reciprocal, density};
    } else {
      return {t, family_.sf_over_density(t), T(0), T(0)};
    }
  }
  T excess(const point& p) const {
    if constexpr (tabled) {
      return p.excess;
    } else {
      return family_.excess_over_density(p.t, p.sf);
    }
  }
  T moment(const point& p) const {
    if constexpr (tabled) {
      return multiply_add(p.t, p.sf, p.excess);
    } else {
      return family_.moment_over_density(p.t, p.sf);
    }
  }
  T score(const point& p) const {
    if constexpr (tabled) {
      return family_.score(p.t, p.sf, p.excess);
    } else {
      return family_.score(p.t, p.sf);
    }
  }
  T log_density_ratio(const point& from, const point& to, const T& distance) const {
    if constexpr (tabled) {
      return log(from.density / to.density);
    } else {
      return family_.log_density_ratio(from.t, distance);
    }
  }

  T over_density(const point& p) const {
    if constexpr (tabled) {
      return T(1) / p.density;
    } else {
      return family_.over_density(p.t);
    }
  }

  const Family& family_;
};

}  // namespace microfacet::detail
