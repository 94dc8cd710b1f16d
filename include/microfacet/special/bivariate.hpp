// Polynomials of two variables with constant coefficients: a row of powers of x for each power of y, each row
// of its own length, all in one array.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "microfacet/core/math.hpp"

namespace microfacet {

template <class Real, std::size_t... Rows>
struct bivariate {
  std::array<Real, (Rows + ...)> coefficients;
};

namespace detail {

template <std::size_t First, std::size_t Size, std::size_t... Rows, class Real, std::size_t N, class T>
MICROFACET_INLINE T bivariate_rows(const std::array<Real, N>& c, const T& x, const T& y) {
  T row = T(c[First + Size - 1]);
  for (std::size_t i = Size - 1; i-- > 0;) row = multiply_add(row, x, T(c[First + i]));
  if constexpr (sizeof...(Rows) > 0) {
    return multiply_add(bivariate_rows<First + Size, Rows...>(c, x, y), y, row);
  } else {
    return row;
  }
}

}  // namespace detail

template <class T, class Real, std::size_t... Rows>
MICROFACET_INLINE T polynomial(const bivariate<Real, Rows...>& p, const T& x, const T& y) {
  return detail::bivariate_rows<0, Rows...>(p.coefficients, x, y);
}

}  // namespace microfacet
