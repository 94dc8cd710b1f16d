// Densities that are no family: tables of them end where they do, their inverses reach their tails, and the slope
// across comes from shells where P2 does not fall.

#include <cmath>
#include <cstddef>
#include <memory>

#include "check.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "microfacet/tabulated/user_density.hpp"

namespace {

namespace mf = microfacet;

template <class Density>
std::unique_ptr<mf::user_density> user_density_of(const Density& P22, double upper = 85) {
  const auto at = [&](const double* L, double* f, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) f[i] = P22(std::exp(L[i]));
  };
  return std::make_unique<mf::user_density>(at, -690.0, upper, P22(0.0), false, at);
}
// What visible normals need is made of the other tables, which cost less than the density.
template <class Tables, class Family>
std::unique_ptr<Tables> tables_of(const Family& family) {
  auto tables = std::make_unique<Tables>();
  tables->build(family, mf::of_all, true);
  tables->build(mf::tabulated<typename Tables::table::real, Tables>(*tables), mf::of_visible, true);
  return tables;
}
template <class Tables, class Wide>
std::unique_ptr<Tables> narrow_of(const Wide& wide) {
  auto tables = std::make_unique<Tables>();
  tables->build(mf::tabulated<double, Wide>(wide), mf::of_all | mf::of_visible, true);
  return tables;
}

double light(double r) { return std::exp(-r * r * r * r); }
double ring(double r) { return std::exp(-(r - 1) * (r - 1) * 100); }

// Probability between 0 and q of the slope across, given that along, by a fine sum.
template <class Density>
double share(const Density& P22, double along, double q, double most = 4) {
  const auto integral = [&](double to) {
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) sum += P22(std::hypot(along, to * (i + 0.5) / n));
    return sum * to / n;
  };
  return integral(q) / integral(most);
}

}  // namespace

// exp(-r^4): cells of a map are narrow where it falls steeply, and beyond them there is nothing.
TEST(tables_of_a_light_tail_end_with_it) {
  const auto wide = tables_of<mf::radial_tables<double>>(*user_density_of(light));
  const auto narrow = narrow_of<mf::radial_tables<float>>(*wide);
  const double norm = 0.5 * std::pow(mf::pi, 1.5);
  const mf::tabulated<double> d(*wide);
  const mf::tabulated<float> s(*narrow);
  CHECK(wide->error().error < 1e-12 && narrow->error().error < 4e-6);
  for (double r = 1e-3; r < 4; r *= 1.13) {
    const check::note at("r = ", r);
    CHECK_NEAR(d.P22(r * r), light(r) / norm, 1e-12);
    CHECK_NEAR(d.survival(r * r), std::erfc(r * r), 1e-12);
    if (r < 2.5) CHECK_NEAR(s.P22(static_cast<float>(r * r)), light(static_cast<float>(r)) / norm, 1e-4);
  }
  for (const float r : {6.0F, 20.0F, 1e3F, 1e10F, 1e30F}) {
    const check::note at("r = ", r);
    CHECK(s.P2(r) == 0 && s.slope_sf(r) == 0 && s.mean_excess(r) == 0 && s.survival(r * r) == 0 &&
          s.P22(r * r) == 0);
    CHECK(d.P2(static_cast<double>(r)) == 0 && d.mean_excess(static_cast<double>(r)) == 0);
  }
  CHECK(narrow->visible.complete && narrow->visible.falls() && narrow->visible.start.steps > 0);
}

// Newton's method meets numbers that are none where such a tail has ended.
TEST(inverses_reach_the_ends_of_tails) {
  const auto wide = tables_of<mf::user_density_tables<double>>(*user_density_of(ring));
  const mf::tabulated_user_density<double> d(*wide);
  const mf::detail::visible_samples<mf::tabulated_user_density<double>> samples(d);
  for (double L = -20; L < 84; L += 4) {
    const check::note at("L = ", L);
    const double m = samples.moment_radius(L), g = samples.excess_radius(L), R = samples.marginal_radius(L);
    CHECK_NEAR(samples.moment(0.0) / samples.moment(m), 1 + std::exp(L), 1e-9);
    CHECK_NEAR(g / d.mean_excess(g), std::exp(L), 1e-9);
    CHECK_NEAR(1 / samples.P2(R), samples.inverse_peak() + std::exp(L), 1e-9);
    CHECK(R >= samples.fall());
  }
}

TEST(slopes_across_a_ring) {
  const auto wide = tables_of<mf::user_density_tables<double>>(*user_density_of(ring));
  const auto narrow = narrow_of<mf::user_density_tables<float>>(*wide);
  CHECK(!wide->visible.falls() && wide->visible.fall > 0.8 && wide->visible.fall < 1.1);
  for (const double along : {0.0, 0.3, 0.8, 0.95, 1.02})
    for (const double xi : {0.02, 0.3, 0.5, 0.8, 0.99}) {
      const check::note at("along = ", along, ", xi = ", xi);
      const double q = wide->visible.shells.across(along, xi);
      const float single = narrow->visible.shells.across(static_cast<float>(along), static_cast<float>(xi));
      CHECK(std::abs(share(ring, along, q) - xi) < 2e-5);
      CHECK_NEAR(single, q, 1e-4);
    }
}

// Two lobes with a gap between them, and an edge.
TEST(slopes_across_what_is_rough) {
  const auto lobes = [](double r) {
    return std::exp(-std::pow((r - 0.4) / 0.05, 2)) + 0.2 * std::exp(-std::pow((r - 1.5) / 0.3, 2));
  };
  const auto disc = [](double r) { return r < 1 ? 1 + r : 0.0; };
  const auto check_shells = [](const auto& P22) {
    const auto family = user_density_of(P22);
    const auto tables = tables_of<mf::user_density_tables<double>>(*family);
    const mf::tabulated_user_density<double> d(*tables);
    mf::radial_shells<double> shells;
    shells.build([&](double y) { return d.P22(mf::double_double<double>(y)); },
                 [&](double above) { return d.radius(1 - above); });
    for (const double along : {0.0, 0.2, 0.42, 0.9})
      for (const double xi : {0.1, 0.5, 0.9}) {
        const check::note at("along = ", along, ", xi = ", xi);
        CHECK(std::abs(share(P22, along, shells.across(along, xi)) - xi) < 3e-4);
      }
  };
  check_shells(lobes), check_shells(disc);
  // At an edge P2 has no digits to invert: shells alone.
  const auto tables = tables_of<mf::user_density_tables<double>>(*user_density_of(disc));
  CHECK(tables->visible.fall == mf::largest<double>());
}
