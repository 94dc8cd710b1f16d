// Loops of the recording scalar, and what approx/iterate.hpp is on it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "microfacet/approx/iterate.hpp"
#include "microfacet/record/control.hpp"

namespace microfacet::record {

namespace detail {

template <class T>
struct numbers_of;
template <class Real>
struct numbers_of<number<Real>> {
  using one = number<Real>;
  static void collect(const number<Real>& x, std::vector<number<Real>>& to) { to.push_back(x); }
  static number<Real> made(const number<Real>* from) { return *from; }
};
template <class Real, std::size_t N>
struct numbers_of<std::array<number<Real>, N>> {
  using one = number<Real>;
  static void collect(const std::array<number<Real>, N>& x, std::vector<number<Real>>& to) {
    to.insert(to.end(), x.begin(), x.end());
  }
  static std::array<number<Real>, N> made(const number<Real>* from) {
    std::array<number<Real>, N> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = from[i];
    return x;
  }
};

// The innermost of the loops outside L on whose states what happens in L depends.
inline int loop_around(int L, const std::vector<int>& from) {
  const graph& g = here();
  std::vector<bool> seen(g.nodes.size());
  std::vector<int> todo = from;
  int around = none;
  while (!todo.empty()) {
    const int id = todo.back();
    todo.pop_back();
    if (id == none || seen[static_cast<std::size_t>(id)]) continue;
    seen[static_cast<std::size_t>(id)] = true;
    const node& n = g[id];
    if (n.loop < L) {
      around = (std::max)(around, n.loop);
      continue;
    }
    todo.insert(todo.end(), n.arguments.begin(), n.arguments.end());
    if (n.is(operation::loop_result)) {
      const loop& inner = g.loops[static_cast<std::size_t>(n.index)];
      todo.insert(todo.end(), inner.next.begin(), inner.next.end());
      todo.push_back(inner.unsettled);
    }
  }
  return around;
}

template <class Real>
std::vector<number<Real>> states_of(int L, std::size_t count) {
  std::vector<number<Real>> state;
  for (std::size_t i = 0; i < count; ++i)
    state.push_back(number<Real>::of(here().add(
        {.op = operation::state, .type = kind::real, .index = L, .part = static_cast<int>(i), .loop = L})));
  return state;
}
template <class Real>
std::vector<number<Real>> results_of(int L) {
  const loop l = here().loops[static_cast<std::size_t>(L)];
  std::vector<number<Real>> results;
  for (std::size_t i = 0; i < l.state.size(); ++i)
    results.push_back(number<Real>::of(here().add({.op = operation::loop_result,
                                                   .type = kind::real,
                                                   .index = L,
                                                   .part = static_cast<int>(i),
                                                   .loop = l.parent})));
  return results;
}
template <class Numbers>
std::vector<int> ids_of(const Numbers& numbers) {
  std::vector<int> ids;
  for (const auto& x : numbers) ids.push_back(x.id());
  return ids;
}

// Records a loop over numbers; step gives the next ones and the mask that says whether to go on. A loop that is there
// already, which the same step on its states tells, is that one.
template <class Real, class Step>
std::vector<number<Real>> record_loop(int most, const std::vector<number<Real>>& initial, const mask& moving,
                                      const Step& step) {
  loop made{.most = most, .moving = moving.id, .initial = ids_of(initial)};
  for (int L = 0; L < static_cast<int>(here().loops.size()); ++L) {
    const loop there = here().loops[static_cast<std::size_t>(L)];
    if (there.next.empty() || there.most != most || there.moving != made.moving ||
        there.initial != made.initial)
      continue;
    const auto [next, unsettled] = step(states_of<Real>(L, initial.size()));
    if (ids_of(next) == there.next && unsettled.id == there.unsettled) return results_of<Real>(L);
  }
  const int L = static_cast<int>(here().loops.size());
  here().loops.push_back(made);
  const std::vector<number<Real>> state = states_of<Real>(L, initial.size());
  made.state = ids_of(state);
  const auto [next, unsettled] = step(state);
  made.next = ids_of(next), made.unsettled = unsettled.id;
  std::vector<int> all = made.next;
  all.push_back(made.unsettled), all.push_back(made.moving);
  all.insert(all.end(), made.initial.begin(), made.initial.end());
  made.parent = loop_around(L, all);
  here().loops[static_cast<std::size_t>(L)] = made;
  return results_of<Real>(L);
}

}  // namespace detail

// The derivative is that of the equation x = step(x) which the solution solves: where x may vary, by how the step follows
// it, so that a solver's own slope may be an estimate. Of several states the first is what is solved for; others, its
// bounds, are here what they were at first, and leave it alone.
template <class State, class Step>
State iterate(int most, const State& initial, const mask& moving, const Step& step) {
  using parts = detail::numbers_of<State>;
  using T = typename parts::one;
  std::vector<T> from;
  parts::collect(initial, from);
  std::vector<T> found = detail::record_loop(most, from, moving, [&](const std::vector<T>& state) {
    const auto turn = step(parts::made(state.data()));
    std::vector<T> next;
    parts::collect(turn.next, next);
    return std::pair(next, turn.unsettled);
  });
  std::vector<T> at_solution = from;
  for (T& x : at_solution) x = x.value();
  const auto followed = [&](const T& solution) {
    at_solution[0] = solution;
    std::vector<T> next;
    parts::collect(step(parts::made(at_solution.data())).next, next);
    return next[0];
  };
  const T by_parameters = followed(found[0]);
  const std::size_t directions = by_parameters.directions();
  T less(1);
  if (directions > 0)
    less = T(1) - followed(found[0].with_derivatives(directions + 1, [&](std::size_t k) {
                    return T(k == directions ? 1 : 0);
                  })).derivative(directions);
  found[0] = found[0].with_derivatives((std::max)(directions, from[0].directions()), [&](std::size_t k) {
    return select(moving, T(by_parameters.derivative(k) / less), from[0].derivative(k));
  });
  return parts::made(found.data());
}

}  // namespace microfacet::record
