#include "tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <tuple>
#include <type_traits>
#include <vector>

#include "ways.hpp"

#include "microfacet/family/all.hpp"
#include "microfacet/tabulated/radial_tables.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::plugin {

namespace {

using tables = radial_tables<float>;

// use(family) of the one that is asked for.
template <class Use>
void with_family(const table_request& request, const Use& use) {
  const auto attempt = [&]<class Tag>(Tag) {
    using family = typename Tag::template type<double>;
    if (request.family == family::name) use(made<family>(request.alpha, request.shape));
  };
  std::apply([&](auto... tags) { (attempt(tags), ...); }, all_families{});
}

// The functions that it built.
unsigned build(tables& t, const table_request& request, table_use use) {
  unsigned built = 0;
  with_family(request, [&]<class Family>(const Family& family) {
    if constexpr (has_tables<Family>) {
      const bool all = use == table_use::all;
      if constexpr (way_of<Family>() == way::table_of_excess) {
        built = all ? of_mean_excess | of_visible : of_mean_excess;
      } else {
        built = of_P22 | of_mean_excess | (all ? of_radius | of_P2 | of_visible : 0U);
      }
      t.build(family, built);
    }
  });
  return built;
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
    integers[cell] =
        std::clamp(static_cast<std::int32_t>(t.piece_of_cell(cell % tables::table::cells(t.few))), 0,
                   static_cast<std::int32_t>(layout::pieces) - 1);
  integers[layout::base] = t.base;
  integers[layout::shift] = std::clamp(static_cast<std::int32_t>(t.shift), 0, 31);
}

template <class Family>
bool peaks(const Family& family) {
  using number = typename Family::scalar;
  const number top = family.P22(number(0)), beside = family.P22(family.radius2(number(1e-6)));
  return std::isinf(top) || top > 2 * beside;
}

std::array<const tables::table*, table_functions> functions_of(const tables& t) {
  const auto& v = t.visible;
  return {&t.root_D, &t.radius,        &t.root_P2,         &t.mean_excess,
          &v.moment, &v.moment_radius, &v.marginal_radius, &v.excess_radius};
}

// Whether bytes that somebody has written are a bool.
bool is_bool(const bool& flag) {
  unsigned char byte = 0;
  std::memcpy(&byte, &flag, 1);
  return byte < 2;
}

// Bytes of base64, none where it is not.
std::vector<unsigned char> decoded(std::string_view text) {
  std::vector<unsigned char> bytes;
  std::uint32_t word = 0, bits = 0;
  for (const char c : text) {
    if (c == '=' || c == '\n' || c == '\r' || c == ' ') continue;
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (value < 0) return {};
    word = (word << 6 | static_cast<std::uint32_t>(value)) & 0xffffff, bits += 6;
    if (bits >= 8) bits -= 8, bytes.push_back(static_cast<unsigned char>(word >> bits));
  }
  return bytes;
}

}  // namespace

bool has_peak(const table_request& request) {
  bool result = false;
  with_family(request, [&](const auto& family) { result = peaks(family); });
  return result;
}

std::string_view flat_tables::append_written(std::string_view text, bool& peak) {
  static_assert(std::is_trivially_copyable_v<tables>);
  if (text.substr(0, tables_heading.size()) != tables_heading)
    return "holds no tables that microfacet.mitsuba.table has made";
  const std::vector<unsigned char> bytes = decoded(text.substr(tables_heading.size()));
  if (bytes.size() != sizeof(tables))
    return "holds tables of another version of microfacet, or a part of them";
  const auto t = std::make_unique<tables>();
  std::memcpy(static_cast<void*>(t.get()), bytes.data(), bytes.size());
  for (const tables::table* f : functions_of(*t))
    if (!is_bool(f->few)) return "holds tables of a density that this plugin cannot sample";
  flatten_all(*t);
  if (!t->visible.falls())
    return "holds tables of a density whose slopes are not densest at zero, of which this plugin draws no "
           "normals";
  for (const float number : floats)
    if (std::isnan(number)) return "holds tables of a density that this plugin cannot sample";
  peak = peaks(tabulated<float, tables>(*t));
  return {};
}

void flat_tables::append(const table_request& request, table_use use) {
  const auto t = std::make_unique<tables>();
  const unsigned built = build(*t, request, use);
  const auto& v = t->visible;
  if (use == table_use::all) {
    samples = samples && v.falls() && t->error(built).error < 1e-3 && v.excess_radius.error < 1e-3;
    // The others where the family states no closed forms.
    if (built & of_P2)
      for (const tables::table* f : {&v.moment, &v.moment_radius, &v.marginal_radius})
        samples = samples && f->error < 1e-3;
  }
  flatten_all(*t);
}

template <class Tables>
void flat_tables::flatten_all(const Tables& t) {
  const auto& v = t.visible;
  const auto functions = functions_of(t);
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
