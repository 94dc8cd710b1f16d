// Sums and recurrences of bounded length, one body for all numbers: a scalar that records makes a loop of it.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

inline constexpr auto reciprocals = [] {
  std::array<double, 405> values{};
  for (std::size_t n = 1; n < values.size(); ++n) values[n] = 1.0 / static_cast<double>(n);
  return values;
}();

// Which term it is, for a body that must not know how it is counted: what it gives is a number of its own kind, or
// double where that is known.
template <class T>
struct term {
  using constant = double;
  int index;

  double plus(int n) const { return index + n; }
  double inverse(int n) const { return reciprocals[static_cast<std::size_t>(index + n)]; }  // 1/(index + n)
  template <class Number, std::size_t N>
  Number of(const std::array<Number, N>& values) const {
    return values[static_cast<std::size_t>(index)];
  }
};

namespace detail {
template <class State>
struct number_of_state {
  using type = State;
};
template <class T, std::size_t N>
struct number_of_state<std::array<T, N>> {
  using type = T;
};
}  // namespace detail

// state = body(term, state) for the terms 0, 1, ... `terms` - 1. A state is a T or an array of them.
template <class State, class Body>
MICROFACET_INLINE State accumulate(int terms, State state, const Body& body) {
  for (int i = 0; i < terms; ++i) state = body(term<typename detail::number_of_state<State>::type>{i}, state);
  return state;
}

// The same for `count` terms, a number of each lane, and at most `most`. Lanes are looked at before every
// `together` terms.
template <int together = 1, class T, class State, class Body>
MICROFACET_INLINE State accumulate(int most, const T& count, State state, const Body& body) {
  for (int i = 0; i < most && any_lane(T(i) < count); i += together)
    for (int j = i; j < i + together; ++j)
      state = detail::select_state(T(j) < count, body(term<T>{j}, state), state);
  return state;
}

}  // namespace microfacet
