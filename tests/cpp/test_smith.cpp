// The Smith layer: a family under a shape, as functions of slopes and directions.

#include "batch.hpp"
#include "check.hpp"
#include "dual.hpp"
#include "families.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"

namespace {

namespace mf = microfacet;
using autodiff::dual;
using direction = mf::vec3<double>;
constexpr double pi = mf::pi;

direction towards(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Every family and example under a shape: of its own where it takes one, under roughness 1 where alpha is a
// parameter of the density.
template <class Visitor>
void each_distribution(const Visitor& visit, families::which chosen = families::which::all) {
  families::each(
      [&]<class Tag>(const families::arguments& a) {
        const auto family = families::make<double, Tag>(a);
        using family_type = std::decay_t<decltype(family)>;
        constexpr bool stretched = family_type::shape_invariant;
        const double alpha_x = stretched ? 0.2 : 1, alpha_y = stretched ? 0.7 : 1, turn = stretched ? 0.4 : 0;
        const mf::anisotropic_shape<double> shape(alpha_x, alpha_y, std::cos(turn), std::sin(turn));
        const double last = a.empty() ? 0 : a.back();
        const check::note at(Tag::template type<double>::name, " ", last);
        visit(mf::ndf<family_type, double>(family, shape));
      },
      chosen);
}

}  // namespace

TEST(sigma_and_Lambda_on_the_sphere) {
  each_distribution([](const auto& distribution) {
    CHECK_NEAR(distribution.sigma(direction{0, 0, 1}), 1, 1e-15);
    CHECK_NEAR(distribution.sigma(direction{0, 0, -1}), 0, 1e-15);
    CHECK(distribution.Lambda(direction{1, 0, 0}) == mf::inf);
    CHECK(distribution.G1(direction{0, 0, 1}) == 1);
    for (const double theta : {0.2, 0.9, 1.4, 1.57})
      for (const double phi : {0.0, 0.5, 2.0, 4.0}) {
        const check::note at("theta = ", theta, ", phi = ", phi);
        const direction w = towards(theta, phi), below{-w.x, -w.y, -w.z};
        const double Lambda = distribution.Lambda(w);
        CHECK_NEAR(distribution.sigma(w), w.z * (1 + Lambda), 1e-14);
        CHECK_NEAR(distribution.sigma(below), w.z * Lambda, 1e-14);
        CHECK_NEAR(distribution.Lambda(below), -1 - Lambda, 1e-14);
        CHECK_NEAR(distribution.G1(w), 1 / (1 + Lambda), 1e-14);
        CHECK(distribution.G1(below) == 0);
        CHECK(distribution.D(below) == 0);
      }
  });
}

// sigma(w) is the average of max(0, w.m)/m_z over normals drawn from D cos(theta), with xi on a grid. With
// xi = 1 - v^4 the points are dense where the slopes are large; 4 v^3 dv is the measure.
TEST(sigma_is_the_mean_projected_area) {
  each_distribution([](const auto& distribution) {
    constexpr int radii = 120, azimuths = 48;
    const direction directions[]{towards(0.3, 1.0), towards(1.2, 1.0), towards(1.9, 1.0), towards(2.8, 1.0)};
    double area[4]{};
    for (int i = 0; i < radii; ++i) {
      const double v = (i + 0.5) / radii, xi = 1 - v * v * v * v, measure = 4 * v * v * v / radii / azimuths;
      for (int j = 0; j < azimuths; ++j) {
        const direction m = mf::sample_normal(distribution, xi, (j + 0.5) / azimuths);
        for (int k = 0; k < 4; ++k) area[k] += measure * std::max(0.0, mf::dot(directions[k], m)) / m.z;
      }
    }
    for (int k = 0; k < 4; ++k) CHECK(std::abs(area[k] - distribution.sigma(directions[k])) < 2e-3);
  });
}

TEST(normals_and_slopes) {
  each_distribution([](const auto& distribution) {
    for (const double theta : {0.1, 0.6, 1.3})
      for (const double phi : {0.0, 1.0, 3.0}) {
        const direction m = towards(theta, phi);
        const double density = distribution.P22(-m.x / m.z, -m.y / m.z) / (m.z * m.z * m.z * m.z);
        CHECK_NEAR(distribution.D(m), density, 1e-12);
        CHECK_NEAR(distribution.D(direction{3 * m.x, 3 * m.y, 3 * m.z}), density, 1e-12);
        CHECK_NEAR(distribution.pdf(m), density * m.z, 1e-12);
        const direction w = towards(1.0, 0.3);
        const double visible = std::max(0.0, mf::dot(m, w)) * density / distribution.sigma(w);
        CHECK_NEAR(distribution.D_visible(m, w), visible, 1e-12);
      }
    for (const double p : {-1.5, -0.2, 0.0, 0.3, 2.0}) {
      CHECK_NEAR(distribution.slope_cdf(p) + distribution.slope_cdf(-p), 1, 1e-14);
      CHECK(distribution.P2(p) >= 0);
    }
  });
}

TEST(sampled_normals_return_their_uniforms) {
  each_distribution(
      [](const auto& distribution) {
        CHECK(mf::sample_normal(distribution, 0.0, 0.3).z == 1);
        for (const double xi : {1e-6, 0.2, 0.6, 0.999})
          for (const double azimuth : {0.0, 0.1, 0.45, 0.8}) {
            const direction m = mf::sample_normal(distribution, xi, azimuth);
            CHECK_NEAR(mf::dot(m, m), 1, 1e-14);
            const auto& shape = distribution.shape();
            const double slope2 =
                shape.unit_slope2(m.x / m.z, m.y / m.z).high / (shape.unit() * shape.unit());
            CHECK_NEAR(distribution.family().survival(slope2), 1 - xi, 1e-10);
          }
        CHECK(std::isnan(mf::sample_normal(distribution, -0.1, 0.3).z));
        CHECK(std::isnan(mf::sample_normal(distribution, 1.0, 0.3).z));
      },
      families::which::with_a_density);
}

TEST(masking_and_shadowing) {
  each_distribution([](const auto& distribution) {
    const direction wi = towards(0.9, 0.3), wo = towards(1.3, 2.0), through = towards(pi - 1.3, 2.0);
    const double lambda_i = distribution.Lambda(wi), lambda_o = distribution.Lambda(wo);
    CHECK_NEAR(distribution.G2(wi, wo), 1 / (1 + lambda_i + lambda_o), 1e-14);
    CHECK_NEAR(distribution.G2(wi, wo), distribution.G2(wo, wi), 4e-16);
    CHECK(distribution.G2(wi, wo) >= distribution.G2_uncorrelated(wi, wo));
    CHECK(distribution.G2(wi, wo) <= std::min(distribution.G1(wi), distribution.G1(wo)));
    CHECK_NEAR(distribution.G2_uncorrelated(wi, wo), 1 / ((1 + lambda_i) * (1 + lambda_o)), 1e-14);
    CHECK_NEAR(distribution.G2(wi, through), std::beta(1 + lambda_i, 1 + lambda_o), 1e-12);
    CHECK(distribution.G2(towards(2.5, 0), wo) == 0);
    CHECK_NEAR(distribution.G2(direction{0, 0, 1}, wo), distribution.G1(wo), 1e-14);
  });
}

// A shape with alpha_x = alpha_y is a roughness; turning it changes nothing; turning an anisotropic one by a
// quarter exchanges its axes.
TEST(shapes) {
  const mf::ggx<double> ggx;
  const auto make = [&](double alpha_x, double alpha_y, double turn) {
    return mf::ndf<mf::ggx<double>, double>(
        ggx, mf::anisotropic_shape<double>(alpha_x, alpha_y, std::cos(turn), std::sin(turn)));
  };
  using isotropic = mf::ndf<mf::ggx<double>, double, mf::isotropic_shape<double>>;
  const isotropic round(ggx, mf::isotropic_shape<double>(0.3));
  const direction w = towards(1.1, 0.7);
  for (const double turn : {0.0, 0.8}) {
    CHECK_NEAR(make(0.3, 0.3, turn).sigma(w), round.sigma(w), 1e-15);
    CHECK_NEAR(make(0.3, 0.3, turn).D(w), round.D(w), 1e-14);
  }
  CHECK_NEAR(make(0.1, 0.5, pi / 2).Lambda(w), make(0.5, 0.1, 0).Lambda(w), 1e-14);
  CHECK_NEAR(make(0.1, 0.5, 0).P2(0.2), mf::ggx<double>().P2(2.0) / 0.1, 1e-14);
  CHECK_NEAR(make(0.1, 0.5, pi / 2).P2(0.2), mf::ggx<double>().P2(0.4) / 0.5, 1e-14);
  for (const double bad : {0.0, -1.0, mf::inf, std::nan("")}) {
    CHECK(std::isnan(make(bad, 0.3, 0).D(w)) && std::isnan(make(0.3, bad, 0).sigma(w)));
    CHECK(std::isnan(isotropic(ggx, mf::isotropic_shape<double>(bad)).Lambda(w)));
  }
}

// The derivative of sigma by the roughness at grazing incidence is that of alpha E[max(0, slope)].
TEST(derivative_by_the_roughness) {
  using distribution = mf::ndf<mf::ggx<dual>, dual, mf::isotropic_shape<dual>>;
  const distribution d(mf::ggx<dual>(), mf::isotropic_shape<dual>(dual::variable(0.3)));
  CHECK_NEAR(d.sigma(mf::vec3<dual>{dual(1), dual(0), dual(0)}).d, 0.5, 1e-14);
  // P2(p) = 1/(2 alpha (1 + p^2/alpha^2)^(3/2)) at p = 0: -1/(2 alpha^2)
  CHECK_NEAR(d.P2(dual(0)).d, -0.5 / 0.09, 1e-13);
}

TEST(batches_of_directions) {
  using batch = lanes::batch<double>;
  families::each([]<class Tag>(const families::arguments& a) {
    const check::note at(Tag::template type<double>::name);
    const auto family = families::make<double, Tag>(a);
    const auto wide_family = families::make<batch, Tag>(a);
    const mf::ndf<std::decay_t<decltype(family)>, double> one(family, {0.2, 0.7, 0.8, 0.6});
    const mf::ndf<std::decay_t<decltype(wide_family)>, batch> wide(
        wide_family, {batch(0.2), batch(0.7), batch(0.8), batch(0.6)});
    const direction given[]{towards(0.3, 1), towards(1.5, 2), towards(2.0, 3), {0, 0, 1}};
    mf::vec3<batch> w;
    for (int i = 0; i < batch::size; ++i)
      w.x.set(i, given[i].x), w.y.set(i, given[i].y), w.z.set(i, given[i].z);
    const batch D = wide.D(w), sigma = wide.sigma(w), Lambda = wide.Lambda(w), G1 = wide.G1(w);
    for (int i = 0; i < batch::size; ++i) {
      // An exponent has more digits in the one than in the other; far from 1 the contract is wider.
      const double density = one.D(given[i]);
      CHECK_NEAR(D[i], density, std::abs(std::log(density)) < 50 ? 1e-13 : 1e-12);
      CHECK_NEAR(sigma[i], one.sigma(given[i]), 1e-13);
      CHECK_NEAR(Lambda[i], one.Lambda(given[i]), 1e-13);
      CHECK_NEAR(G1[i], one.G1(given[i]), 1e-13);
    }
  });
}
