// A distribution of normals from any density of slopes on a regular grid: it need not be isotropic, nor have a shape,
// nor the mean slope 0. Every quantity is exact for the density of the grid, but for rounding.
#pragma once

#include <array>
#include <cmath>

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/mean_plane.hpp"
#include "microfacet/tabulated/slope_grid.hpp"
#include "microfacet/tabulated/slope_half_plane.hpp"
#include "microfacet/tabulated/slope_sampling.hpp"

namespace microfacet {

class slope_table {
  using T = double;

 public:
  slope_table(const slope_axis& p, const slope_axis& q, const double* masses) : grid_(p, q, masses) {}

  const slope_grid& grid() const { return grid_; }

  // Slopes.
  T P22(T p, T q) const {
    const T i = (p - grid_.p().first) / grid_.p().step, j = (q - grid_.q().first) / grid_.q().step;
    if (!(i >= 0 && i < grid_.p().count && j >= 0 && j < grid_.q().count)) return nothing(p) + nothing(q);
    return grid_.mass(static_cast<int>(i), static_cast<int>(j)) / (grid_.p().step * grid_.q().step);
  }
  T P2(T p) const {
    const slope_axis& axis = grid_.p();
    const T i = (p - axis.first) / axis.step;
    if (!(i >= 0 && i < axis.count)) return nothing(p);
    const row_sums* const columns = grid_.view(true, false, false).rows + static_cast<int>(i);
    return (columns[1].mass - columns[0].mass) / axis.step;
  }
  T slope_cdf(T p) const {
    const slope_axis& axis = grid_.p();
    const T i = (p - axis.first) / axis.step;
    const row_sums* const columns = grid_.view(true, false, false).rows;
    if (!(i >= 0)) return nothing(p);
    if (i >= axis.count) return columns[axis.count].mass;
    const int k = static_cast<int>(i);
    return columns[k].mass + (columns[k + 1].mass - columns[k].mass) * (i - k);
  }

  // Normals of any length, per steradian.
  T D(const vec3<T>& m) const {
    if (!(m.z > 0)) return nothing(m.x) + nothing(m.y) + nothing(m.z);
    const T p = -m.x / m.z, q = -m.y / m.z, density = P22(p, q);
    return density > 0 ? density * square(T(1 + p * p + q * q)) : density;
  }
  // Of normals drawn from D cos(theta).
  T pdf(const vec3<T>& m) const { return D(m) * (m.z / sqrt(dot(m, m))); }
  vec3<T> sample(T xi0, T xi1) const {
    if (!is_uniform(xi0) || !is_uniform(xi1)) return {nan<T>(), nan<T>(), nan<T>()};
    return normal_of(sample_slopes(grid_, xi0, xi1));
  }

  // Directions.
  T sigma(const vec3<T>& w) const { return is_direction(w) ? slope_half_plane(grid_, w).area() : nan<T>(); }
  // The largest relative difference found between sigma and a sum over all cells, of what shows at least 1e-6 of it.
  T error() const {
    constexpr int directions = 96;
    T largest = 0;
    for (int i = 0; i < directions; ++i) {
      const T z = (2 * i + 1 - directions) / T(directions), r = sqrt(T(1 - z * z)),
              turn = T(2.399963229728653) * i;
      const vec3<T> w{r * std::cos(turn), r * std::sin(turn), z};
      const T all = slope_half_plane(grid_, w).area_of_cells();
      if (all > T(1e-6)) largest = maximum(largest, T(std::abs(sigma(w) - all) / all));
    }
    return largest;
  }
  // The area that the mean plane shows, negative from behind: sigma(w) - sigma(-w). It is w.z where the mean slope is 0.
  T up(const vec3<T>& w) const { return w.z - w.x * grid_.mean()[0] - w.y * grid_.mean()[1]; }
  T Lambda(const vec3<T>& w) const { return mean_plane::Lambda(*this, w); }
  T G1(const vec3<T>& w) const { return mean_plane::G1(*this, w); }
  T G2(const vec3<T>& wi, const vec3<T>& wo) const { return mean_plane::G2(*this, wi, wo); }
  T G2_uncorrelated(const vec3<T>& wi, const vec3<T>& wo) const {
    return mean_plane::G2_uncorrelated(*this, wi, wo);
  }
  // Normals that w sees.
  T D_visible(const vec3<T>& m, const vec3<T>& w) const { return mean_plane::D_visible(*this, m, w); }
  vec3<T> sample_visible(const vec3<T>& w, T xi0, T xi1) const {
    if (!is_direction(w) || !is_uniform(xi0) || !is_uniform(xi1)) return {nan<T>(), nan<T>(), nan<T>()};
    return normal_of(seen_slopes(grid_, w).sample(xi0, xi1));
  }

 private:
  // Where a density is 0; nan where it is asked at nan.
  static T nothing(T x) { return x == x ? T(0) : x; }
  // What is far longer than a direction leaves the range of double.
  static bool is_direction(const vec3<T>& w) {
    return std::abs(w.x) <= 1e100 && std::abs(w.y) <= 1e100 && std::abs(w.z) <= 1e100;
  }
  static bool is_uniform(T xi) { return xi >= 0 && xi < 1; }
  static vec3<T> normal_of(const std::array<T, 2>& slopes) {
    const T z = 1 / sqrt(T(1 + slopes[0] * slopes[0] + slopes[1] * slopes[1]));
    return {-slopes[0] * z, -slopes[1] * z, z};
  }

  slope_grid grid_;
};

}  // namespace microfacet
