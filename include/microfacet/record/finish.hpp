// What is done to a graph once it is whole: nodes without use go, with unused states of loops and unused rows of tables;
// a product that is used once, in a sum, is one operation with it, and a reciprocal that is used once a quotient.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "microfacet/record/graph.hpp"
#include "microfacet/record/table_rows.hpp"

namespace microfacet::record {

namespace detail {

class finisher {
 public:
  explicit finisher(const graph& from) : from_(from), uses_(from.nodes.size()), to_(from.nodes.size(), none) {
    for (const loop& l : from.loops) used_states_.emplace_back(l.state.size(), false);
    needed_loops_.resize(from.loops.size());
  }

  graph operator()() {
    made_.in_float64 = from_.in_float64, made_.native = from_.native, made_.inputs = from_.inputs;
    for (const auto& result : from_.results) use(result.second);
    tables_.emplace(from_, uses_);
    number_loops();
    for (std::size_t i = 0; i < from_.nodes.size(); ++i)
      if (uses_[i] > 0) keep(static_cast<int>(i));
    for (std::size_t i = 0; i < from_.loops.size(); ++i)
      if (needed_loops_[i]) fill(i);
    for (const auto& [name, id] : from_.results) made_.results.emplace_back(name, at(id));
    return std::move(made_);
  }

 private:
  int at(int id) const { return id == none ? none : to_[static_cast<std::size_t>(id)]; }
  const loop& loop_of(const node& n) const { return from_.loops[static_cast<std::size_t>(n.index)]; }

  // Counts uses, depth first without recursion.
  void use(int first) {
    std::vector<int> todo{first};
    while (!todo.empty()) {
      const int id = todo.back();
      todo.pop_back();
      if (id == none || uses_[static_cast<std::size_t>(id)]++ > 0) continue;
      const node& n = from_[id];
      todo.insert(todo.end(), n.arguments.begin(), n.arguments.end());
      if (n.is(operation::loop_result)) need_loop(n, todo);
      if (n.is(operation::state)) need_loop(n, todo);
    }
  }
  void need_loop(const node& n, std::vector<int>& todo) {
    const auto i = static_cast<std::size_t>(n.index), k = static_cast<std::size_t>(n.part);
    const loop& l = from_.loops[i];
    if (!needed_loops_[i]) {
      needed_loops_[i] = true;
      todo.push_back(l.moving), todo.push_back(l.unsettled);
    }
    if (used_states_[i][k]) return;
    used_states_[i][k] = true;
    todo.push_back(l.initial[k]), todo.push_back(l.next[k]), todo.push_back(l.state[k]);
  }

  void number_loops() {
    for (std::size_t i = 0; i < from_.loops.size(); ++i) {
      loop_at_.push_back(needed_loops_[i] ? static_cast<int>(made_.loops.size()) : none);
      if (!needed_loops_[i]) continue;
      const loop& l = from_.loops[i];
      made_.loops.push_back({.most = l.most, .parent = l.parent == none ? none : loop_at(l.parent)});
      states_at_.resize(i + 1);
      int next = 0;
      for (const bool used : used_states_[i]) states_at_[i].push_back(used ? next++ : none);
    }
  }
  int loop_at(int l) const { return l == none ? none : loop_at_[static_cast<std::size_t>(l)]; }
  void fill(std::size_t i) {
    const loop& l = from_.loops[i];
    loop& made = made_.loops[static_cast<std::size_t>(loop_at_[i])];
    made.moving = at(l.moving), made.unsettled = at(l.unsettled);
    for (std::size_t k = 0; k < l.state.size(); ++k)
      if (used_states_[i][k])
        made.initial.push_back(at(l.initial[k])), made.state.push_back(at(l.state[k])),
            made.next.push_back(at(l.next[k]));
  }

  bool once(int id, operation op) const {
    return id != none && from_[id].is(op) && uses_[static_cast<std::size_t>(id)] == 1;
  }
  bool reciprocal(int id) const {
    return once(id, operation::divide) && from_[from_[id].arguments[0]].is(operation::literal) &&
           from_[from_[id].arguments[0]].value == 1;
  }
  // A quotient with a known numerator, used once.
  bool quotient_of_literal(int id) const {
    return once(id, operation::divide) && from_[from_[id].arguments[0]].is(operation::literal);
  }
  int add(node n) {
    made_.nodes.push_back(n);
    return static_cast<int>(made_.nodes.size()) - 1;
  }
  int negated(int id, int loop) {
    const node n = made_[id];
    if (n.is(operation::literal))
      return add({.op = operation::literal, .type = kind::real, .value = -n.value});
    if (n.is(operation::negate)) return n.arguments[0];
    return add({.op = operation::negate, .type = kind::real, .arguments = {id, none, none}, .loop = loop});
  }

  void keep(int id) {
    node n = from_[id];
    const auto [a, b, c] = n.arguments;
    n.loop = loop_at(n.loop);
    const auto fused = [&](int product, int rest, bool minus_product, bool minus_rest) {
      const node& p = from_[product];
      int x = at(p.arguments[0]), z = at(rest);
      if (minus_product) x = negated(x, n.loop);
      if (minus_rest) z = negated(z, n.loop);
      n.op = operation::multiply_add, n.arguments = {x, at(p.arguments[1]), z};
    };
    const auto same_loop = [&](int product) { return from_[product].loop == from_[id].loop; };
    n.arguments = {at(a), at(b), at(c)};
    if (n.is(operation::add) && once(a, operation::multiply) && same_loop(a)) {
      fused(a, b, false, false);
    } else if (n.is(operation::add) && once(b, operation::multiply) && same_loop(b)) {
      fused(b, a, false, false);
    } else if (n.is(operation::subtract) && once(b, operation::multiply) && same_loop(b)) {
      fused(b, a, true, false);
    } else if (n.is(operation::subtract) && once(a, operation::multiply) && same_loop(a)) {
      fused(a, b, false, true);
    } else if (n.is(operation::multiply) && quotient_of_literal(a) && quotient_of_literal(b)) {
      // (x/c) (y/d) = xy/(cd)
      const int numerator =
          add({.op = operation::literal,
               .type = kind::real,
               .value = from_[from_[a].arguments[0]].value * from_[from_[b].arguments[0]].value});
      const int denominator = add({.op = operation::multiply,
                                   .type = kind::real,
                                   .arguments = {at(from_[a].arguments[1]), at(from_[b].arguments[1]), none},
                                   .loop = n.loop});
      n.op = operation::divide, n.arguments = {numerator, denominator, none};
    } else if (n.is(operation::multiply) && reciprocal(b)) {
      n.op = operation::divide, n.arguments = {at(a), at(from_[b].arguments[1]), none};
    } else if (n.is(operation::multiply) && reciprocal(a)) {
      n.op = operation::divide, n.arguments = {at(b), at(from_[a].arguments[1]), none};
    } else if (n.is(operation::table)) {
      n.index = made_.table_of(tables_->kept(n.index));
    } else if (n.is(operation::state) || n.is(operation::loop_result)) {
      n.part = states_at_[static_cast<std::size_t>(n.index)][static_cast<std::size_t>(n.part)];
      n.index = loop_at(n.index);
    } else if (n.is(operation::branch_result)) {
      join_branch(n, id);
    }
    to_[static_cast<std::size_t>(id)] = add(n);
  }
  void join_branch(node& n, int id) {
    const auto b = static_cast<std::size_t>(n.index);
    if (branch_at_.size() <= b) branch_at_.resize(b + 1, none);
    if (branch_at_[b] == none) {
      branch_at_[b] = static_cast<int>(made_.branches.size());
      made_.branches.push_back({n.arguments[0], {}, {}});
    }
    branch& made = made_.branches[static_cast<std::size_t>(branch_at_[b])];
    made.taken.push_back(at(from_[id].arguments[1])), made.other.push_back(at(from_[id].arguments[2]));
    n.index = branch_at_[b], n.part = static_cast<int>(made.taken.size()) - 1;
  }

  const graph& from_;
  graph made_;
  std::vector<int> uses_, to_, loop_at_, branch_at_;
  std::vector<std::vector<bool>> used_states_;
  std::vector<std::vector<int>> states_at_;
  std::vector<bool> needed_loops_;
  std::optional<table_rows> tables_;
};

}  // namespace detail

inline graph finished(const graph& g) {
  graph made = detail::finisher(g)();
  // What a round left without use goes in the next one.
  for (std::size_t before = g.nodes.size(); made.nodes.size() < before;) {
    before = made.nodes.size();
    made = detail::finisher(made)();
  }
  return made;
}

}  // namespace microfacet::record
