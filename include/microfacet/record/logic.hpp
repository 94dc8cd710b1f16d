// Integers, comparisons, masks and choices as nodes (record/fold.hpp has real numbers).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "microfacet/record/fold.hpp"

namespace microfacet::record {

namespace detail {

// Integers wrap round as those of 32 bits do, or of 64.
inline std::int64_t wrapped(std::uint64_t x) {
  return here().in_float64 ? static_cast<std::int64_t>(x)
                           : static_cast<std::int32_t>(static_cast<std::uint32_t>(x));
}

}  // namespace detail

inline int of_integer(operation op, int a, int b) {
  using namespace detail;
  if (!known(a) || !known(b)) return plain(op, kind::integer, a, b);
  const auto x = static_cast<std::uint64_t>(here()[a].whole), y = static_cast<std::uint64_t>(here()[b].whole);
  const auto folded = [&]() -> std::uint64_t {
    switch (op) {
      case operation::add:
        return x + y;
      case operation::subtract:
        return x - y;
      case operation::logical_and:
        return x & y;
      case operation::logical_or:
        return x | y;
      case operation::shift_left:
        return x << y;
      case operation::shift_right:
        return static_cast<std::uint64_t>(here()[a].whole >> y);
      default:
        return (here().in_float64 ? x : x & 0xffffffffU) >> y;
    }
  };
  return here().literal(wrapped(folded()));
}

inline int of_comparison(operation op, int a, int b) {
  using namespace detail;
  const auto verdict = [op](auto x, auto y) {
    switch (op) {
      case operation::less:
        return here().literal(x < y);
      case operation::greater:
        return here().literal(x > y);
      case operation::less_equal:
        return here().literal(x <= y);
      case operation::greater_equal:
        return here().literal(x >= y);
      case operation::equal:
        return here().literal(x == y);
      default:
        return here().literal(x != y);
    }
  };
  if (a == b) return verdict(0, 0);
  if (known(a) && known(b) && here()[a].type == kind::real) return verdict(value(a), value(b));
  if (known(a) && known(b)) return verdict(here()[a].whole, here()[b].whole);
  return plain(op, kind::mask, a, b);
}

inline int of_masks(operation op, int a, int b) {
  using namespace detail;
  const double neutral = op == operation::logical_and ? 1 : 0;
  if (known(a)) return value(a) == neutral ? b : a;
  if (known(b)) return value(b) == neutral ? a : b;
  if (a == b) return a;
  return plain(op, kind::mask, (std::min)(a, b), (std::max)(a, b));
}
inline int opposite(int a) {
  using namespace detail;
  const node n = here()[a];
  if (n.is(operation::literal)) return here().literal(n.value == 0);
  if (n.is(operation::logical_not)) return n.arguments[0];
  return plain(operation::logical_not, kind::mask, a);
}

// Masks whose truth is known while one side of a branch is recorded.
class assumption {
 public:
  assumption(int mask, bool truth) : size_(all().size()) {
    all().emplace_back(mask, truth);
    if (here()[mask].is(operation::logical_not)) all().emplace_back(here()[mask].arguments[0], !truth);
    // Where a conjunction holds, each part does; where a disjunction does not, none does.
    if (here()[mask].is(truth ? operation::logical_and : operation::logical_or))
      for (const int part : {here()[mask].arguments[0], here()[mask].arguments[1]})
        all().emplace_back(part, truth);
  }
  ~assumption() { all().resize(size_); }
  assumption(const assumption&) = delete;
  assumption& operator=(const assumption&) = delete;

  static std::optional<bool> truth_of(int mask) {
    if (detail::known(mask)) return detail::value(mask) != 0;
    for (const auto& [other, truth] : all())
      if (other == mask) return truth;
    return std::nullopt;
  }

 private:
  static std::vector<std::pair<int, bool>>& all() {
    static thread_local std::vector<std::pair<int, bool>> masks;
    return masks;
  }
  std::size_t size_;
};

inline int chosen(kind type, int mask, int a, int b) {
  using namespace detail;
  if (const auto truth = assumption::truth_of(mask)) return *truth ? a : b;
  if (a == b) return a;
  if (here()[mask].is(operation::logical_not)) return chosen(type, here()[mask].arguments[0], b, a);
  if (type == kind::mask && known(a))
    return value(a) != 0 ? of_masks(operation::logical_or, mask, b)
                         : of_masks(operation::logical_and, opposite(mask), b);
  if (type == kind::mask && known(b))
    return value(b) != 0 ? of_masks(operation::logical_or, opposite(mask), a)
                         : of_masks(operation::logical_and, mask, a);
  return plain(operation::select, type, mask, a, b);
}

}  // namespace microfacet::record
