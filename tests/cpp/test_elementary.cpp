// Elementary functions of packs and numbers: near long double to about a rounding, exact where a value is
// known, and the same bits for every width, number of registers and neighbourhood of a lane.

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "microfacet/core/elementary.hpp"
#include "packs.hpp"

namespace {

namespace mf = microfacet;
namespace el = microfacet::elementary;
constexpr double inf = mf::inf;

template <class T>
double ulps(T got, long double want) {
  const T nearest = static_cast<T>(want);
  if (got == nearest) return 0;
  const T size = std::max(std::abs(nearest), std::numeric_limits<T>::min());
  const T unit = std::nextafter(size, std::numeric_limits<T>::infinity()) - size;
  return static_cast<double>(std::abs(static_cast<long double>(got) - want) / static_cast<long double>(unit));
}

// Random numbers between bounds: uniform, or uniform in the exponent.
struct range {
  double lower, upper;
  bool in_exponent = false;
};
template <class T>
std::vector<T> within(const std::vector<range>& ranges) {
  std::mt19937_64 bits(7);
  std::vector<T> values;
  for (const auto& [lower, upper, in_exponent] : ranges)
    for (int i = 0; i < 10000; ++i) {
      const double share = static_cast<double>(bits() >> 11) * 0x1p-53,
                   ratio = std::pow(upper / lower, share);
      values.push_back(static_cast<T>(in_exponent ? lower * ratio : lower + share * (upper - lower)));
    }
  return values;
}

// A function's worst error in units in the last place, and that no result depends on the lanes around it.
template <class T, class Function, class Truth>
void compare(const char* name, double bound, const std::vector<range>& ranges, const Function& function,
             const Truth& truth) {
  const std::vector<T> values = within<T>(ranges);
  std::vector<T> results;
  double error = 0;
  for (const T x : values) {
    results.push_back(function(x));
    error = std::max(error, ulps(results.back(), truth(static_cast<long double>(x))));
  }
  const check::note at(name, sizeof(T) == 4 ? " of float: " : " of double: ", error, " ulp");
  CHECK(error <= bound);
  packs::each<T>([&]<class Pack> { CHECK(packs::apply<Pack>(values, function) == packs::bits_of(results)); });
}

#define FUNCTION(name) [](const auto& x) { return el::name(x); }
#define TRUTH(name) [](long double x) { return std::name(x); }

// Where the hardware rounds a * b + c twice the last steps of a polynomial may cost another half each.
constexpr double more = MICROFACET_FUSED ? 0 : 1;
constexpr long double turn = 2 * 3.14159265358979323846264338327950288L;

template <class T>
void near_the_truth() {
  const bool single = sizeof(T) == 4;
  const double top = single ? 88.7 : 709.7, bottom = single ? -86.5 : -707.6;
  const double tiny = single ? 1.2e-38 : 2.3e-308, huge = single ? 3.4e38 : 1.7e308;
  compare<T>("exp", 1 + more, {{bottom, top}, {-1, 1}}, FUNCTION(exp), TRUTH(exp));
  compare<T>("expm1", 1.8 + more, {{bottom, top}, {-1, 1}, {1e-30, 1, true}}, FUNCTION(expm1), TRUTH(expm1));
  compare<T>("log", 1.2 + more, {{tiny, huge, true}, {0.5, 2}}, FUNCTION(log), TRUTH(log));
  compare<T>("log1p", 1.4 + more, {{1e-30, huge, true}, {-0.99, 1}}, FUNCTION(log1p), TRUTH(log1p));
  // The rounding of the logarithm's part below log(2)/2 counts `power` times.
  for (const double power : {2.0, -1.7, 13.25}) {
    const T y = static_cast<T>(power);
    compare<T>(
        "pow", 1.2 + 0.4 * std::abs(power) + more, {{1e-2, 1e2, true}},
        [y]<class R>(const R& x) { return el::pow(x, R(y)); },
        [y](long double x) { return std::pow(x, static_cast<long double>(y)); });
  }
  compare<T>(
      "cosine", 1.5 + more, {{0, 0.24}}, [](const auto& x) { return el::cos_sin_of_turns(x).cosine; },
      [](long double x) { return std::cos(turn * x); });
  compare<T>(
      "sine", 1.5 + more, {{0, 0.25}}, [](const auto& x) { return el::cos_sin_of_turns(x).sine; },
      [](long double x) { return std::sin(turn * x); });
}

template <class T>
bool same(T a, T b) {
  return std::isnan(a) ? std::isnan(b) : packs::bits_of<T>({a}) == packs::bits_of<T>({b});
}

template <class T, class Function>
void known(const char* name, const Function& function, const std::vector<std::pair<double, double>>& table) {
  for (const auto& [x, value] : table) {
    const T got = function(static_cast<T>(x));
    const check::note at(name, "(", x, ") is ", got, sizeof(T) == 4 ? " in float" : " in double");
    CHECK(same(got, static_cast<T>(value)));
  }
}

template <class T>
void special_values() {
  const double nan = std::nan("");
  known<T>("exp", FUNCTION(exp),
           {{0, 1}, {-0.0, 1}, {inf, inf}, {-inf, 0}, {1000, inf}, {-1000, 0}, {nan, nan}});
  known<T>("expm1", FUNCTION(expm1), {{0, 0}, {inf, inf}, {-inf, -1}, {-1000, -1}, {1000, inf}, {nan, nan}});
  known<T>("log", FUNCTION(log),
           {{1, 0}, {0, -inf}, {-0.0, -inf}, {inf, inf}, {-1, nan}, {-inf, nan}, {nan, nan}});
  const double least = std::numeric_limits<T>::min();
  known<T>("log1p", FUNCTION(log1p),
           {{0, 0},
            {least, least},
            {-1.5 * least, -1.5 * least},
            {-1, -inf},
            {inf, inf},
            {-2, nan},
            {-inf, nan},
            {nan, nan}});
  const auto power_of = [](double y) { return [y](T x) { return el::pow(x, static_cast<T>(y)); }; };
  known<T>("pow(., 2)", power_of(2),
           {{0, 0}, {1, 1}, {0.5, 0.25}, {4, 16}, {inf, inf}, {nan, nan}, {-1, nan}});
  known<T>("pow(., -1)", power_of(-1), {{0, inf}, {1, 1}, {0.25, 4}, {inf, 0}, {nan, nan}});
  known<T>("pow(., 0)", power_of(0), {{0.3, 1}, {1, 1}, {700, 1}});
  known<T>("floor", FUNCTION(floor),
           {{0, 0}, {0.5, 0}, {0.75, 0}, {1, 1}, {-0.25, -1}, {-2, -2}, {99.5, 99}});
  known<T>("abs", FUNCTION(abs), {{0, 0}, {-0.0, 0}, {-2.5, 2.5}, {-inf, inf}, {nan, nan}});
  const double c = std::sqrt(0.5);
  for (const auto& [x, cosine, sine] : std::vector<std::array<double, 3>>{{0, 1, 0},
                                                                          {0.125, c, c},
                                                                          {0.25, 0, 1},
                                                                          {0.375, -c, c},
                                                                          {0.5, -1, 0},
                                                                          {0.75, 0, -1},
                                                                          {0.875, c, -c}}) {
    const el::circle<T> got = el::cos_sin_of_turns(static_cast<T>(x));
    const check::note at_turn(x, " turns: ", got.cosine, ", ", got.sine);
    CHECK(std::abs(static_cast<double>(got.cosine) - cosine) <= std::numeric_limits<T>::epsilon() / 2);
    CHECK(std::abs(static_cast<double>(got.sine) - sine) <= std::numeric_limits<T>::epsilon() / 2);
    CHECK(std::abs(c - std::abs(static_cast<double>(got.cosine))) < 0.1 || got.cosine * got.sine == T(0));
  }
}

}  // namespace

TEST(within_a_rounding) { near_the_truth<float>(), near_the_truth<double>(); }
TEST(special_values) { special_values<float>(), special_values<double>(); }

// The nearest arguments to a limit of the range: finite and normal up to it, infinite or zero beyond.
TEST(ends_of_the_range) {
  const float top = std::log(std::numeric_limits<float>::max());
  CHECK(std::isfinite(el::exp(std::nextafter(top, 0.0f))));
  CHECK(el::exp(std::nextafter(top, 100.0f)) == static_cast<float>(inf));
  const double top_64 = std::log(std::numeric_limits<double>::max());
  CHECK(std::isfinite(el::exp(std::nextafter(top_64, 0.0))));
  CHECK(el::exp(std::nextafter(top_64, 1000.0)) == inf);
  CHECK_NEAR(el::log(std::numeric_limits<double>::max()), top_64, 2e-16);
  CHECK_NEAR(el::log(std::numeric_limits<double>::min()), std::log(std::numeric_limits<double>::min()),
             2e-16);
}

// exp, log and pow rise from one number to the next, also across the seams of the reduction.
TEST(monotonic) {
  for (int n = -20; n <= 20; ++n) {
    double x = (n + 0.5) * std::log(2.0) - 20 * 0x1p-50, before = 0;
    for (int i = 0; i < 40; ++i, x += 0x1p-50) {
      const double y = el::exp(x);
      CHECK(y >= before);
      before = y;
    }
    float root = std::ldexp(std::sqrt(0.5f), n), log_before = -1e9f;
    for (int i = 0; i < 20; ++i) root = std::nextafter(root, 0.0f);
    for (int i = 0; i < 40; ++i, root = std::nextafter(root, 1e9f)) {
      CHECK(el::log(root) >= log_before);
      log_before = el::log(root);
    }
  }
}
