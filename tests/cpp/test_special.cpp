// The special functions against the table of tools/tabulate_special.py, in double and float.

#include <cmath>
#include <limits>
#include <utility>

#include "check.hpp"
#include "microfacet/special/bessel.hpp"
#include "microfacet/special/bessel_complement.hpp"
#include "microfacet/special/erf.hpp"
#include "microfacet/special/exponential_integral.hpp"
#include "microfacet/special/gamma.hpp"
#include "microfacet/special/student.hpp"
#include "special_values.hpp"

namespace {

namespace mf = microfacet;

// Errors in units of the precision. What climbs a recurrence or takes the exponential of a logarithm loses
// more.
constexpr double few = 40, many = 400;

template <class T>
constexpr double exponential_lives = sizeof(T) == 4 ? 10 : 28;  // beyond it exp(-x^2) is zero

template <class T, class Function>
void compare(const char* name, double roundings, const std::vector<special_values::row>& table,
             const Function& f, double largest = mf::inf) {
  CHECK(!table.empty());
  for (const auto& [a, b, value] : table) {
    if (a > largest || (sizeof(T) == 4 && (value < 1e-36 || value > 1e37))) continue;
    const T got = f(static_cast<T>(a), static_cast<T>(b));
    const check::note at(name, sizeof(T) == 8 ? ", double (" : ", float (", a, ", ", b, ")");
    CHECK_NEAR(got, value, roundings * std::numeric_limits<T>::epsilon());
  }
}

#define COMPARE(name, roundings, ...) compare<T>(#name, roundings, special_values::name, __VA_ARGS__)

template <class T>
void error_functions() {
  COMPARE(erfc_scaled, few, [](T x, T) { return mf::erfc_scaled(x); }, exponential_lives<T>);
  COMPARE(ierfc_scaled, few, [](T x, T) { return mf::ierfc_scaled(x); }, exponential_lives<T>);
}

template <class T>
void gamma_functions() {
  COMPARE(reciprocal_gamma, few, [](T mu, T) {
    const mf::reciprocal_gamma<T> rg(mu);
    return rg.even + mu * rg.odd;
  });
  COMPARE(gamma_half_step, few, [](T k, T) { return mf::gamma_half_step(k); });
  COMPARE(beta_one_plus, many, [](T a, T b) { return mf::beta_one_plus(a, b); });
}

template <class T>
void bessel_functions() {
  const auto orders = [](T nu, T y) { return mf::bessel::orders(nu, mf::double_double<T>(y)); };
  constexpr double climbing = mf::bessel::large_order<T>;
  COMPARE(bessel_below, few, [&](T nu, T y) { return orders(nu, y).below; }, climbing);
  COMPARE(bessel_at, few, [&](T nu, T y) { return orders(nu, y).at; }, climbing);
  COMPARE(bessel_above, few, [&](T nu, T y) { return orders(nu, y).above; }, climbing);
  const auto times = [](T value, T exponent) { return value * std::exp(exponent); };
  COMPARE(debye_below, many, [&](T nu, T y) { return times(orders(nu, y).below, orders(nu, y).exponent); });
  COMPARE(debye_at, many, [&](T nu, T y) { return times(orders(nu, y).at, orders(nu, y).exponent); });
  COMPARE(debye_above, many, [&](T nu, T y) { return times(orders(nu, y).above, orders(nu, y).exponent); });
  COMPARE(bessel_complement_above, many, [&](T nu, T y) {
    const T a = nu + 1;
    return mf::bessel::complement(a, y, orders(a, y));
  });
}

// What climbs overflows in float where a large order is far out.
void large_orders_in_float() {
  for (const double order : {12.5, 39.9, 45.0, 60.0, 80.0, 150.0, 300.0, 399.0, 1000.0}) {
    for (double y = 0.01; y < 1e3; y *= 1.1) {
      const auto single =
          mf::bessel::orders(static_cast<float>(order), mf::double_double<float>(static_cast<float>(y)));
      const auto precise =
          mf::bessel::orders(static_cast<double>(static_cast<float>(order)),
                             mf::double_double<double>(static_cast<double>(static_cast<float>(y))));
      const double got = static_cast<double>(single.at * single.decay * single.decay),
                   exact = precise.at * precise.decay * precise.decay;
      const check::note at("order ", order, ", y ", y, ": ", got, ", in double ", exact);
      CHECK(std::abs(got - exact) <= (exact > 1e-9 ? 4e-6 : 2e-5) * exact + 1e-35);
    }
  }
}

// The table holds tails relative to the density A^(-k - 1/2), A = 1 + t^2/k; the functions are relative to N
// A^-k.
template <class T>
void student_functions() {
  const auto relative = [](T k, T t, const auto& function) {
    const T y = t * t / k;
    return function(k, y, std::log1p(y)) * std::sqrt(1 + y) * T(mf::sqrt_pi) / mf::gamma_half_step(k);
  };
  COMPARE(student_tail, few, [&](T k, T t) { return relative(k, t, mf::student::tail<T>); });
  COMPARE(student_excess, few, [&](T k, T t) { return relative(k, t, mf::student::excess<T>); });
}

template <class T>
void exponential_integrals() {
  // exp(-y) of a rounded y, in float too, for a double_double is exact.
  COMPARE(exponential_integral_1, few,
          [](T y, T) { return mf::exponential_integral::e1(mf::double_double<T>(y)); });
  COMPARE(exponential_integral_2, few,
          [](T y, T) { return mf::exponential_integral::e2(mf::double_double<T>(y)); });
}

// int exp(-s) s^k ds is a factorial, and at k = -1/2 the root of pi; with 1/(s + y) it is exp(y) E_1(y).
template <class T>
void exponential_means() {
  const double tolerance = few * std::numeric_limits<T>::epsilon();
  for (const auto& [power, factorial] : {std::pair(0, 1.0), std::pair(1, 1.0), std::pair(4, 24.0)})
    CHECK_NEAR(mf::exponential_mean<T>([k = T(power)](const T& s) { return T(std::pow(s, k)); }), factorial,
               tolerance);
  CHECK_NEAR(mf::exponential_mean<T>([](const T& s) { return T(1) / std::sqrt(s); }), mf::sqrt_pi, tolerance);
  CHECK_NEAR(mf::exponential_mean<T>([](const T& s) { return T(1) / (s + T(0.0625)); }), 2.4024680837171493,
             tolerance);
}

}  // namespace

TEST(error_functions) { error_functions<double>(), error_functions<float>(); }
TEST(exponential_integrals) { exponential_integrals<double>(), exponential_integrals<float>(); }
TEST(exponential_means) { exponential_means<double>(), exponential_means<float>(); }
TEST(gamma_functions) { gamma_functions<double>(), gamma_functions<float>(); }
TEST(bessel_functions) { bessel_functions<double>(), bessel_functions<float>(); }
TEST(large_orders_in_float) { large_orders_in_float(); }
TEST(student_functions) { student_functions<double>(), student_functions<float>(); }
