// Choices that a scalar may take in its own way, as one that records does.
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet {

// Selects between a special case and the general form, which tends to it, with its derivatives.
template <class Mask, class Special, class General>
auto select_special(const Mask& mask, const Special& special, const General& general) {
  return select_lazy(mask, special, general);
}

// Selects in the lanes of a mask that seldom has any between a computation and a value that is there.
template <class Mask, class Rare, class State>
MICROFACET_INLINE State select_seldom(const Mask& mask, const Rare& rare, const State& usual) {
  return any_lane(mask) ? select(mask, State(rare()), usual) : usual;
}

}  // namespace microfacet
