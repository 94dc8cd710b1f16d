// The part of a slope_grid that a direction sees: facets of slopes p, q show z - x p - y q to the direction (x, y, z),
// which is not negative in a half-plane. Its integral needs one step for each row of cells that the edge of the
// half-plane crosses; every term is positive, so that what little is seen from below keeps its relative accuracy.
//
// In units of what a step from one cell to the next along a row takes away, cell k of row j shows c_j - k - 1/2 on
// average, where c_j = first - slant (j + 1/2), 0 <= slant <= 1, and between -1/2 - slant/2 and 1/2 + slant/2 more.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/tabulated/slope_grid.hpp"

namespace microfacet {

class slope_half_plane {
 public:
  slope_half_plane(const slope_grid& grid, const vec3<double>& w) : view_(grid.view(w.x, w.y)) {
    // Straight up and down all is said by z, and 0/0 by nothing.
    const double x = maximum(std::abs(view_.swapped ? w.y : w.x), std::abs(w.z) * least + smallest<double>());
    const double y = maximum(std::abs(view_.swapped ? w.x : w.y), 0.0);
    unit_ = x * view_.along.step;
    first_ = (w.z - y * view_.across.first - x * view_.along.first) / unit_;
    slant_ = maximum(y * view_.across.step / unit_, least);
    full_ = row_before((first_ - view_.along.count) / slant_);
    const int end = row_before(first_ / slant_ + 1.0);
    end_ = end > full_ ? end : full_;
  }

  const slope_view& view() const { return view_; }
  double unit() const { return unit_; }
  double slant() const { return slant_; }
  int full() const { return full_; }  // rows before it are seen whole,
  int end() const { return end_; }    // and no row from this one on
  double place(int j) const { return first_ - slant_ * (j + 0.5); }

  // What is seen of the full rows before row j.
  double of_rows_before(int j) const {
    const row_sums& before = view_.rows[j];
    return before.mass * first_ - before.across * slant_ - before.along;
  }
  double of_row(int j) const { return of_row(j, place(j), 1 / (12 * (slant_ / 2))); }
  // Of the rows that the edge crosses, from full() on.
  void of_crossed_rows(double* seen) const {
    const double inverse = 1 / (12 * (slant_ / 2));
    for (int j = full_; j < end_; ++j) seen[j - full_] = of_row(j, place(j), inverse);
  }
  // The projected area sigma.
  double area() const {
    std::array<double, most_slope_cells> seen;
    of_crossed_rows(seen.data());
    std::array<double, 4> sums{};
    const int n = end_ - full_;
    for (int i = 0; i < n; ++i) sums[static_cast<std::size_t>(i % 4)] += seen[static_cast<std::size_t>(i)];
    return unit_ * (of_rows_before(full_) + ((sums[0] + sums[1]) + (sums[2] + sums[3])));
  }

  // The same by a sum over all cells, one by one.
  double area_of_cells() const {
    const double d = slant_ / 2, inverse = 1 / (12 * d);
    double sum = 0;
    for (int j = 0; j < view_.across.count; ++j)
      for (int k = 0; k < view_.along.count; ++k)
        sum += view_.row(j)[k].here * of_cell(place(j) - k - 0.5, d, inverse);
    return unit_ * sum;
  }

  // The first cell of a row that the edge may cross; the next is the last one.
  double crossed_cell(double c) const {
    return floor(minimum(maximum(c - slant_ / 2, -2.0), static_cast<double>(view_.along.count)));
  }
  // What a cell of mass 1 shows whose middle shows `a` (negative: what faces away): the mean of max(a + u + v, 0) over
  // |u| < 1/2, |v| < d = slant/2. Given 1/(12 d).
  static double of_cell(double a, double d, double inverse) {
    const double u = std::abs(a), corner = 0.5 + d - u, side = 0.5 - u;
    const double ramp = corner * corner * corner * inverse, across = side * side * 0.5 + d * d * (1.0 / 6);
    const double beyond = u < 0.5 - d ? across : ramp;
    return maximum(a, 0.0) + (corner > 0 ? beyond : 0.0);
  }

 private:
  static constexpr double least = 1e-30;

  int row_before(double j) const {
    return static_cast<int>(minimum(maximum(j, 0.0), static_cast<double>(view_.across.count)));
  }
  double of_row(int j, double c, double inverse) const {
    const double k = crossed_cell(c), a = c - k - 0.5, d = slant_ / 2;
    const cell_sums& at = view_.row(j)[static_cast<int>(k)];
    return at.mass * c - at.moment +
           (at.here * of_cell(a, d, inverse) + at.next * of_cell(a - 1, d, inverse));
  }

  slope_view view_;
  double unit_, first_, slant_;
  int full_, end_;
};

}  // namespace microfacet
