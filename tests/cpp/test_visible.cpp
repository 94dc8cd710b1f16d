// Visible normals: the slope in the plane of incidence is the quantile that the family's own tails say, the
// one across it has the conditional density that P22 says, and neither hostile uniforms nor hostile
// directions give anything but unit normals that face the direction.

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "families.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "packs.hpp"

namespace mf = microfacet;
using direction = mf::vec3<double>;

namespace {

const std::vector<double> cotangents{1e15, 50, 3, 1, 0.2, 1e-3, 1e-9, 0, -1e-4, -0.3, -1, -3};
const std::vector<double> uniforms{1e-12, 1e-6, 0.01, 0.2, 0.45, 0.7, 0.9};

// Pr(slope > P) of the slopes that x sees, and their density.
template <class Family>
std::array<double, 2> seen(const Family& family, double x, double P) {
  const double t = std::abs(P), sf = family.slope_sf(mf::slope<double>(t)),
               excess = family.mean_excess(mf::slope<double>(t)),
               below = family.mean_excess(mf::slope<double>(std::abs(x))), all = std::max(x, 0.0) + below,
               density = (x + P) * family.P2(mf::slope<double>(t)) / all;
  if (P >= 0) return {((x + P) * sf + excess) / all, density};
  return {1 - ((x - t) * sf - excess + below) / all, density};
}

// One family at a time; Bessel K and GTR also from tables.
template <class Visit>
void each_family(const Visit& visit) {
  families::each([&]<class Tag>(const families::arguments& a) {
    const auto family = families::make<double, Tag>(a);
    const check::note at(Tag::template type<double>::name, " ", a.empty() ? 0.0 : a.front(), " ",
                         a.empty() ? 0.0 : a.back());
    visit(family);
  });
}

// Whether the slope across is a part of a length in three dimensions, or a quantile of its own.
template <class Family>
bool by_length(const Family& family) {
  return mf::visible_tails<Family, double>(family).lifts(0.0);
}

double spacing(double p) { return std::nextafter(std::abs(p), mf::inf) - std::abs(p); }

}  // namespace

namespace {

// What a direction sees from `family`, by the tails of `reference`.
template <class Family, class Reference>
void check_quantiles(const Family& family, const Reference& reference) {
  for (const double x : cotangents) {
    if (reference.mean_excess(mf::slope<double>(std::abs(x))) < 1e-280 && x < 0) continue;
    for (const double xi : uniforms) {
      const check::note at("x = ", x, ", xi = ", xi);
      const double P = mf::detail::solve_visible_slopes(family, x, xi, 0.5, 0.5, x <= 0).along;
      const auto [above, density] = seen(reference, x, P);
      CHECK(P >= -x);
      // The reference subtracts near the ends, and P - |x| carries the rounding of x.
      const double rounding = 1e-15 / std::min(1.0, std::max(x, 1e-3)) + 1e-13;
      CHECK(std::abs(above - xi) <= 1e-11 * std::min(xi, 1 - xi) + rounding * xi + 4 * spacing(P) * density);
    }
  }
}
// By the family's own functions, and from its tables where they keep the contract.
template <class Family>
void check_both_ways(const Family& family) {
  check_quantiles(family, family);
  static mf::radial_tables<double> tables;
  tables.build(family, mf::of_all | mf::of_visible);
  if (tables.good(mf::of_all)) check_quantiles(mf::tabulated<double>(tables), family);
}

}  // namespace

TEST(slope_in_the_plane_is_the_quantile) {
  each_family([&]<class Family>(const Family& family) {
    if constexpr (Family::tabulate == mf::of_all || Family::tabulate == (mf::of_all & ~mf::of_P22)) {
      check_both_ways(family);
    } else if constexpr (mf::tail_quotients<Family>) {
      check_quantiles(family, family);
    }
  });
}

// A cusp at 0, tails that bend beyond what tables hold, the limits of shapes, a ring of slopes.
TEST(slope_in_the_plane_is_the_quantile_of_hard_shapes) {
  for (const double a : {0.03, 0.5007, 0.5192, 0.5966, 0.71, 2e5, 1e30}) {
    const check::note at("bessel_k a = ", a);
    check_both_ways(mf::bessel_k<double>(a));
  }
  for (const auto& [alpha, gamma] : std::vector<std::array<double, 2>>{
           {1e-4, 15.0}, {1e-3, 60.0}, {0.02, 180.0}, {10.0, 20.0}, {100.0, 10.0}, {1e-30, 1.2}}) {
    const check::note at("gtr alpha = ", alpha, ", gamma = ", gamma);
    check_both_ways(mf::gtr<double>(alpha, gamma));
  }
}

// Given the slope in the plane, the one across it has the distribution int P22(P, q) dq/P2(P).
TEST(slope_across_the_plane_is_conditional) {
  each_family([](const auto& family) {
    if constexpr (!mf::closed_visible_sampling<std::decay_t<decltype(family)>>) {
      for (const double x : {2.0, 0.1, -0.5}) {
        // The distribution function at q is the mean over xi1 of arccos(q/rest)/pi.
        const double P = mf::detail::solve_visible_slopes(family, x, 0.4, 0.5, 0.5, x <= 0).along,
                     q = 0.7 * (1 + std::abs(P));
        constexpr int steps = 400;
        double below = 0, mass = 0;
        for (int i = 0; i < steps; ++i) {
          const double v = (i + 0.5) / steps, xi1 = 1 - v * v, measure = 2 * v / steps;
          // At xi2 = 0 it is the radius itself (or for Beckmann the quantile of xi1).
          const double rest = mf::detail::solve_visible_slopes(family, x, 0.4, xi1, 0.0, x <= 0).across;
          below +=
              measure * (by_length(family) ? std::acos(std::clamp(q / std::abs(rest), -1.0, 1.0)) / mf::pi
                                           : 0.5 * (std::abs(rest) > q));
        }
        constexpr int nodes = 4000;
        for (int i = 0; i <= nodes; ++i) {
          const double y = q * i / nodes;
          mass += (i == 0 || i == nodes ? 0.5 : 1.0) * family.P22(mf::double_double<double>(P * P + y * y)) *
                  q / nodes;
        }
        const double expected = 0.5 - mass / family.P2(mf::slope<double>(std::abs(P)));
        // A quantile ends between two steps.
        const double error = by_length(family) ? 1e-3 : 2.0 / steps;
        if constexpr (!mf::quantile_across<std::decay_t<decltype(family)>>)
          CHECK(std::abs(below - expected) < error);
      }
    }
  });
}

TEST(hostile_uniforms_and_directions) {
  constexpr std::array xi{0.0, 5e-324, 1e-30, 0x1p-53, 0.5, 1 - 0x1p-53};
  const std::array w{direction{0, 0, 1},       direction{1, 0, 0},        direction{0, -1, 0},
                     direction{1e-30, 0, 1},   direction{1e-3, 1e-3, 1},  direction{0.6, 0, -0.8},
                     direction{1, 0, -1e-20},  direction{0.8, 0.6, 1e-9}, direction{1e-3, 0, -1},
                     direction{0.6, 0, 0.8001}};
  each_family([&]<class Family>(const Family& family) {
    if constexpr (Family::tabulate == 0 || mf::tail_quotients<Family>) {
      const mf::anisotropic_shape<double> shape(0.1, 0.6, 0.8, 0.6);
      const mf::ndf<Family, double> distribution(family, shape);
      for (const direction& d : w)
        for (const double a : xi)
          for (const double b : xi)
            for (const double c : xi)
              for (const bool mixture : {false, true}) {
                const check::note at("w = ", d.x, " ", d.y, " ", d.z, ", xi = ", a, " ", b, " ", c);
                const direction m = mixture ? mf::sample_visible_mixture(distribution, d, a, b, c, b)
                                            : mf::sample_visible(distribution, d, a, b, c);
                if (Family::singular && !(distribution.sigma(d) > 0)) {  // a ring from far below
                  CHECK(std::isnan(m.z));
                  continue;
                }
                CHECK(std::abs(std::sqrt(mf::dot(m, m)) - 1) <= 1e-15);
                CHECK(m.z > 0);
                CHECK(mf::dot(m, d) >= -1e-14);
              }
      const direction down{0, 0, -1};
      CHECK(std::isnan(mf::sample_visible(distribution, down, 0.5, 0.5, 0.5).z));
      for (const double bad : {-0.1, 1.0, std::nan("")})
        CHECK(std::isnan(mf::sample_visible(distribution, w[0], bad, 0.5, 0.5).z));
    }
  });
}

// In any pack, next to any neighbours, a lane has the bits that it has elsewhere.
TEST(lanes_know_no_neighbours) {
  std::vector<float> values(257);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>((static_cast<double>(i) + 0.5) / static_cast<double>(values.size()));
  const auto check = [&]<template <class> class Family>(auto... parameters) {
    std::vector<std::vector<std::int32_t>> results;
    packs::each<float>([&]<class Pack>() {
      const Family<Pack> family(Pack(static_cast<float>(parameters))...);
      const mf::isotropic_shape<Pack> shape(mf::double_double<Pack>(Pack(0.5F)));
      const mf::ndf<Family<Pack>, Pack, mf::isotropic_shape<Pack>> distribution(family, shape);
      results.push_back(packs::apply<Pack>(values, [&](const Pack& xi) {
        const Pack z = Pack(2) * xi - Pack(1.02F), x = sqrt(Pack(1) - z * z * Pack(0.95F));
        return mf::sample_visible(distribution, mf::vec3<Pack>{x, Pack(0.1F), z}, Pack(1) - xi, xi, xi).x;
      }));
    });
    for (const auto& bits : results) CHECK(bits == results.front());
  };
  check.operator()<mf::beckmann>();
  check.operator()<mf::ggx>();
  check.operator()<mf::k0>();
  check.operator()<mf::student_t>(2.5);
  check.operator()<mf::student_t>(3.0);
}

// J(g)/g = 1/v and M(P) = (1 - xi) M(g) as the tables of float32 have them, and the length of a slope in
// three dimensions: P2(R) = (1 - xi) P2(P).
TEST(tables_of_the_mixture_scheme) {
  each_family([]<class Family>(const Family& family) {
    if constexpr (Family::tabulate != 0) {
      static mf::radial_tables<float> tables;
      tables.build(family, mf::of_all | mf::of_visible);
      const mf::tabulated<float> tabulated(tables);
      if (!tabulated.samples_from_tables()) return;
      const auto J = [&](double t) { return family.mean_excess(mf::slope<double>(t)); };
      const auto M = [&](double t) { return J(t) + t * family.slope_sf(mf::slope<double>(t)); };
      const auto P2 = [&](double t) { return family.P2(mf::slope<double>(t)); };
      for (const float v : {1e-6f, 1e-2f, 0.7f, 4.0f, 300.0f, 1e6f}) {
        const check::note at("v = ", v);
        const double g = tabulated.excess_radius(v);
        CHECK_NEAR(g / J(g), v, 4e-6 * std::max(1.0, g * g));
        for (const float xi : {0.01f, 0.5f, 0.95f}) {
          const double P = tabulated.moment_beyond(static_cast<float>(g), xi);
          const double rest = tabulated.across_of_tables(static_cast<float>(P), xi, 0.0f),
                       R = std::hypot(P, rest);
          CHECK_NEAR(M(P), (1 - static_cast<double>(xi)) * M(g), 4e-6 * std::max(1.0, P * P));
          if (P >= static_cast<double>(tables.visible.fall))  // below it shells say how long
            CHECK_NEAR(P2(R), (1 - static_cast<double>(xi)) * P2(P), 4e-6 * std::max(1.0, R * R));
        }
      }
    }
  });
}
