// Newton's method and its kin, lane by lane: a lane that has converged stays as it is, whatever its neighbours
// do, so that a batch gives what a scalar gives.
#pragma once

#include <array>
#include <cstddef>

#include "microfacet/core/math.hpp"

namespace microfacet {

// What one step gives: the next state, and the lanes that are to take another one.
template <class State, class Mask>
struct iteration {
  State next;
  Mask unsettled;
};
template <class State, class Mask>
iteration(State, Mask) -> iteration<State, Mask>;

namespace detail {

template <class Mask, class State>
MICROFACET_INLINE State select_state(const Mask& mask, const State& a, const State& b) {
  return select(mask, a, b);
}
template <class Mask, class T, std::size_t N>
MICROFACET_INLINE std::array<T, N> select_state(const Mask& mask, const std::array<T, N>& a,
                                                const std::array<T, N>& b) {
  std::array<T, N> state = b;
  for (std::size_t i = 0; i < N; ++i) state[i] = select(mask, a[i], b[i]);
  return state;
}

}  // namespace detail

// Takes step(state), an iteration, at most `most` times, and ends early when no lane moves. A state is a T, an
// array of them, or what select(mask, a, b) takes; `moving` are the lanes that take the first step.
template <class State, class Mask, class Step>
MICROFACET_INLINE State iterate(int most, State state, Mask moving, const Step& step) {
  for (int i = 0; i < most; ++i) {
    const auto [next, unsettled] = step(state);
    state = detail::select_state(moving, next, state);
    moving = moving & unsettled;
    if (!any_lane(moving)) break;
  }
  return state;
}

}  // namespace microfacet
