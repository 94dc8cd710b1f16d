// A computation as a graph: what a recording scalar leaves behind. A node is an operation on earlier nodes; the same
// operation on the same nodes is one node, and what is known is folded. Loops and branches are kept as such
// (record/control.hpp). Nodes refer to each other by their number.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace microfacet::record {

enum class kind : std::uint8_t { real, integer, mask };

// clang-format off
enum class operation : std::uint8_t {
  literal, input, add, subtract, multiply, divide, negate, multiply_add, minimum, maximum, absolute, sqrt, floor, exp, log,
  expm1, log1p, pow, sin, cos, select, from_bits, bits, table, shift_left, shift_right, shift_right_logical,
  less, less_equal, greater, greater_equal, equal, not_equal, logical_and, logical_or, logical_not,
  state, loop_result, branch_result
};
inline constexpr std::array names{
  "literal", "input", "add", "subtract", "multiply", "divide", "negate", "multiply_add", "minimum", "maximum", "absolute", "sqrt",
  "floor", "exp", "log", "expm1", "log1p", "pow", "sin", "cos", "select", "from_bits", "bits", "table", "shift_left", "shift_right",
  "shift_right_logical", "less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "and", "or", "not",
  "state", "loop_result", "branch_result"};
// clang-format on

inline constexpr int none = -1;

struct node {
  operation op;
  kind type;
  std::array<int, 3> arguments{none, none, none};
  double value = 0;        // of a literal
  std::int64_t whole = 0;  // of an integer literal
  int index = none;        // of an input, a table, a loop or a branch
  int part = none;         // which of the states or results
  int loop = none;         // the innermost loop on whose states it depends

  bool is(operation other) const { return op == other; }
};

// next and unsettled are computed from the states, as long as `moving` holds, `most` times at most.
struct loop {
  int most = 0, parent = none, moving = none, unsettled = none;
  std::vector<int> initial{}, state{}, next{};
};
// Two sides of which one is left out.
struct branch {
  int mask = none;
  std::vector<int> taken{}, other{};
};
struct table {
  kind type;
  std::vector<double> values;        // of reals
  std::vector<std::int64_t> wholes;  // of integers
  std::size_t rows;                  // behind which all is unused
  bool operator==(const table&) const = default;
};

class graph {
 public:
  bool in_float64 = false;  // the format of real numbers
  bool native = true;       // whether expm1, log1p, sin and cos are operations, else they are spelt out
  std::vector<node> nodes;
  std::vector<loop> loops;
  std::vector<branch> branches;
  std::vector<table> tables;
  std::vector<std::string> inputs;
  std::vector<std::pair<std::string, int>> results;

  const node& operator[](int id) const { return nodes[static_cast<std::size_t>(id)]; }

  int add(node n) {
    for (const int a : n.arguments)
      if (a != none) n.loop = n.loop > (*this)[a].loop ? n.loop : (*this)[a].loop;
    const key k{n.op, n.type, n.arguments, std::bit_cast<std::uint64_t>(n.value), n.whole, n.index, n.part};
    const auto [place, fresh] = seen_.try_emplace(k, static_cast<int>(nodes.size()));
    if (fresh) nodes.push_back(n);
    return place->second;
  }
  int literal(double value) { return add({.op = operation::literal, .type = kind::real, .value = value}); }
  int literal(std::int64_t whole) {
    return add({.op = operation::literal, .type = kind::integer, .whole = whole});
  }
  int literal(bool truth) {
    return add({.op = operation::literal, .type = kind::mask, .value = truth ? 1.0 : 0.0});
  }
  int input(const std::string& name) {
    const auto place = std::find(inputs.begin(), inputs.end(), name);
    const auto i = static_cast<int>(place - inputs.begin());
    if (place == inputs.end()) inputs.push_back(name);
    return add({.op = operation::input, .type = kind::real, .index = i});
  }
  int table_of(table t) {
    for (std::size_t i = 0; i < tables.size(); ++i)
      if (tables[i] == t) return static_cast<int>(i);
    tables.push_back(std::move(t));
    return static_cast<int>(tables.size()) - 1;
  }

  // The graph on which numbers record, one a thread.
  static graph*& current() {
    static thread_local graph* g = nullptr;
    return g;
  }

 private:
  using key = std::tuple<operation, kind, std::array<int, 3>, std::uint64_t, std::int64_t, int, int>;
  std::map<key, int> seen_;
};

// Makes a graph the one that records, as long as it lives.
class recording {
 public:
  explicit recording(graph& g) : before_(std::exchange(graph::current(), &g)) {}
  ~recording() { graph::current() = before_; }
  recording(const recording&) = delete;
  recording& operator=(const recording&) = delete;

 private:
  graph* before_;
};

}  // namespace microfacet::record
