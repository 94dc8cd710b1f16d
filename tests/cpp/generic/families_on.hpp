// Every family on another library's arrays: each element is the scalar double's value, to the accuracy
// contract in double and to a few roundings of the exponents in float.
//
// An array comes with a function Io::map(function, numbers), which applies a function of arrays to 16
// numbers.
#pragma once

#include <string_view>
#include <vector>

#include "../check.hpp"
#include "../families.hpp"
#include "microfacet/smith/ndf.hpp"

namespace generic {

namespace mf = microfacet;

template <class T>
constexpr double tolerance = sizeof(T) == 4 ? 1e-5 : 1e-13;

template <class T>
const std::vector<T> arguments{T(0.01), T(0.05), T(0.2), T(0.3), T(0.45), T(0.6), T(0.75), T(0.9),
                               T(1.1),  T(1.3),  T(1.6), T(1.8), T(2.0),  T(2.2), T(2.5),  T(2.9)};

template <class X, class Family>
auto under_a_shape(const Family& family) {
  return mf::ndf<Family, X, mf::isotropic_shape<X>>(family, mf::isotropic_shape<X>(X(1)));
}

template <class X>
mf::cosine<X> cosine_of(const X& x) {
  return mf::cosine<X>(X(x * X(0.25)));
}

// `wanted(name)` leaves families out.
template <class Array, class Io, class Wanted = decltype([](std::string_view) { return true; })>
void families_on(const char* library, const Wanted& wanted = {}) {
  using T = typename mf::scalar_traits<Array>::real;
  ::families::each([&]<class Tag>(const ::families::arguments& exact) {
    if (!wanted(Tag::template type<T>::name)) return;
    ::families::arguments rounded = exact;
    for (double& a : rounded) a = static_cast<T>(a);
    const auto scalar = ::families::make<double, Tag>(rounded);
    const auto array = ::families::make<Array, Tag>(rounded);
    const double last = exact.empty() ? 0 : exact.back();
    const check::note family(library, sizeof(T) == 4 ? " float " : " double ", Tag::template type<T>::name,
                             " ", last);
    const auto compare = [&](const char* name, const auto& function) {
      const std::vector<T> got =
          Io::map([&](const Array& x) { return Array(function(array, x)); }, arguments<T>);
      for (std::size_t i = 0; i < got.size(); ++i) {
        const double x = arguments<T>[i], want = function(scalar, x);
        const check::note at(name, "(", x, ")");
        // Below that the accuracy contract ends, and numbers become subnormal.
        if (want == 0 || std::abs(want) > (sizeof(T) == 4 ? 1e-37 : 1e-300))
          CHECK_NEAR(got[i], want, tolerance<T>);
      }
    };
#define COMPARE(name, ...) compare(name, []<class X>(const auto& d, const X& x) -> X { return __VA_ARGS__; })
    COMPARE("P22", d.P22(x));
    COMPARE("D", d.D(X(0.75), x));
    COMPARE("survival", d.survival(x));
    COMPARE("P2", d.P2(x));
    COMPARE("slope_sf", d.slope_sf(x));
    COMPARE("mean_excess", d.mean_excess(x));
    COMPARE("sigma", under_a_shape<X>(d).sigma(cosine_of(x)));
    COMPARE("Lambda", under_a_shape<X>(d).Lambda(cosine_of(x)));
#undef COMPARE
  });
}

// The Io of an array of a fixed size.
template <class Array, std::size_t Size, class Load, class Store>
struct fixed_size {
  using T = typename mf::scalar_traits<Array>::real;
  template <class Function>
  static std::vector<T> map(const Function& function, const std::vector<T>& x) {
    std::vector<T> y(x.size());
    for (std::size_t i = 0; i < x.size(); i += Size) Store{}(&y[i], function(Load{}(&x[i])));
    return y;
  }
};

}  // namespace generic
