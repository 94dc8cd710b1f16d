// A density of slopes that is constant in each cell of a regular grid, as a histogram of measured slopes gives it, with
// the sums of cells that integrals over half-planes are made of. Of doubles, one direction at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet {

inline constexpr int most_slope_cells = 512;  // along an axis

struct slope_axis {
  double first = 0, step = 1;
  int count = 1;

  double last() const { return first + step * count; }
  slope_axis mirrored() const { return {-last(), step, count}; }
};

// Of the cells of a row before cell k: their mass and their mass times (k' + 1/2); the masses of cells k and k + 1.
// Half a cache line, in which lies all that a row costs.
struct cell_sums {
  double mass = 0, moment = 0, here = 0, next = 0;
};
// Of the rows before row j: their mass, and that times j' + 1/2, and times k' + 1/2.
struct row_sums {
  double mass = 0, across = 0, along = 0;
};

// The grid turned and mirrored, so that a direction sees lower slopes before higher ones along both axes, and the edge
// of what it sees crosses a row within two cells.
struct slope_view {
  slope_axis along, across;
  const cell_sums* cells = nullptr;  // of the first row, from k = -2 on to k = along.count
  std::ptrdiff_t stride = 0;         // from a row to the next
  const row_sums* rows = nullptr;    // one more than there are
  bool swapped = false;
  double sign_along = 1, sign_across = 1;

  const cell_sums* row(int j) const { return cells + 2 + j * stride; }  // at k = 0
  // Slopes along x and y of a place in cells of this view.
  std::array<double, 2> slopes(double k, double j) const {
    const double a = sign_along * (along.first + along.step * k);
    const double b = sign_across * (across.first + across.step * j);
    return swapped ? std::array{b, a} : std::array{a, b};
  }
};

class slope_grid {
 public:
  // masses[j * p.count + i] is that of the cell with i-th p and j-th q; their sum may be any positive number.
  slope_grid(const slope_axis& p, const slope_axis& q, const double* masses)
      : p_(p), q_(q), masses_(std::make_unique<double[]>(index(p.count) * index(q.count))) {
    const std::size_t n = index(p.count) * index(q.count);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += masses[i];
    for (std::size_t i = 0; i < n; ++i) masses_[i] = masses[i] / sum;
    for (int swapped = 0; swapped < 2; ++swapped)
      for (int mirrored = 0; mirrored < 2; ++mirrored) sum_cells(swapped != 0, mirrored != 0);
    const row_sums& all = rows_[0][index(q.count)];
    mean_ = {mean_of(p, all.along / all.mass), mean_of(q, all.across / all.mass)};
  }

  const slope_axis& p() const { return p_; }
  const slope_axis& q() const { return q_; }
  double mass(int i, int j) const { return masses_[index(j) * index(p_.count) + index(i)]; }
  std::array<double, 2> mean() const { return mean_; }

  slope_view view(double x, double y) const {
    const bool swapped = std::abs(y) * q_.step > std::abs(x) * p_.step;
    return view(swapped, (swapped ? y : x) < 0, (swapped ? x : y) < 0);
  }
  // Rows of q, mirrored or not; of p if they are swapped.
  slope_view view(bool swapped, bool along, bool across) const {
    const slope_axis &a = swapped ? q_ : p_, &b = swapped ? p_ : q_;
    const std::ptrdiff_t stride = a.count + 3;
    const cell_sums* first = cells_[index(2 * swapped + along)].get();
    return {along ? a.mirrored() : a,
            across ? b.mirrored() : b,
            across ? first + (b.count - 1) * stride : first,
            across ? -stride : stride,
            rows_[index(4 * swapped + 2 * along + across)].get(),
            swapped,
            along ? -1.0 : 1.0,
            across ? -1.0 : 1.0};
  }

 private:
  // What rounding leaves of the mean of a table that is symmetric is 0.
  static double mean_of(const slope_axis& axis, double place) {
    const double mean = axis.first + axis.step * place;
    return std::abs(mean) < 1e-13 * maximum(std::abs(axis.first), std::abs(axis.last())) ? 0.0 : mean;
  }
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  void sum_cells(bool swapped, bool mirrored) {
    const int rows = swapped ? p_.count : q_.count, n = swapped ? q_.count : p_.count;
    auto& cells = cells_[index(2 * swapped + mirrored)];
    cells = std::make_unique<cell_sums[]>(index(rows) * index(n + 3));
    for (int j = 0; j < rows; ++j) {
      cell_sums* const row = cells.get() + j * (n + 3) + 2;
      const auto at = [&](int k) {
        const int m = mirrored ? n - 1 - k : k;
        return k < 0 || k >= n ? 0.0 : swapped ? mass(j, m) : mass(m, j);
      };
      for (int k = -2; k <= n; ++k) {
        const cell_sums before = k > 0 ? row[k - 1] : cell_sums();
        row[k] = {before.mass + before.here, before.moment + before.here * (k - 0.5), at(k), at(k + 1)};
      }
    }
    for (int reversed = 0; reversed < 2; ++reversed) {
      auto& sums = rows_[index(4 * swapped + 2 * mirrored + reversed)];
      sums = std::make_unique<row_sums[]>(index(rows + 1));
      for (int j = 0; j < rows; ++j) {
        const cell_sums& all = cells[index((reversed != 0 ? rows - 1 - j : j) * (n + 3) + n + 2)];
        const row_sums& before = sums[index(j)];
        sums[index(j + 1)] = {before.mass + all.mass, before.across + all.mass * (j + 0.5),
                              before.along + all.moment};
      }
    }
  }

  slope_axis p_, q_;
  std::unique_ptr<double[]> masses_;
  std::array<std::unique_ptr<cell_sums[]>, 4> cells_;
  std::array<std::unique_ptr<row_sums[]>, 8> rows_;
  std::array<double, 2> mean_{};
};

}  // namespace microfacet
