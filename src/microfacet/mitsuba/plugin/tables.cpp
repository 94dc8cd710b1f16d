#include "tables.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "microfacet/family/all.hpp"
#include "microfacet/tabulated/radial_tables.hpp"

namespace microfacet::plugin {

namespace {

using tables = radial_tables<float>;

// The functions that it built.
unsigned build(tables& t, const table_request& request, table_use use) {
  const bool all = use == table_use::all;
  const unsigned of_directions = of_P22 | of_mean_excess;
  const unsigned functions = all ? of_directions | of_radius | of_P2 | of_visible : of_directions;
  const auto with = [&](const auto& family, unsigned wanted) { return t.build(family, wanted), wanted; };
  if (request.family == "student_t")
    return with(student_t<double>(request.shape), all ? of_mean_excess | of_visible : of_mean_excess);
  if (request.family == "gtr") return with(gtr<double>(request.alpha, request.shape), functions);
  if (request.family == "bessel_k") return with(bessel_k<double>(request.shape), functions);
  return 0;
}

void flatten(const tables::table& t, float* floats, std::int32_t* integers) {
  using layout = table_layout;
  static_assert(tables::table::most_pieces == layout::pieces && tables::table::terms == layout::terms);
  for (std::size_t i = 0; i < layout::pieces; ++i) {
    float* row = floats + i * layout::row;
    row[layout::centre] = t.centre[i], row[layout::value] = 0.5F * t.twice_value[i];
    for (std::size_t k = 0; k < layout::terms; ++k) row[layout::coefficient + k] = t.coefficient[k][i];
  }
  floats[layout::last] = t.last, floats[layout::lower] = t.lower;
  // The number of a cell counts modulo the number of cells.
  for (std::size_t cell = 0; cell < layout::cells; ++cell)
    integers[cell] = static_cast<std::int32_t>(t.piece_of_cell(cell % tables::table::cells(t.few)));
  integers[layout::base] = t.base, integers[layout::shift] = t.shift;
}

}  // namespace

void flat_tables::append(const table_request& request, table_use use) {
  const auto t = std::make_unique<tables>();
  const unsigned built = build(*t, request, use);
  const auto& v = t->visible;
  if (use == table_use::all) {
    samples = samples && v.falls && t->error(built).error < 1e-3 && v.excess_radius.error < 1e-3;
    // The others where the family states no closed forms.
    if (built & of_P2)
      for (const tables::table* f : {&v.moment, &v.moment_radius, &v.marginal_radius})
        samples = samples && f->error < 1e-3;
  }
  const std::array<const tables::table*, table_functions> functions{
      &t->root_D, &t->radius,       &t->root_P2,        &t->mean_excess,
      &v.moment,  &v.moment_radius, &v.marginal_radius, &v.excess_radius};
  const std::size_t first = floats.size();
  for (const tables::table* f : functions) {
    const std::size_t at = floats.size(), cell = integers.size();
    floats.resize(at + table_layout::floats);
    integers.resize(cell + table_layout::integers);
    flatten(*f, floats.data() + at, integers.data() + cell);
  }
  const auto constant = [&](table_function f) -> float& {
    return floats[first + f * table_layout::floats + table_layout::constant];
  };
  constant(table_moment) = v.first_moment, constant(table_marginal_radius) = v.inverse_P2;
}

}  // namespace microfacet::plugin
