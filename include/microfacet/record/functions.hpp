// The elementary functions of the recording scalar, found by argument-dependent lookup.
//
// What compilers that regroup sums would break stands here in forms that survive it: log1p as 2 atanh(x/(2 + x)), cosine
// and sine reduced by floor. Without `native` functions these are spelt out, for shading languages, whose own sine and
// cosine are coarse and which have neither log1p nor expm1.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/record/number.hpp"

namespace microfacet::record {

template <class Real>
number<Real> select(const mask& m, const number<Real>& a, const number<Real>& b);

template <class Real>
number<Real> abs(const number<Real>& a) {
  return number<Real>::function(operation::absolute, a, [&](const auto&) {
    return select(a < number<Real>(0), number<Real>(-1), number<Real>(1));
  });
}
// At 0 the slope is large, so that a zero derivative stays zero.
template <class Real>
number<Real> sqrt(const number<Real>& a) {
  return number<Real>::function(operation::sqrt, a, [](const auto& root) {
    return number<Real>(0.5) / maximum(root, smallest<number<Real>>());
  });
}
template <class Real>
number<Real> floor(const number<Real>& a) {
  return number<Real>::of(of_real(operation::floor, a.id()));
}
template <class Real>
number<Real> exp(const number<Real>& a) {
  return number<Real>::function(operation::exp, a, [](const auto& e) { return e; });
}
template <class Real>
number<Real> log(const number<Real>& a) {
  return number<Real>::function(operation::log, a, [&](const auto&) { return number<Real>(1) / a.value(); });
}
// For a >= 0.
template <class Real>
number<Real> pow(const number<Real>& a, const number<Real>& b) {
  using T = number<Real>;
  return T::function(operation::pow, a, b, [&](const T& value, const T& da, const T& db) {
    return value * (b.value() / a.value() * da + log(a.value()) * db);
  });
}

template <class Real>
number<Real> log1p(const number<Real>& a) {
  using T = number<Real>;
  if (here().native || detail::known(a.id()))
    return T::function(operation::log1p, a, [&](const auto&) { return T(1) / (T(1) + a.value()); });
  const auto by_series = abs(a) < T(0.4);
  const T inside = select(by_series, a, T(0)), s = inside / (T(2) + inside), s2 = s * s;
  T series(1.0 / 11);
  for (int k = 9; k >= 1; k -= 2) series = series * s2 + T(1.0 / k);
  return select(by_series, T(T(2) * s * series), log(T(T(1) + a)));
}
template <class Real>
number<Real> expm1(const number<Real>& a) {
  using T = number<Real>;
  if (here().native || detail::known(a.id()))
    return T::function(operation::expm1, a, [](const auto& e) { return e + T(1); });
  const auto by_series = abs(a) < T(0.5);
  const T inside = select(by_series, a, T(0));
  T series(1);
  for (int k = 9; k >= 2; --k) series = series * (inside * T(1.0 / k)) + T(1);
  return select(by_series, T(inside * series), T(exp(a) - T(1)));
}

// The larger and the smaller of two numbers; the derivative is that of the first where they are equal.
template <class Real>
number<Real> maximum(const number<Real>& a, const number<Real>& b) {
  using T = number<Real>;
  return T::function(operation::maximum, a, b,
                     [&](const T&, const T& da, const T& db) { return select(a < b, db, da); });
}
template <class Real>
number<Real> minimum(const number<Real>& a, const number<Real>& b) {
  using T = number<Real>;
  return T::function(operation::minimum, a, b,
                     [&](const T&, const T& da, const T& db) { return select(a > b, db, da); });
}
template <class Real>
number<Real> multiply_add(const number<Real>& a, const number<Real>& b, const number<Real>& c) {
  return a * b + c;
}

// What roundings lose.
template <class Real>
number<Real> two_sum_error(const number<Real>&, const number<Real>&, const number<Real>&) {
  return number<Real>(0);
}

template <class Real>
integer bits(const number<Real>& x) {
  return integer::of(detail::plain(operation::bits, kind::integer, x.id()));
}
template <class Real>
number<Real> from_bits(const integer& i, const number<Real>&) {
  return number<Real>::of(detail::plain(operation::from_bits, kind::real, i.id));
}

// cos and sin of 2 pi x.
template <class Real>
elementary::circle<number<Real>> circle_of_turns(const number<Real>& x) {
  using T = number<Real>;
  if (here().native) {
    const T angle = T(2 * std::numbers::pi) * x;
    const T cosine = T::of(of_real(operation::cos, angle.id())),
            sine = T::of(of_real(operation::sin, angle.id()));
    return {T::function(operation::cos, angle, [&](const T&) { return -sine; }),
            T::function(operation::sin, angle, [&](const T&) { return cosine; })};
  }
  using f = elementary::format<T>;
  const T quarter = floor(T(T(4) * x + T(0.5))), y = T(4) * x - quarter, y2 = y * y;
  const T s = y * T(f::sin[0]) + y * y2 * polynomial<1>(f::sin, y2), c = polynomial(f::cos, y2);
  // The quarters 0 to 3 about the circle.
  const T turned = quarter - T(4) * floor(T(T(0.25) * quarter)), half = floor(T(T(0.5) * turned));
  const mask swapped = turned - T(2) * half == T(1);
  const mask negative_sine = half == T(1), negative_cosine = (turned == T(1)) | (turned == T(2));
  const T cosine = select(swapped, s, c), sine = select(swapped, c, s);
  return {select(negative_cosine, T(-cosine), cosine), select(negative_sine, T(-sine), sine)};
}

template <std::size_t N, class Element, std::size_t Size>
auto lookup(const std::array<Element, Size>& values, const integer& index) {
  static_assert(N <= Size);
  table t{std::integral<Element> ? kind::integer : kind::real, {}, {}, N};
  for (std::size_t i = 0; i < N; ++i) {
    if constexpr (std::integral<Element>)
      t.wholes.push_back(static_cast<std::int64_t>(values[i]));
    else
      t.values.push_back(static_cast<double>(values[i]));
  }
  // The first row without a value stands for what lies beyond the last piece.
  while (t.rows > 1 && values[t.rows - 1] == Element(0) && values[t.rows - 2] == Element(0)) --t.rows;
  const kind type = t.type;
  const int at = (index & integer(N - 1)).id, id = here().table_of(std::move(t));
  const int found =
      here().add({.op = operation::table, .type = type, .arguments = {at, none, none}, .index = id});
  if constexpr (std::integral<Element>)
    return integer::of(found);
  else
    return number<Element>::of(found);
}

}  // namespace microfacet::record
