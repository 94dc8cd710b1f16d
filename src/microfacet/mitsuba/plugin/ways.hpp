// How a family is traced, which follows from what its header states. Knows nothing of Mitsuba.
#pragma once

#include "microfacet/family/radial.hpp"

namespace microfacet::plugin {

enum class way {
  closed,           // all of its closed forms
  composed,         // closed forms, which draw visible normals by the mixture alone
  table_of_excess,  // the same, with tables of the mean excess and of its inverse
  closed_density,   // a closed density, and tables for all else
  tables            // tables for all
};

template <class Family>
constexpr way way_of() {
  if constexpr (Family::tables_alone) {
    return way::tables;
  } else if constexpr (Family::tabulate == 0 && closed_visible_sampling<Family>) {
    return way::closed;
  } else if constexpr (Family::tabulate == 0 && mixture_sampling<Family> && closed_excess_quantile<Family>) {
    return way::composed;
  } else if constexpr (mixture_sampling<Family>) {
    return way::table_of_excess;
  } else {
    return (Family::tabulate & of_P22) == 0 ? way::closed_density : way::tables;
  }
}
template <class Family>
constexpr bool has_tables = way_of<Family>() != way::closed && way_of<Family>() != way::composed;

// Made of its parameters in standard space, behind `leading`.
template <class Family, class T, class... Leading>
Family made(const T& alpha, const T& shape, const Leading&... leading) {
  constexpr bool has_shape = Family::parameters.size() > 0;
  if constexpr (Family::shape_invariant && has_shape) {
    return Family(leading..., shape);
  } else if constexpr (Family::shape_invariant) {
    return Family(leading...);
  } else if constexpr (has_shape) {
    return Family(leading..., alpha, shape);
  } else {
    return Family(leading..., alpha);
  }
}

}  // namespace microfacet::plugin
