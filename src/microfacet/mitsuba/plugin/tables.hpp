// Prepared polynomials (tabulated/radial_tables.hpp) as flat arrays, which a traced program can gather from.
// Built in a source of its own, which knows nothing of Mitsuba.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace microfacet::plugin {

// The functions of a block, in their order.
enum table_function : std::uint32_t {
  table_root_D,
  table_radius,
  table_root_P2,
  table_mean_excess,
  table_moment,
  table_moment_radius,
  table_marginal_radius,
  table_excess_radius,
  table_functions
};

// Where the numbers of one function lie.
struct table_layout {
  static constexpr std::uint32_t pieces = 32, terms = 8, cells = 256;
  // A row for each piece, read as one packet: the centre, the value there, and the coefficients. Then one row
  // of `last`, `lower`, and a constant that goes with the function: M(0) with the moment, 1/P2(0) with the
  // marginal radius. Below `lower`, which is next to nothing, a function stays as it is there.
  static constexpr std::uint32_t row = 16, centre = 0, value = 1, coefficient = 2, last = pieces * row,
                                 lower = last + 1, constant = last + 2, floats = last + row;
  // The piece of each cell, then `base` and `shift`.
  static constexpr std::uint32_t base = cells, shift = cells + 1, integers = cells + 4;
};

// A density of unit roughness (of roughness alpha where that is no stretch) and its shape parameter; families
// without one ignore it.
struct table_request {
  std::string_view family;
  double alpha, shape;
};

// Whether the density rises steeply at the normal, perhaps to infinity.
bool has_peak(const table_request& request);

// What a block holds: what directions need, or that and what sampling needs.
enum class table_use { directions, all };

// The words before written tables.
inline constexpr std::string_view tables_heading = "microfacet tables 1:";

// One block for each request.
struct flat_tables {
  std::vector<float> floats;
  std::vector<std::int32_t> integers;
  bool samples = true;  // whether visible normals can be drawn from all blocks that hold all

  void append(const table_request& request, table_use use);
  // Those that `microfacet.mitsuba.table` has written down; what is wrong with the text, or nothing. Whether there is
  // a peak, as `has_peak`.
  std::string_view append_written(std::string_view text, bool& peak);

 private:
  template <class Tables>
  void flatten_all(const Tables& t);
};

}  // namespace microfacet::plugin
