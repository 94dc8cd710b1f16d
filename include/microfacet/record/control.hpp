// Choices of the recording scalar: what select and select_lazy do on other numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "microfacet/core/choices.hpp"
#include "microfacet/record/functions.hpp"

namespace microfacet::record {

namespace detail {

// The branch that selections by its mask belong to.
struct open_branch {
  int mask, branch;
  static std::optional<open_branch>& current() {
    static thread_local std::optional<open_branch> b;
    return b;
  }
};

inline int result_of(int branch, std::size_t part) {
  const auto& b = here().branches[static_cast<std::size_t>(branch)];
  return here().add({.op = operation::branch_result,
                     .type = kind::real,
                     .arguments = {b.mask, b.taken[part], b.other[part]},
                     .index = branch,
                     .part = static_cast<int>(part)});
}
inline int chosen_real(int mask, int a, int b) {
  const int plain = chosen(kind::real, mask, a, b);
  if (!here()[plain].is(operation::select)) return plain;
  auto& branches = here().branches;
  // What a branch gives already, it gives again.
  for (std::size_t i = 0; i < branches.size(); ++i)
    for (std::size_t k = 0; branches[i].mask == mask && k < branches[i].taken.size(); ++k)
      if (branches[i].taken[k] == a && branches[i].other[k] == b) return result_of(static_cast<int>(i), k);
  const auto& open = open_branch::current();
  if (!open || open->mask != mask) return plain;
  branch& to = branches[static_cast<std::size_t>(open->branch)];
  to.taken.push_back(a), to.other.push_back(b);
  return result_of(open->branch, to.taken.size() - 1);
}

}  // namespace detail

template <class Real>
number<Real> select(const mask& m, const number<Real>& a, const number<Real>& b) {
  using T = number<Real>;
  const T value = T::of(detail::chosen_real(m.id, a.id(), b.id()));
  return value.with_derivatives((std::max)(a.directions(), b.directions()), [&](std::size_t k) {
    return T::of(detail::chosen_real(m.id, a.derivative(k).id(), b.derivative(k).id()));
  });
}

// A side of this many operations is worth a branch.
inline constexpr std::size_t worth_a_branch = 24;

template <class Taken, class Other>
auto select_lazy(const mask& m, const Taken& taken, const Other& other) {
  if (const auto truth = assumption::truth_of(m.id)) return *truth ? taken() : other();
  const auto side = [&](bool truth, const auto& make) {
    const assumption holds(m.id, truth);
    return make();
  };
  const std::size_t before = here().nodes.size();
  const auto a = side(true, taken);
  const std::size_t between = here().nodes.size();
  const auto b = side(false, other);
  const std::size_t most = (std::max)(between - before, here().nodes.size() - between);
  std::optional<detail::open_branch> mine;
  if (most >= worth_a_branch && !here()[m.id].is(operation::logical_not)) {
    here().branches.push_back({m.id, {}, {}});
    mine = detail::open_branch{m.id, static_cast<int>(here().branches.size()) - 1};
  }
  const auto outer = std::exchange(detail::open_branch::current(), mine);
  const auto result = select(m, a, b);
  detail::open_branch::current() = outer;
  return result;
}

// A special case does not know where the parameter that makes it leads: derivatives are those of the general form.
template <class Special, class General>
auto select_special(const mask& m, const Special& special, const General& general) {
  std::optional<decltype(general())> beyond;
  const auto led = [&] {
    const auto at = special();
    beyond = general();
    return at.with_derivatives(beyond->directions(), [&](std::size_t k) { return beyond->derivative(k); });
  };
  return select_lazy(m, led, [&] { return beyond ? *beyond : general(); });
}
template <class Rare, class State>
State select_seldom(const mask& m, const Rare& rare, const State& usual) {
  return select_lazy(m, [&] { return State(rare()); }, [&] { return usual; });
}

}  // namespace microfacet::record
