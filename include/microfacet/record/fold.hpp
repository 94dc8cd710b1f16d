// Operations on nodes, as short as what is known of their arguments allows. No operation gives nan for arguments in
// its domain, so that 0 x = 0 and x = x.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "microfacet/record/graph.hpp"

namespace microfacet::record {

inline graph& here() { return *graph::current(); }

namespace detail {

inline bool known(int id) { return here()[id].is(operation::literal); }
inline double value(int id) { return here()[id].value; }
inline bool known_as(int id, double x) { return known(id) && value(id) == x; }
inline int real(double x) { return here().literal(x); }

inline double of_reals(operation op, double a, double b, double c) {
  switch (op) {
    case operation::add:
      return a + b;
    case operation::subtract:
      return a - b;
    case operation::multiply:
      return a * b;
    case operation::divide:
      return a / b;
    case operation::multiply_add:
      return a * b + c;
    case operation::minimum:
      return (std::min)(a, b);
    case operation::maximum:
      return (std::max)(a, b);
    case operation::negate:
      return -a;
    case operation::absolute:
      return std::abs(a);
    case operation::sqrt:
      return std::sqrt(a);
    case operation::floor:
      return std::floor(a);
    case operation::exp:
      return std::exp(a);
    case operation::log:
      return std::log(a);
    case operation::expm1:
      return std::expm1(a);
    case operation::log1p:
      return std::log1p(a);
    case operation::pow:
      return std::pow(a, b);
    case operation::sin:
      return std::sin(a);
    default:
      return std::cos(a);
  }
}

inline int plain(operation op, kind type, int a, int b = none, int c = none) {
  return here().add({.op = op, .type = type, .arguments = {a, b, c}});
}
inline int negated(int a) {
  const node n = here()[a];
  if (n.is(operation::literal)) return real(-n.value);
  if (n.is(operation::negate)) return n.arguments[0];
  if (n.is(operation::subtract))
    return plain(operation::subtract, kind::real, n.arguments[1], n.arguments[0]);
  return plain(operation::negate, kind::real, a);
}
inline std::optional<int> without_sign(int a) {
  if (here()[a].is(operation::negate)) return here()[a].arguments[0];
  return std::nullopt;
}

}  // namespace detail

int of_real(operation op, int a, int b = none, int c = none);

namespace detail {

inline int sum(int a, int b) {
  if (known_as(a, 0)) return b;
  if (known_as(b, 0)) return a;
  if (const auto x = without_sign(b)) return of_real(operation::subtract, a, *x);
  if (const auto x = without_sign(a)) return of_real(operation::subtract, b, *x);
  return plain(operation::add, kind::real, (std::min)(a, b), (std::max)(a, b));
}
inline int difference(int a, int b) {
  if (known_as(b, 0)) return a;
  if (known_as(a, 0)) return negated(b);
  if (a == b) return real(0);
  if (const auto x = without_sign(b)) return of_real(operation::add, a, *x);
  return plain(operation::subtract, kind::real, a, b);
}
inline int product(int a, int b) {
  if (known(b)) std::swap(a, b);
  if (known(a)) {
    if (value(a) == 0) return real(0);
    if (value(a) == 1) return b;
    if (value(a) == -1) return negated(b);
    const node n = here()[b];
    if (n.is(operation::multiply) && known(n.arguments[0]))
      return product(real(value(a) * value(n.arguments[0])), n.arguments[1]);
    if (n.is(operation::divide) && known(n.arguments[0]))
      return of_real(operation::divide, real(value(a) * value(n.arguments[0])), n.arguments[1]);
    if (const auto x = without_sign(b)) return product(real(-value(a)), *x);
    return plain(operation::multiply, kind::real, a, b);  // a literal stands first
  }
  const auto x = without_sign(a), y = without_sign(b);
  if (x || y) {
    const int p = product(x.value_or(a), y.value_or(b));
    return x && y ? p : negated(p);
  }
  return plain(operation::multiply, kind::real, (std::min)(a, b), (std::max)(a, b));
}
inline int quotient(int a, int b) {
  if (known_as(b, 1)) return a;
  if (known_as(a, 0)) return a;
  if (a == b) return real(1);
  // 1/c is exact for a power of two alone.
  int exponent;
  if (known(b) && std::abs(std::frexp(value(b), &exponent)) == 0.5) return product(real(1 / value(b)), a);
  return plain(operation::divide, kind::real, a, b);
}

// A function of what a table holds is a table.
inline std::optional<int> of_table(operation op, int a, double other = 0) {
  const node n = here()[a];
  if (!n.is(operation::table)) return std::nullopt;
  table t = here().tables[static_cast<std::size_t>(n.index)];
  for (double& x : t.values) x = of_reals(op, x, other, 0);
  return here().add({.op = operation::table,
                     .type = kind::real,
                     .arguments = n.arguments,
                     .index = here().table_of(std::move(t))});
}

}  // namespace detail

inline int of_real(operation op, int a, int b, int c) {
  using namespace detail;
  if (known(a) && (b == none || known(b)) && (c == none || known(c)))
    return real(of_reals(op, value(a), b == none ? 0 : value(b), c == none ? 0 : value(c)));
  switch (op) {
    case operation::add:
      return sum(a, b);
    case operation::subtract:
      return difference(a, b);
    case operation::multiply:
      if (known(a) && value(a) != 1 && value(a) != 0)
        if (const auto t = of_table(op, b, value(a))) return *t;
      return product(a, b);
    case operation::divide:
      return quotient(a, b);
    case operation::negate:
      if (const auto t = of_table(op, a)) return *t;
      return negated(a);
    case operation::minimum:
    case operation::maximum:
      if (a == b) return a;
      return plain(op, kind::real, (std::min)(a, b), (std::max)(a, b));
    case operation::multiply_add:
      return sum(product(a, b), c);
    case operation::exp:
      if (const auto t = of_table(op, a)) return *t;
      [[fallthrough]];
    default:
      return plain(op, kind::real, a, b, c);
  }
}

}  // namespace microfacet::record
