// Graphs by the name of a family, in one format of numbers: a translation unit each.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "microfacet/family/all.hpp"
#include "microfacet/record/quantities.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::bindings {

// What a graph is recorded from: a family, or tables of a density as bytes.
struct density_source {
  std::string_view family, tables;
};

template <class Real>
record::graph record_graph(const density_source& source, const record::request& asked, bool native);

namespace detail {

// A family's own parameters by their names, behind alpha where that is one of the density's.
template <class Family, class T, class Parameter>
Family family_of(const Parameter& parameter) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    if constexpr (Family::shape_invariant) {
      return Family(parameter(std::string(Family::parameters[I].name))...);
    } else {
      return Family(parameter("alpha"), parameter(std::string(Family::parameters[I].name))...);
    }
  }(std::make_index_sequence<Family::parameters.size()>());
}

template <class Tables>
record::graph record_tables(const density_source& source, const record::request& asked, bool native) {
  using T = record::number<typename Tables::table::real>;
  const auto tables = std::make_unique<Tables>();
  if (source.tables.size() != sizeof(Tables))
    throw std::invalid_argument("these are no tables of this version");
  std::memcpy(static_cast<void*>(tables.get()), source.tables.data(), sizeof(Tables));
  return record::recorded<typename Tables::table::real>(
      asked, native, [&](const auto&) { return tabulated<T, Tables>(*tables); });
}

}  // namespace detail

template <class Real>
record::graph record_graph(const density_source& source, const record::request& asked, bool native) {
  using T = record::number<Real>;
  if (!source.tables.empty() && source.tables.size() == sizeof(radial_tables<Real>))
    return detail::record_tables<radial_tables<Real>>(source, asked, native);
  if (!source.tables.empty()) return detail::record_tables<user_density_tables<Real>>(source, asked, native);
  record::graph made;
  bool found = false;
  const auto of_family = [&]<class Tag>(Tag*) {
    using family = typename Tag::template type<T>;
    if (family::name != source.family) return;
    found = true;
    if constexpr (family::tables_alone)
      throw std::invalid_argument(std::string(source.family) + " is recorded from its tables");
    else
      made = record::recorded<Real>(
          asked, native, [](const auto& parameter) { return detail::family_of<family, T>(parameter); });
  };
  [&]<class... Tag>(const std::tuple<Tag...>*) {
    (of_family(static_cast<Tag*>(nullptr)), ...);
  }(static_cast<const all_families*>(nullptr));
  if (!found) throw std::invalid_argument("no family is called " + std::string(source.family));
  return made;
}

extern template record::graph record_graph<float>(const density_source&, const record::request&, bool);
extern template record::graph record_graph<double>(const density_source&, const record::request&, bool);

}  // namespace microfacet::bindings
