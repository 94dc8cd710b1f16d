// Prepared tables against the family that they were built from.

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "microfacet/family/all.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace {

namespace mf = microfacet;

template <class T>
constexpr bool single = sizeof(T) == 4;

static_assert(std::is_trivially_copyable_v<mf::radial_tables<float>>);
// All that is no sampler of visible normals fits in the first cache.
static_assert(sizeof(mf::radial_tables<double>) - sizeof(mf::visible_tables<double>) <= 32 * 1024);

// The accuracy contract of prepared densities: near 1, and where the value is far from it.
template <class T>
void check_value(const char* name, double got, double want) {
  const double least = single<T> ? 1e-37 : 1e-300;
  if (!(want >= least && want <= 1 / least)) return;
  const bool far = std::abs(std::log(want)) > (single<T> ? 20 : 50);
  const check::note nan_unless(name);
  CHECK_NEAR(got, want, single<T> ? (far ? 5e-5 : 4e-6) : (far ? 1e-12 : 1e-13));
}

std::vector<double> spread(double from, double to, int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(from * std::pow(to / from, i / (n - 1.0)));
  return x;
}

template <class T, class Distribution, class Exact>
void check_cosines(const Distribution& d, const Exact& e) {
  std::vector<double> cosines = spread(1e-12, 1, 25);
  for (const double below : spread(1e-16, 0.5, 12)) cosines.push_back(1 - below);
  for (const double exact : cosines) {
    const T u = static_cast<T>(exact);
    const check::note at("u = ", u);
    const auto both = [&](const char* name, const auto& function) {
      check_value<T>(name, function(d, mf::cosine<T>(u)), function(e, mf::cosine<double>(u)));
    };
    both("D", [](const auto& ndf, const auto& c) { return ndf.D(c); });
    both("sigma", [](const auto& ndf, const auto& c) { return ndf.sigma(c); });
    both("Lambda", [](const auto& ndf, const auto& c) { return ndf.Lambda(c); });
    both("G1", [](const auto& ndf, const auto& c) { return ndf.G1(c); });
    check_value<T>("sigma from below", d.sigma(mf::cosine<T>(-u)), e.sigma(mf::cosine<double>(-u)));
    if (u < 1)
      check_value<T>("sample_slope", mf::sample_slope(d.family(), d.shape(), u),
                     mf::sample_slope(e.family(), e.shape(), static_cast<double>(u)));
  }
}

template <class T, class Distribution, class Exact>
void check_slopes(const Distribution& d, const Exact& e, double alpha) {
  for (const double exact : spread(1e-20 * alpha, 1e6 * std::max(alpha, 1.0), 30)) {
    const T p = static_cast<T>(exact);
    const check::note at("slope = ", p);
    const auto both = [&](const char* name, const auto& function) {
      check_value<T>(name, function(d, p), function(e, static_cast<double>(p)));
    };
    both("P22", [](const auto& ndf, auto x) { return ndf.P22(x, 0.25f * x); });
    both("P2", [](const auto& ndf, auto x) { return ndf.P2(x); });
    both("slope_cdf", [](const auto& ndf, auto x) { return ndf.slope_cdf(x); });
    both("slope_cdf of the tail", [](const auto& ndf, auto x) { return ndf.slope_cdf(-x); });
    both("survival", [](const auto& ndf, auto x) { return mf::survival(ndf, x); });
  }
}

template <class T, class Family>
void check_family(const Family& family, double alpha) {
  static mf::radial_tables<T> tables;
  tables.build(family);
  const mf::radial_error error = tables.error(mf::of_all);
  const check::note at("errors measured ", error.error, " and ", error.far_error);
  CHECK(tables.good(mf::of_all));
  const double stretch = Family::shape_invariant ? static_cast<double>(static_cast<T>(alpha)) : 1;
  using view = mf::tabulated<T>;
  const mf::ndf<view, T, mf::isotropic_shape<T>> d(view(tables),
                                                   mf::isotropic_shape<T>(static_cast<T>(stretch)));
  const mf::ndf<Family, double, mf::isotropic_shape<double>> e(family, mf::isotropic_shape<double>(stretch));
  check_cosines<T>(d, e);
  check_slopes<T>(d, e, alpha);
}

template <class T>
void check_families() {
  for (const double alpha : {1e-4, 0.02, 0.5, 10.0}) {
    const check::note at("alpha = ", alpha);
    for (const double gamma : {1.5001, 1.7, 3.0, 40.0, 1e6}) {
      const check::note shape("student_t gamma = ", gamma);
      check_family<T>(mf::student_t<double>(gamma), alpha);
    }
    for (const double a : {0.05, 0.5, 1.0, 1.3, 12.0, 150.0}) {
      const check::note shape("bessel_k a = ", a);
      check_family<T>(mf::bessel_k<double>(a), alpha);
    }
    for (const double gamma : {0.25, 1.0, 1.9, 6.0}) {
      const check::note shape("gtr gamma = ", gamma);
      check_family<T>(mf::gtr<double>(alpha, gamma), alpha);
    }
  }
}

}  // namespace

TEST(tables_of_float32) { check_families<float>(); }
TEST(tables_of_float64) { check_families<double>(); }

TEST(tables_beyond_their_ends) {
  static mf::radial_tables<float> tables;
  tables.build(mf::student_t<double>(2.5));
  const mf::tabulated<float> family(tables);
  const mf::student_t<double> exact(2.5);
  const float infinite = mf::inf;
  CHECK_NEAR(family.survival(0.0f), 1, 0);
  CHECK_NEAR(family.slope_sf(0.0f), 0.5, 0);
  CHECK_NEAR(family.mean_excess(0.0f), exact.mean_excess(0.0), 1e-7);
  CHECK(family.survival(infinite) == 0 && family.P22(infinite) == 0);
  CHECK(family.slope_sf(infinite) == 0 && family.slope_sf(-infinite) == 1);
  CHECK(std::isnan(family.survival(mf::nan<float>())) && std::isnan(family.slope_sf(mf::nan<float>())));
  CHECK(std::isnan(family.D(mf::nan<float>(), 1.0f)));
}

TEST(tables_are_built_one_by_one) {
  static mf::radial_tables<double> tables;
  const mf::student_t<double> family(3.0);
  tables.build(family, mf::of_mean_excess);
  CHECK(tables.good(mf::of_mean_excess) && !tables.good(mf::of_P22) && !tables.good(mf::of_all));
  tables.build(family, mf::of_P22);
  CHECK(tables.good(mf::of_P22 | mf::of_mean_excess));
}

// Whatever the parameters, a build ends; a table that could not be met says so, and is nan.
TEST(tables_of_extreme_parameters) {
  const auto check = [](const auto& family) {
    static mf::radial_tables<double> wide;
    static mf::radial_tables<float> narrow;
    wide.build(family, mf::of_all | mf::of_visible), narrow.build(family, mf::of_all | mf::of_visible);
    for (const auto* t : {&wide.root_D, &wide.survival, &wide.radius, &wide.root_P2, &wide.slope_sf,
                          &wide.mean_excess, &wide.visible.moment_radius, &wide.visible.marginal_radius})
      for (const double x : {1e-30, 1e-3, 1.0, 1e5})
        CHECK(t->error < mf::inf || std::isnan((*t)(mf::double_double<double>(x))));
  };
  for (const double shape : {1e-300, 1e-3, 1e5, 1e100}) {
    const check::note at("shape ", shape);
    check(mf::bessel_k<double>(shape)), check(mf::student_t<double>(1.5 + shape));
    for (const double alpha : {1e-160, 1e-10, 1e100}) check(mf::gtr<double>(alpha, shape));
  }
}

TEST(a_table_of_nothing_is_not_good) {
  static mf::radial_tables<double> tables;  // never built
  CHECK(!tables.good(mf::of_P22) && !tables.good(mf::of_radius | mf::of_visible));
  // The tables of the mixture in float32, where P2 has a cusp: of slopes that matter, not of the least ones.
  static mf::radial_tables<float> narrow;
  for (const double a : {0.5003, 0.5192, 0.55, 0.5966, 0.66}) {
    const check::note at("a = ", a);
    narrow.build(mf::bessel_k<double>(a), mf::of_all | mf::of_visible);
    CHECK(narrow.good(mf::of_all) && narrow.visible.complete);
    CHECK_NEAR(mf::bessel_k<double>(a).P2(
                   static_cast<double>(narrow.visible.marginal_radius(mf::double_double<float>(1.0F)))),
               1 / (1.0 + static_cast<double>(narrow.visible.inverse_P2)), 1e-5);
  }
}
