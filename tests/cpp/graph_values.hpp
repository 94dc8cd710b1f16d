// What a recorded graph computes, node after node: the reference for everything that prints or runs graphs.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "microfacet/core/math.hpp"
#include "microfacet/record/graph.hpp"

namespace graphs {

namespace record = microfacet::record;
using record::kind, record::node, record::operation;
using inputs = std::map<std::string, double>;

// A value is of the kind of its node; integers are as wide as the reals.
template <class Real>
class values {
 public:
  values(const record::graph& g, const inputs& given)
      : g_(g), at_(g.nodes.size()), results_(g.loops.size()), inside_(g.loops.size() + 1) {
    for (const std::string& name : g.inputs) given_.push_back(static_cast<Real>(given.at(name)));
    for (std::size_t i = 0; i < g.nodes.size(); ++i)
      inside_[static_cast<std::size_t>(g.nodes[i].loop + 1)].push_back(i);
    run(record::none);
  }

  Real operator[](const std::string& name) const {
    for (const auto& [result, id] : g_.results)
      if (result == name) return at_[index(id)].real;
    throw std::out_of_range(name);
  }

 private:
  using whole = microfacet::integer_of<Real>;
  using bits = std::make_unsigned_t<whole>;
  struct value {
    Real real = 0;
    whole integer = 0;
    bool mask = false;
  };
  static std::size_t index(int id) { return static_cast<std::size_t>(id); }

  void run(int loop) {
    for (const std::size_t i : inside_[static_cast<std::size_t>(loop + 1)]) {
      const node& n = g_.nodes[i];
      if (n.is(operation::state)) continue;
      if (n.is(operation::loop_result)) turn(n.index);
      at_[i] = of(n);
    }
  }
  void turn(int L) {
    const record::loop& l = g_.loops[index(L)];
    std::vector<value>& states = results_[index(L)];
    states.clear();
    for (const int id : l.initial) states.push_back(at_[index(id)]);
    bool moving = at_[index(l.moving)].mask;
    for (int i = 0; i < l.most && moving; ++i) {
      for (std::size_t k = 0; k < states.size(); ++k) at_[index(l.state[k])] = states[k];
      run(L);
      for (std::size_t k = 0; k < states.size(); ++k) states[k] = at_[index(l.next[k])];
      moving = at_[index(l.unsettled)].mask;
    }
  }

  value of(const node& n) const {
    const auto argument = [&](std::size_t k) -> const value& { return at_[index(n.arguments[k])]; };
    switch (n.op) {
      case operation::literal:
        return {static_cast<Real>(n.value), static_cast<whole>(n.whole), n.value != 0};
      case operation::input:
        return {given_[index(n.index)]};
      case operation::select:
        return argument(0).mask ? argument(1) : argument(2);
      case operation::loop_result:
        return results_[index(n.index)][index(n.part)];
      case operation::branch_result: {
        const record::branch& b = g_.branches[index(n.index)];
        return at_[index(at_[index(b.mask)].mask ? b.taken[index(n.part)] : b.other[index(n.part)])];
      }
      case operation::table: {
        const record::table& t = g_.tables[index(n.index)];
        const auto row = static_cast<std::size_t>(argument(0).integer);
        if (t.type == kind::real) return {row < t.values.size() ? static_cast<Real>(t.values[row]) : 0};
        return {0, row < t.wholes.size() ? static_cast<whole>(t.wholes[row]) : 0};
      }
      case operation::from_bits:
        return {std::bit_cast<Real>(argument(0).integer)};
      case operation::bits:
        return {0, std::bit_cast<whole>(argument(0).real)};
      default:
        if (n.type == kind::mask) return {0, 0, mask(n)};
        if (n.type == kind::integer) return {0, integer(n.op, argument(0).integer, argument(1).integer)};
        return {real(n)};
    }
  }

  bool mask(const node& n) const {
    const value &a = at_[index(n.arguments[0])],
                &b = at_[index(n.arguments[n.is(operation::logical_not) ? 0 : 1])];
    const kind compared = g_[n.arguments[0]].type;
    if (n.is(operation::logical_not)) return !a.mask;
    if (n.is(operation::logical_and)) return a.mask && b.mask;
    if (n.is(operation::logical_or)) return a.mask || b.mask;
    return compared == kind::real ? holds(n.op, a.real, b.real) : holds(n.op, a.integer, b.integer);
  }
  template <class A>
  static bool holds(operation op, A a, A b) {
    switch (op) {
      case operation::less:
        return a < b;
      case operation::less_equal:
        return a <= b;
      case operation::greater:
        return a > b;
      case operation::greater_equal:
        return a >= b;
      case operation::equal:
        return a == b;
      default:
        return a != b;
    }
  }
  static whole integer(operation op, whole a, whole b) {
    const auto x = static_cast<bits>(a), y = static_cast<bits>(b);
    switch (op) {
      case operation::add:
        return static_cast<whole>(x + y);
      case operation::subtract:
        return static_cast<whole>(x - y);
      case operation::logical_and:
        return static_cast<whole>(x & y);
      case operation::logical_or:
        return static_cast<whole>(x | y);
      case operation::shift_left:
        return static_cast<whole>(x << y);
      case operation::shift_right:
        return static_cast<whole>(a >> b);
      default:
        return static_cast<whole>(x >> y);
    }
  }
  Real real(const node& n) const {
    const auto x = [&](std::size_t k) { return at_[index(n.arguments[k])].real; };
    switch (n.op) {
      case operation::add:
        return x(0) + x(1);
      case operation::subtract:
        return x(0) - x(1);
      case operation::multiply:
        return x(0) * x(1);
      case operation::divide:
        return x(0) / x(1);
      case operation::multiply_add:
        return x(0) * x(1) + x(2);
      case operation::negate:
        return -x(0);
      case operation::minimum:
        return x(1) < x(0) ? x(1) : x(0);
      case operation::maximum:
        return x(0) < x(1) ? x(1) : x(0);
      case operation::absolute:
        return std::abs(x(0));
      case operation::sqrt:
        return std::sqrt(x(0));
      case operation::floor:
        return std::floor(x(0));
      case operation::exp:
        return std::exp(x(0));
      case operation::log:
        return std::log(x(0));
      case operation::expm1:
        return std::expm1(x(0));
      case operation::log1p:
        return std::log1p(x(0));
      case operation::pow:
        return std::pow(x(0), x(1));
      case operation::sin:
        return std::sin(x(0));
      case operation::cos:
        return std::cos(x(0));
      default:
        throw std::logic_error("an operation without a value");
    }
  }

  const record::graph& g_;
  std::vector<Real> given_;
  std::vector<value> at_;
  std::vector<std::vector<value>> results_;
  std::vector<std::vector<std::size_t>> inside_;
};

}  // namespace graphs
