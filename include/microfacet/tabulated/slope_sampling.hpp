// Slopes drawn from a slope_grid, all of them or those that a direction sees, from two uniform numbers: the first one
// chooses the row and a place across it, the second one the cell of the row and a place along it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/tabulated/slope_grid.hpp"
#include "microfacet/tabulated/slope_half_plane.hpp"

namespace microfacet {

// A choice among intervals: its number, and where in it, in [0, 1).
struct slope_choice {
  int index;
  double rest;
};

// The last of `size` intervals that starts at or below `at`; `start(i)` does not decrease, and start(0) <= at.
template <class Start>
int interval_of(int size, double at, const Start& start) {
  int low = 0;
  for (int high = size; high - low > 1;) {
    const int middle = (low + high) / 2;
    (start(middle) <= at ? low : high) = middle;
  }
  return low;
}
inline double inside_unit(double x) { return minimum(maximum(x, 0.0), 1 - 0x1p-53); }

// The place in [0, 1] before which the part xi lies of a density that goes linearly from `first` to `last`, both >= 0.
inline double inverse_of_linear(double xi, double first, double last) {
  const double at = sqrt(first * first + xi * ((last - first) * (last + first)));
  return minimum(xi * (first + last) / maximum(first + at, smallest<double>()), 1.0);
}
// The same of the density that goes as a square, from first^2 to last^2.
inline double inverse_of_square(double xi, double first, double last) {
  const double all = first * first + first * last + last * last;
  const double at = std::cbrt(first * first * first + xi * (last - first) * all);
  return minimum(xi * all / maximum(first * first + first * at + at * at, smallest<double>()), 1.0);
}

class seen_slopes {
 public:
  seen_slopes(const slope_grid& grid, const vec3<double>& w) : half_(grid, w) {}

  // nan where nothing is seen.
  std::array<double, 2> sample(double xi0, double xi1) const {
    const slope_choice row = choose_row(xi0);
    if (row.index < 0) return {nan<double>(), nan<double>()};
    const slope_choice cell = choose_cell(row.index, xi1);
    const double shown = half_.place(row.index) - cell.index;  // by the near side of the cell, in the middle
    const double along = place_along(shown, cell.rest);
    return half_.view().slopes(cell.index + along, row.index + place_across(shown - along, row.rest));
  }

 private:
  slope_choice choose_row(double xi) const {
    std::array<double, most_slope_cells> seen;
    half_.of_crossed_rows(seen.data());
    const double whole = half_.of_rows_before(half_.full());
    double all = whole;
    const int crossed = half_.end() - half_.full();
    for (int i = 0; i < crossed; ++i) all += seen[static_cast<std::size_t>(i)];
    if (!(all > 0)) return {-1, 0};
    const double at = xi * all;
    if (at < whole) {
      const int j = interval_of(half_.full(), at, [this](int i) { return half_.of_rows_before(i); });
      return {j, inside_unit((at - half_.of_rows_before(j)) / half_.of_row(j))};
    }
    double before = whole;
    int last = -1;
    for (int i = 0; i < crossed; ++i) {
      const double part = seen[static_cast<std::size_t>(i)];
      if (part > 0) {
        last = i;
        if (at < before + part) return {half_.full() + i, inside_unit((at - before) / part)};
        before += part;
      }
    }
    // Rounding has left nothing: the end of the last row.
    if (last >= 0) return {half_.full() + last, inside_unit(1)};
    return {interval_of(half_.full(), at, [this](int i) { return half_.of_rows_before(i); }), inside_unit(1)};
  }

  slope_choice choose_cell(int j, double xi) const {
    const cell_sums* const row = half_.view().row(j);
    const double c = half_.place(j), d = half_.slant() / 2, inverse = 1 / (12 * d);
    const int k = static_cast<int>(half_.crossed_cell(c));
    const double a = c - k - 0.5;
    const auto start = [&](int i) { return row[i].mass * c - row[i].moment; };
    const double whole = start(k), here = row[k].here * half_.of_cell(a, d, inverse),
                 next = row[k].next * half_.of_cell(a - 1, d, inverse), at = xi * (whole + here + next);
    if (at < whole || !(here + next > 0)) {
      const int i = interval_of(k, at, start);
      return {i, inside_unit((at - start(i)) / (row[i].here * (c - i - 0.5)))};
    }
    if ((at < whole + here || !(next > 0)) && here > 0) return {k, inside_unit((at - whole) / here)};
    return {k + 1, inside_unit((at - whole - here) / next)};
  }

  // The place along a cell whose near side shows `shown` in the middle of the row, +- d across it.
  double place_along(double shown, double xi) const {
    const double d = half_.slant() / 2, rear = shown - 1;
    if (rear >= d) return inverse_of_linear(xi, shown, rear);
    // Before `corner` the whole width of the cell is seen; from there on less and less, down to `end`.
    const double front = minimum(shown, d), end = maximum(rear, -d), corner = maximum(shown, d);
    const double linear = (corner - d) * (corner + d) / 2;
    const double first = maximum(front + d, 0.0), last = end + d;
    const double square =
        maximum(first - last, 0.0) * (first * first + first * last + last * last) / (12 * d);
    const double at = xi * (linear + square);
    if (at < linear) return (corner - d) * inverse_of_linear(at / linear, corner, d);
    // From the end, where the density starts.
    const double back = inverse_of_square(inside_unit(1 - (at - linear) / square), last, first);
    return minimum(maximum(shown - front + (first - last) * (1 - back), 0.0), 1.0);
  }
  // The place across a row, at whose middle `shown` is seen; +- d at its sides.
  double place_across(double shown, double xi) const {
    const double front = maximum(shown + half_.slant() / 2, 0.0), rear = front - half_.slant();
    if (rear >= 0) return inverse_of_linear(xi, front, rear);
    return front / half_.slant() * inverse_of_linear(xi, front, 0);
  }

  slope_half_plane half_;
};

// Of all slopes.
inline std::array<double, 2> sample_slopes(const slope_grid& grid, double xi0, double xi1) {
  const slope_view view = grid.view(false, false, false);
  const double at = xi0 * view.rows[view.across.count].mass;
  const int j = interval_of(view.across.count, at, [&](int i) { return view.rows[i].mass; });
  const cell_sums* const row = view.row(j);
  const double in_row = xi1 * row[view.along.count].mass;
  const int k = interval_of(view.along.count, in_row, [&](int i) { return row[i].mass; });
  const double across = (at - view.rows[j].mass) / row[view.along.count].mass;
  return view.slopes(k + inside_unit((in_row - row[k].mass) / row[k].here), j + inside_unit(across));
}

}  // namespace microfacet
