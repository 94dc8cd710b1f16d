// Fuzzing of any family: which one, in which precision and with which parameters the input says.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "fuzz.hpp"
#include "microfacet/family/all.hpp"

namespace fuzz {

// Any numbers are its parameters.
template <class Family>
Family family_of_numbers(input& in) {
  constexpr std::size_t count = Family::parameters.size() + (Family::shape_invariant ? 0 : 1);
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    const std::array<typename Family::scalar, count> p{((void)I, in.number<typename Family::scalar>())...};
    return Family(p[I]...);
  }(std::make_index_sequence<count>());
}

inline constexpr unsigned families = std::tuple_size_v<microfacet::all_families>;

// visit.operator()<T, Tag>() for the family that is chosen.
template <class Visitor>
void in_family(input& in, unsigned chosen, const Visitor& visit) {
  const bool single = in.choice(2) != 0;
  one_of<families>(chosen, [&]<unsigned I>() {
    using tag = std::tuple_element_t<I, microfacet::all_families>;
    if (single)
      visit.template operator()<float, tag>();
    else
      visit.template operator()<double, tag>();
  });
}

}  // namespace fuzz
