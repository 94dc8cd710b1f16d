// A density whose shape parameters are fixed, prepared: the functions of family/radial.hpp as piecewise
// polynomials, built once from the family itself, to the precision of the type that stores them. Evaluation
// costs the same for every family. Tables have a fixed capacity and are plain values.
//
//   radial_tables<float> tables;
//   tables.build(bessel_k<double>(0.7));
//   prepared<bessel_k<double>, float> family(tables);            // a radial_family; refers to the tables
//   prepared<bessel_k<double>, pack<float, 64>> lanes(tables);   // the same on packs
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "microfacet/core/math.hpp"
#include "microfacet/core/piecewise.hpp"
#include "microfacet/core/piecewise_fit.hpp"
#include "microfacet/core/twofold.hpp"
#include "microfacet/family/radial.hpp"

namespace microfacet {

// Functions of a density, to be combined with |: tables are built and judged one by one.
enum radial_function : unsigned {
  of_P22 = 1,
  of_survival = 2,
  of_radius = 4,
  of_P2 = 8,
  of_slope_sf = 16,
  of_slope_excess = 32,
  of_all = 63
};

// The largest relative errors, measured on the tables themselves, near 1 and beyond exp(20) (float) or exp(50).
struct radial_error {
  double near = 0, far = 0;
};

template <class T>
class radial_tables {
  static constexpr bool single = sizeof(T) == 4;

 public:
  #ifndef NF
#define NF 10
#define ND 18
#endif
  using table = piecewise<T, 32, single ? NF : ND>;

  table root_P22;      // the square root of P22 at r2: D = (sqrt(P22)/z^2)^2 where P22 itself underflows
  table survival;      // at r2
  table radius;        // at the odds xi/(1 - xi)
  table P2, slope_sf;  // at t > 0
  table slope_excess;  // at t^2

  // From a family in double precision, scalar or pack.
  template <class Family>
  void build(const Family& family, unsigned functions = of_all);

  radial_error error(unsigned functions) const {
    radial_error e;
    each(functions, [&e](const table& t) {
      e.near = std::max(e.near, t.error), e.far = std::max(e.far, t.far_error);
    });
    return e;
  }
  // Whether these functions keep the accuracy contract with a margin.
  bool good(unsigned functions) const {
    const radial_error e = error(functions);
    return e.near <= (single ? 2e-6 : 5e-14) && e.far <= (single ? 2.5e-5 : 6e-13);
  }

 private:
  template <class Use>
  void each(unsigned functions, const Use& use) const {
    if (functions & of_P22) use(root_P22);
    if (functions & of_survival) use(survival);
    if (functions & of_radius) use(radius);
    if (functions & of_P2) use(P2);
    if (functions & of_slope_sf) use(slope_sf);
    if (functions & of_slope_excess) use(slope_excess);
  }
};

namespace detail {

// Calls a function of lanes for n numbers.
template <class R, class Function>
void in_lanes(const double* x, double* f, int n, const Function& function) {
  constexpr int width = sizeof(R) / sizeof(double);
  std::array<double, width> in, out;
  for (int i = 0; i < n; i += width) {
    for (int j = 0; j < width; ++j) in[j] = x[std::min(i + j, n - 1)];
    R a;
    std::memcpy(&a, in.data(), sizeof a);
    const R b = function(a);
    std::memcpy(out.data(), &b, sizeof b);
    for (int j = 0; j < width && i + j < n; ++j) f[i + j] = out[j];
  }
}

template <class R>
double first_lane(const R& r) {
  double x;
  std::memcpy(&x, &r, sizeof x);
  return x;
}

template <class Family>
class radial_samples {
  using R = typename Family::scalar;

 public:
  explicit radial_samples(const Family& family) : family_(family) {}

  R root_P22(const R& L) const {
    const R r = elementary::exp(R(R(0.5) * L));
    const auto inner = [&] {
      if constexpr (requires { family_.P22_of_slope(r); }) {
        return sqrt(family_.P22_of_slope(r));
      } else {
        return sqrt(family_.P22(twofold<R>(r * r)));
      }
    };
    // Beyond 1 through D at a small cosine, where it underflows much later.
    const R z(0x1p-64), z2 = z * z;
    const auto outer = [&] { return R(sqrt(family_.D(z, twofold<R>(r * r * z2))) * z2); };
    return choose(r <= R(1), inner, outer);
  }
  R survival(const R& L) const { return family_.survival(square_of(elementary::exp(R(R(0.5) * L)))); }
  R P2(const R& L) const { return family_.P2(slope<R>(elementary::exp(L))); }
  R slope_sf(const R& L) const { return family_.slope_sf(slope<R>(elementary::exp(L))); }
  R slope_excess(const R& L) const { return family_.slope_excess(slope<R>(elementary::exp(R(R(0.5) * L)))); }

  // Above the median xi = 1 - rest loses what rest has: Newton's method on log survival against log r^2.
  R radius(const R& L) const {
    const R odds = elementary::exp(L), xi = minimum(R(odds / (R(1) + odds)), R(1 - 0x1p-53));
    R start;
    if constexpr (requires { family_.radius(xi); }) {
      start = family_.radius(xi);
    } else {
      start = sqrt(family_.radius2(xi));
    }
    const auto refine = [&] {
      R M = R(2) * log(start);
      for (int i = 0; i < 4; ++i) {
        const twofold<R> r2 = square_of(elementary::exp(R(R(0.5) * M)));
        const R above = family_.survival(r2), change = log(above * (R(1) + odds)) * above / (R(pi) * r2.high * family_.P22(r2));
        M = M + minimum(maximum(change, R(-2)), R(2));
      }
      return R(elementary::exp(R(R(0.5) * M)));
    };
    return choose((L > R(0)) & (start < R(1e100)), refine, [&] { return start; });
  }

 private:
  static twofold<R> square_of(const R& r) { return exact_product(r, r); }
  const Family& family_;
};

}  // namespace detail

template <class T>
template <class Family>
void radial_tables<T>::build(const Family& family, unsigned functions) {
  using R = typename Family::scalar;
  // Logarithms of the smallest slope, of its square, and of slopes and squares beyond which all is a power.
  constexpr double least = single ? -87 : -700, slope_end = single ? 46 : 60, square_end = 2 * slope_end;
  constexpr double tiny = std::numeric_limits<T>::min();
  const detail::radial_samples<Family> samples(family);
  const auto fill = [](table& t, const auto& function, const fit_range& range) {
    const auto sample = [&](const double* L, double* f, int n) { detail::in_lanes<R>(L, f, n, function); };
    t = piecewise_fit<table, decltype(sample)>(sample, range)();
  };
  const auto first = [](const R& r) { return detail::first_lane(r); };
  const R zero(0);
  if (functions & of_P22)
    fill(root_P22, [&](const R& L) { return samples.root_P22(L); },
         {2 * least, least, square_end, std::sqrt(first(family.P22(twofold<R>(zero)))), single ? tiny : 1e-180});
  if (functions & of_survival)
    fill(survival, [&](const R& L) { return samples.survival(L); }, {2 * least, least, square_end, 1, tiny});
  if (functions & of_radius)
    fill(radius, [&](const R& L) { return samples.radius(L); }, {least, 0, single ? 17 : 37, 0, 0});
  if (functions & of_P2)
    fill(P2, [&](const R& L) { return samples.P2(L); },
         {least, least, slope_end, first(family.P2(slope<R>(zero))), tiny});
  if (functions & of_slope_sf)
    fill(slope_sf, [&](const R& L) { return samples.slope_sf(L); }, {least, least, slope_end, 0.5, tiny});
  if (functions & of_slope_excess)
    fill(slope_excess, [&](const R& L) { return samples.slope_excess(L); },
         {least, least, square_end, first(family.slope_excess(slope<R>(zero))), tiny});
}

// The functions of Family with their parameters fixed, on scalars R, from tables that must outlive it.
template <class Family, class R>
class prepared {
 public:
  using scalar = R;
  using tables = radial_tables<typename scalar_traits<R>::real>;
  static constexpr auto name = Family::name;
  static constexpr auto parameters = Family::parameters;
  static constexpr auto sources = Family::sources;
  static constexpr bool shape_invariant = Family::shape_invariant;
  static constexpr bool native_float32 = true;

  explicit prepared(const tables& t) : t_(&t) {}

  R nothing() const { return R(0); }
  R P22(const twofold<R>& r2) const { return square(t_->root_P22(r2)); }
  R P22_of_slope(const R& r) const { return square(t_->root_P22.of_small_root(r)); }
  R survival_of_slope(const R& r) const { return t_->survival.of_small_root(r); }
  R D(const R& z_argument, const twofold<R>& h2) const {
    const R z = maximum(z_argument, R(1) / largest_slope<R>()), reciprocal = R(1) / (z * z);
    return square(R(t_->root_P22(quotient(h2, exact_product(z, z), reciprocal)) * reciprocal));
  }
  R survival(const twofold<R>& r2) const { return t_->survival(r2); }
  R radius(const R& xi) const { return t_->radius(quotient(twofold<R>(xi), exact_sum_of_ordered(R(1), R(-xi)))); }
  R radius2(const R& xi) const { return square(radius(xi)); }
  R P2(const slope<R>& t) const { return t_->P2(abs(t.value)); }
  R slope_sf(const slope<R>& t) const {
    return symmetric_sf(t, [this](const slope<R>& x) { return t_->slope_sf(x.value); });
  }
  R slope_excess(const slope<R>& x) const { return t_->slope_excess(x.squared); }

 private:
  const tables* t_;
};

}  // namespace microfacet
