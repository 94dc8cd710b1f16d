// Chebyshev interpolation of the logarithm of a function, in the precision that a table of T needs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "microfacet/core/format.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

namespace detail {

// cos(pi k/(2 n)) for k < 4 n.
template <std::size_t N>
constexpr std::array<double, 4 * N> quarter_waves() {
  std::array<double, 4 * N> table{};
  for (std::size_t k = 0; k < 4 * N; ++k) {
    // cos is even about 0 and odd about pi/2: an argument in [0, pi/2], and Taylor's series there.
    const std::size_t j = k <= 2 * N ? k : 4 * N - k, i = j <= N ? j : 2 * N - j;
    const double x = 0.5 * pi * static_cast<double>(i) / static_cast<double>(N), x2 = x * x;
    double sum = 1;
    for (int m = 26; m > 0; m -= 2) sum = 1 - sum * x2 / (m * (m - 1));
    table[k] = i == N ? 0 : j <= N ? sum : -sum;
  }
  return table;
}

// sum_k c[k] T_k(v/half) as coefficients of the powers of v: T_k as sums of powers, added up.
template <std::size_t N>
std::array<double, N> powers(const std::array<double, N>& c, double half) {
  std::array<double, N> sum{}, before{}, now{}, next{};
  before[0] = 1, now[1] = 1;
  sum[0] = c[0], sum[1] = c[1];
  for (std::size_t k = 2; k < N; ++k) {
    next[0] = -before[0];
    for (std::size_t i = 1; i <= k; ++i) next[i] = 2 * now[i - 1] - before[i];
    before = now, now = next;
    for (std::size_t i = 0; i <= k; ++i) sum[i] += c[k] * now[i];
  }
  double scale = 1;
  for (std::size_t i = 1; i < N; ++i) sum[i] *= (scale /= half);
  return sum;
}

}  // namespace detail

// Relative errors of interpolation that count as none, near f = 1 and far from it. The polynomial itself is
// rounded by its swing, the largest abs(log(f/f(centre))).
template <class T>
struct fit_precision;
template <>
struct fit_precision<float> {
  static constexpr double error = 6e-8, far_error = 2e-6, swing = 4, far_swing = 20;
  static constexpr double rounding = 0, grid = 0x1p16;  // of centres
};
template <>
struct fit_precision<double> {
  static constexpr double error = 8e-15, far_error = 3e-13, swing = 30, far_swing = 300;
  static constexpr double rounding = 3e-16, grid = 0x1p40;
};

namespace detail {

template <class R>
double first_lane(const R& r) {
  double x;
  std::memcpy(&x, &r, sizeof x);
  return x;
}

// Calls a function of lanes for n numbers.
template <class R, class Function>
void in_lanes(const double* x, double* f, std::size_t n, const Function& function) {
  constexpr std::size_t width = sizeof(R) / sizeof(double);
  std::array<double, width> in, out;
  for (std::size_t i = 0; i < n; i += width) {
    for (std::size_t j = 0; j < width; ++j) in[j] = x[(std::min)(i + j, n - 1)];
    R a;
    std::memcpy(&a, in.data(), sizeof a);
    const R b = function(a);
    std::memcpy(out.data(), &b, sizeof b);
    std::copy_n(out.data(), (std::min)(width, n - i), f + i);
  }
}

}  // namespace detail

// Any function that stores f(exp(L[i])) for i < n: a table is fitted by one piece of code, whatever is
// sampled.
class sampled_function {
 public:
  template <class Function>
    requires(!std::is_same_v<Function, sampled_function>)
  sampled_function(const Function& function)
      : function_(&function), call_([](const void* f, const double* L, double* values, std::size_t n) {
          (*static_cast<const Function*>(f))(L, values, n);
        }) {}
  void operator()(const double* L, double* values, std::size_t n) const { call_(function_, L, values, n); }

 private:
  const void* function_;
  void (*call_)(const void*, const double*, double*, std::size_t);
};

// Where f is to be met, in L = log x: from `lower` to `upper`, with a piece for of_root down to twice
// `lower` if `roots`. Above, f goes on as a power of x; where it falls below `least`, it ends. Below `lower`
// it is f(0). `inside` is an L at which f is neither huge nor tiny. Errors are near ones where abs(log f) <
// `central`. `any` is for functions that may bend sharply or are known to fewer digits: cells of a map may then be
// narrower, and where the precision wanted is out of reach the table is as good as it gets.
struct fit_range {
  double lower, upper, inside, at_zero, least, central;
  bool roots = false, any = false;
};

// The last L on the way from one to another up to which inside(L, f) holds, if it does at `from`: by
// sections, all points of one at a time, to 16^-rounds of the way.
template <class Inside>
double reach(const sampled_function& sample, double from, double to, int rounds, const Inside& inside) {
  constexpr std::size_t points = 16;
  for (int round = 0; round < rounds; ++round) {
    std::array<double, points> at, f;
    for (std::size_t i = 0; i < points; ++i) at[i] = from + (to - from) * static_cast<double>(i + 1) / points;
    sample(at.data(), f.data(), points);
    std::size_t i = 0;
    while (i < points && elementary::is_number(f[i]) && inside(at[i], f[i])) ++i;
    if (i == points) return to;
    to = at[i];
    if (i > 0) from = at[i - 1];
  }
  return from;
}

// log(f/reference) of L on [centre - half, centre + half] by values in N nodes; where f is not positive
// there, no fit. The error is measured where it is largest: at some extrema of T_N, the ends among them.
template <class T, std::size_t N>
struct interpolant {
  using limits = fit_precision<T>;
  static constexpr auto waves = detail::quarter_waves<N>();

  double centre = 0, half = 0, reference = 1;
  double excess = 1e30, wide = 0;  // the error and the swing over what is allowed, as powers of the width
  std::array<double, N> chebyshev{};

  static double on_grid(double L) { return std::round(L * limits::grid) / limits::grid; }

  // Near is abs(log f) < central.
  static double allowed(double f, double swing, double central) {
    const double size = std::abs(std::log(f));
    return (size > central ? limits::far_error : limits::error) + limits::rounding * (size + std::abs(swing));
  }

  static interpolant fit(const sampled_function& sample, double a, double b, const fit_range& range) {
    interpolant p;
    p.centre = on_grid(0.5 * (a + b));
    p.half = p.centre - a;
    constexpr std::array<std::size_t, 5> extrema{0, 1, N / 2, N - 1, N};
    constexpr std::size_t points = N + extrema.size();
    std::array<double, points> at, f, t;
    for (std::size_t j = 0; j < N; ++j) at[j] = p.centre + p.half * waves[2 * j + 1];
    for (std::size_t j = N; j < points; ++j) at[j] = p.centre + p.half * waves[2 * extrema[j - N]];
    sample(at.data(), f.data(), points);
    if (!std::all_of(f.begin(), f.end(), elementary::is_positive_number)) return p;
    p.reference = f[N / 2];
    double swing = 0, worst = 0;
    for (std::size_t j = 0; j < points; ++j) {
      t[j] = std::log(f[j] / p.reference);
      swing = (std::max)(swing, std::abs(t[j]));
    }
    for (std::size_t k = 0; k < N; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < N; ++j) sum += t[j] * waves[k * (2 * j + 1) % (4 * N)];
      p.chebyshev[k] = sum * (k == 0 ? 1.0 : 2.0) / static_cast<double>(N);
    }
    // Of the values the one nearest 1, as near as it comes.
    const double size = (std::min)(std::abs(std::log(f.front())), std::abs(std::log(f[N - 1])));
    const double bound = allowed(std::exp(size), swing, range.central);
    for (std::size_t j = N; j < points; ++j) {
      double error = -t[j];
      for (std::size_t k = 0; k < N; ++k) error += p.chebyshev[k] * waves[2 * k * extrema[j - N] % (4 * N)];
      const double excess = std::abs(error) / bound;
      if (!(excess <= worst)) worst = excess;  // a nan stays
    }
    p.wide =
        std::pow(swing / (size > range.central ? limits::far_swing : limits::swing), static_cast<double>(N));
    if (worst < p.excess) p.excess = worst;
    return p;
  }

  // Coefficients of the powers of L - centre.
  std::array<double, N> powers() const { return detail::powers(chebyshev, half); }
};

}  // namespace microfacet
