// Evaluates every family on another library's arrays and compares each element with the scalar double.
//
// An array type comes with an Io of two functions: load(std::vector<real>) -> array of Io::size elements (or of any
// number, where size is 0), store(array) -> std::vector<real>.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../check.hpp"
#include "../families.hpp"
#include "microfacet/smith/ndf.hpp"

namespace generic {

namespace mf = microfacet;

// How far an exponent of `log(value)` formed in T may be off. These arrays have no logarithm in two parts.
template <class T>
double tolerance(double value) {
  const double rounding = std::numeric_limits<T>::epsilon(), exponent = std::abs(std::log(value));
  return rounding * (20 + 4 * std::min(exponent, 700.0));
}

template <class T>
void same(const char* name, double x, T got, double want) {
  if (want < 4 * static_cast<double>(std::numeric_limits<T>::min()) && std::abs(got) < 1e-30) return;
  const check::note at(name, "(", x, ")");
  CHECK_NEAR(got, want, tolerance<T>(want));
}

template <class Array, class T, class Io, class Wanted = decltype([](std::string_view) { return true; })>
void families_on(const char* library, const Wanted& wanted = {}) {
  const std::vector<T> slopes{T(0.01), T(0.05), T(0.2), T(0.3), T(0.45), T(0.6), T(0.75), T(0.9),
                              T(1.1),  T(1.3),  T(1.6), T(1.8), T(2.0),  T(2.2), T(2.5),  T(2.9)};
  ::families::each([&]<class Tag>(const ::families::arguments& exact) {
    if (!wanted(Tag::template type<T>::name)) return;
    ::families::arguments rounded = exact;
    for (double& a : rounded) a = static_cast<T>(a);
    const auto f = ::families::make<double, Tag>(rounded);
    const auto g = ::families::make<Array, Tag>(rounded);
    const double last = exact.empty() ? 0 : exact.back();
    const check::note family(library, sizeof(T) == 4 ? " float " : " double ", Tag::template type<T>::name, " ", last);
    const auto compare = [&](const char* name, const auto& on_array, const auto& on_number) {
      for (std::size_t first = 0; first < slopes.size(); first += Io::size) {
        const std::vector<T> x(slopes.begin() + static_cast<std::ptrdiff_t>(first), slopes.begin() + static_cast<std::ptrdiff_t>(first + Io::size));
        const std::vector<T> got = Io::store(on_array(Io::load(x)));
        for (std::size_t i = 0; i < Io::size; ++i) same<T>(name, x[i], got[i], on_number(double(x[i])));
      }
    };
#define COMPARE(name, ...) compare(name, [&]<class X>(const X& x) { const auto& d = g; return __VA_ARGS__; }, [&]<class X>(const X& x) { const auto& d = f; return __VA_ARGS__; })
    COMPARE("P22", d.P22(x));
    COMPARE("D", d.D(X(0.7), x));
    COMPARE("survival", d.survival(x));
    COMPARE("P2", d.P2(x));
    COMPARE("slope_sf", d.slope_sf(x));
    COMPARE("slope_excess", d.slope_excess(x));
#undef COMPARE
  });
}

}  // namespace generic
