// Materials from the headers alone: Fresnel's equations against complex arithmetic, single scattering of a
// pair of directions and of walks of one order, the white furnace through evaluation, and random numbers
// against their published values.

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <memory>

#include "check.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/diffuse.hpp"
#include "microfacet/bsdf/single_scattering.hpp"
#include "microfacet/bsdf/walk/on_arrays.hpp"
#include "microfacet/bsdf/walk/random_walk.hpp"
#include "microfacet/family/beckmann.hpp"
#include "microfacet/family/ggx.hpp"
#include "microfacet/family/k0.hpp"

namespace mf = microfacet;
using direction = mf::vec3<double>;
using round_shape = mf::isotropic_shape<double>;

namespace {

direction towards(double degrees, double azimuth = 0) {
  const double theta = degrees * mf::pi / 180, phi = azimuth * mf::pi / 180;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Born and Wolf's equations as they stand.
double reflectance(double cosine, std::complex<double> index) {
  const std::complex<double> inside = std::sqrt(index * index - (1 - cosine * cosine));
  const auto s = (cosine - inside) / (cosine + inside),
             p = (index * index * cosine - inside) / (index * index * cosine + inside);
  return 0.5 * (std::norm(s) + std::norm(p));
}

// The mean of f |cos| over directions of the sphere times its area, over walks 0, 1, ... of each.
template <template <class> class Material, class Family>
double furnace(const Family& family, double alpha, const direction& wi, std::array<double, 2> constants,
               long last, bool lower) {
  using distribution = mf::ndf<Family, double, round_shape>;
  const distribution ndf(family, round_shape(alpha));
  const mf::on_arrays<double, distribution> arrays(ndf);
  const auto walk =
      std::make_unique<mf::random_walk<double, mf::on_arrays<double, distribution>, Material>>(arrays);
  mf::walk_task<double> task;
  task.count = mf::walk_block, task.seed = 3;
  mf::block3<double> wo{};
  constexpr int blocks = 400;
  double sum = 0;
  for (int block = 0; block < blocks; ++block) {
    for (std::size_t i = 0; i < mf::walk_block; ++i) {
      const double n = block * mf::walk_block + static_cast<double>(i);
      // A lattice on the sphere (golden ratio), or on its upper half.
      const double z = 1 - (lower ? 2 : 1) * (n + 0.5) / (blocks * mf::walk_block),
                   phi = 2 * mf::pi * 0.6180339887498949 * n, s = std::sqrt(1 - z * z);
      wo.x[i] = s * std::cos(phi), wo.y[i] = s * std::sin(phi), wo.z[i] = z;
      task.wi.x[i] = wi.x, task.wi.y[i] = wi.y, task.wi.z[i] = wi.z;
      task.parameters[0][i] = constants[0], task.parameters[1][i] = constants[1];
      task.element[i] = static_cast<std::uint64_t>(n);
    }
    mf::block<double> values{};
    walk->evaluate(task, wo, 0, 1, last, values);
    for (const double value : values) sum += value;
  }
  return sum * (lower ? 4 : 2) * mf::pi / (blocks * mf::walk_block);
}

}  // namespace

TEST(random_numbers_are_the_published_ones) {
  struct known {
    std::array<std::uint64_t, 2> key, counter, word;
  };
  const std::uint64_t all = ~std::uint64_t{0};
  for (const known& k : {known{{0, 0}, {0, 0}, {0xc2b6e3a8c2c69865, 0x6f81ed42f350084d}},
                         known{{all, all}, {all, all}, {0xe02cb7c4d95d277a, 0xd06633d0893b8b68}},
                         known{{0xa4093822299f31d0, 0x082efa98ec4e6c89},
                               {0x243f6a8885a308d3, 0x13198a2e03707344},
                               {0x263c7d30bb0f0af1, 0x56be8361d3311526}}}) {
    mf::threefry_words<1> t{{k.counter[0]}, {k.counter[1]}};
    t.scramble(1, k.key[0], {k.key[1]});
    CHECK(t.x0[0] == k.word[0] && t.x1[0] == k.word[1]);
  }
  CHECK(mf::uniform_of<float>(all) < 1 && mf::uniform_of<double>(all) < 1);
}

TEST(fresnel) {
  for (const double cosine : {0.0, 1e-8, 0.01, 0.3, 0.7, 0.99, 1.0}) {
    for (const double eta : {0.05, 0.5, 0.99, 1.5, 2.7, 20.0}) {
      const check::note at("cosine ", cosine, " eta ", eta);
      const double want = cosine == 0 ? 1 : reflectance(cosine, eta);
      const auto split = mf::fresnel_dielectric(cosine, eta);
      CHECK(std::abs(split.reflected - want) < 4e-15);
      CHECK(std::abs(split.reflected + split.passed - 1) < 4e-15);
      for (const double k : {0.0, 1e-3, 0.7, 3.4, 100.0})
        CHECK(std::abs(mf::fresnel_conductor(cosine, eta, k) - reflectance(cosine, {eta, -k})) < 4e-15);
    }
    if (cosine > 0) CHECK(mf::fresnel_dielectric(cosine, 1.0).reflected == 0);
  }
  CHECK(std::isnan(mf::fresnel_dielectric(0.5, 0.0).reflected));
  CHECK(std::isnan(mf::fresnel_dielectric(0.5, -1.0).passed));
  // What passes is no difference, and huge indices are mirrors in the end.
  for (const double eta : {1e9, 1e40, 1e200}) {
    CHECK_NEAR(mf::fresnel_dielectric(1.0, eta).passed, 4 / eta, 1e-8);
    CHECK_NEAR(mf::fresnel_dielectric(1.0, 1 / eta).passed, eta < 1e100 ? 4 / eta : 0, 1e-8);
    CHECK(mf::fresnel_conductor(0.5, eta, 0.0) > 1 - 8 / eta - 1e-15);
    CHECK(mf::fresnel_conductor(0.5, 1.0, eta) > 1 - 8 / eta - 1e-15);
  }
  CHECK(mf::fresnel_conductor(0.7F, 1e30F, 1e35F) == 1 && mf::fresnel_conductor(1.0, 1e-200, 1e-100) == 1);
  CHECK(std::isnan(mf::fresnel_conductor(0.5, 1.0, -1.0)));
}

TEST(a_pair_of_directions) {
  const mf::ndf<mf::ggx<double>, double, round_shape> ndf(mf::ggx<double>(), round_shape(0.4));
  const mf::conductor<double> gold(0.2, 3.4);
  const mf::dielectric<double> glass(1.5);
  for (const double degrees : {1.0, 40.0, 85.0}) {
    const direction wi = towards(50, 20), up = towards(degrees, 150), down = towards(180 - degrees, 150);
    const mf::half_vector<double> half = mf::half_vector_reflection(wi, up);
    const direction m = mf::normalize(half.m);
    CHECK_NEAR(half.cosine, mf::dot(wi, m), 1e-15);
    CHECK_NEAR(mf::eval(gold, ndf, wi, up),
               gold.reflectance(mf::dot(wi, m)) * ndf.D(m) * ndf.G2(wi, up) / (4 * wi.z), 1e-13);
    CHECK_NEAR(mf::eval(gold, ndf, wi, up) * wi.z, mf::eval(gold, ndf, up, wi) * up.z, 1e-13);
    CHECK(mf::eval(gold, ndf, wi, down) == 0 && mf::eval(gold, ndf, down, wi) == 0);
    // Importance: f/eta^2 is the same from both sides.
    CHECK_NEAR(mf::eval(glass, ndf, wi, down, true, false) * wi.z,
               mf::eval(glass, ndf, down, wi, true, false) * -down.z * (1.5 * 1.5), 1e-12);
    CHECK_NEAR(mf::eval(glass, ndf, wi, down, true, true) * (1.5 * 1.5),
               mf::eval(glass, ndf, wi, down, true, false), 1e-13);
    for (const direction& from : {wi, down}) {
      for (const double choice : {0.0, 0.5}) {
        const auto drawn = mf::sample(glass, ndf, from, direction{0.3, 0.6, 0.1}, choice);
        CHECK_NEAR(mf::dot(drawn.wo, drawn.wo), 1.0, 1e-12);
        CHECK_NEAR(drawn.weight * drawn.pdf, mf::eval(glass, ndf, from, drawn.wo), 1e-9);
        CHECK_NEAR(drawn.pdf, mf::pdf(glass, ndf, from, drawn.wo), 1e-9);
      }
    }
  }
  const auto straight =
      mf::sample(mf::dielectric<double>(1.0), ndf, towards(40), direction{0.3, 0.6, 0.1}, 0.0);
  CHECK(straight.weight == 1 && straight.wo.z == -towards(40).z && straight.pdf == mf::inf);
  const mf::dielectric<double> nothing(1.0);
  CHECK(mf::pdf(nothing, ndf, towards(40), straight.wo) == mf::inf);
  CHECK(mf::pdf(nothing, ndf, towards(40), towards(139)) == 0);
  CHECK(std::isnan(mf::pdf(mf::dielectric<double>(-1.5), ndf, towards(40), towards(139))));
}

// Of float and double: what is drawn is what eval and pdf say of it, to the last digits.
template <class T, class Family>
void check_samples(const Family& family, T alpha, T eta) {
  const mf::ndf<Family, T, mf::isotropic_shape<T>> ndf(family, mf::isotropic_shape<T>(alpha));
  const mf::dielectric<T> glass(eta);
  const check::note at("eta ", static_cast<double>(eta), " of ", sizeof(T), " bytes");
  for (const T z : {T(1), T(0.8), T(1e-3), T(1e-12), T(-0.5), T(-1e-7)}) {
    const mf::vec3<T> wi{std::sqrt(1 - z * z), 0, z};
    for (int i = 0; i < 300; ++i) {
      const auto number = [i](double ratio) {
        return static_cast<T>(std::fmod(0.5 + i * ratio, 1.0)) * T(0.999);
      };
      const auto drawn = mf::sample(
          glass, ndf, wi, {number(0.7548776662), number(0.5698402910), number(0.4311)}, number(0.8191725134));
      CHECK(drawn.pdf >= 0 && drawn.pdf < T(mf::inf) && drawn.weight >= 0 && drawn.weight < T(mf::inf));
      CHECK(drawn.pdf == mf::pdf(glass, ndf, wi, drawn.wo));
      const T value = mf::eval(glass, ndf, wi, drawn.wo), product = drawn.weight * drawn.pdf;
      CHECK(std::abs(value - product) <= 16 * std::numeric_limits<T>::epsilon() * value);
      CHECK(std::abs(mf::dot(drawn.wo, drawn.wo) - 1) < 8 * std::numeric_limits<T>::epsilon());
    }
  }
}

TEST(samples_at_any_index) {
  for (const double eta : {1e-9, 0.3, 1 - 1e-6, 1 + 0x1p-23, 1.001, 1.5, 1e9}) {
    check_samples<double>(mf::ggx<double>(), 0.3, eta);
    check_samples<float>(mf::ggx<float>(), 0.3F, static_cast<float>(eta));
    check_samples<double>(mf::k0<double>(), 0.01, eta);
    check_samples<float>(mf::k0<float>(), 0.01F, static_cast<float>(eta));
  }
  check_samples<double>(mf::ggx<double>(), 0.3, 1 + 0x1p-52);
}

TEST(no_sample_lies_on_an_infinite_peak) {
  const mf::ndf<mf::k0<float>, float, mf::isotropic_shape<float>> ndf(mf::k0<float>(),
                                                                      mf::isotropic_shape<float>(0.2F));
  const mf::conductor<float> gold(0.2F, 3.4F);
  const mf::vec3<float> wi{0.6F, 0, 0.8F};
  CHECK(mf::pdf(gold, ndf, wi, {-0.6F, 0, 0.8F}) == std::numeric_limits<float>::infinity());
  const auto beside =
      mf::beside_peak(gold, mf::vec3<float>{-0.6F, 0, 0.8F}, std::numeric_limits<float>::infinity(),
                      (std::numeric_limits<float>::max)(), std::numeric_limits<float>::epsilon());
  const float density = mf::pdf(gold, ndf, wi, beside);
  CHECK(density > 1 && density < 1e3F && beside.z == 0.8F);
}

TEST(directions_of_any_length) {
  const double tolerance = 8 * std::numeric_limits<double>::epsilon();
  for (const double length : {1e-200, 1e-3, 3.0, 1e300}) {
    const direction w = mf::normalize(direction{3 * length, 0, -4 * length}, tolerance);
    CHECK_NEAR(w.x, 0.6, 1e-15);
    CHECK_NEAR(w.z, -0.8, 1e-15);
    const direction again = mf::normalize(w, tolerance);
    CHECK(again.x == w.x && again.z == w.z);
  }
  for (const direction& w :
       {direction{0, 0, 0}, direction{mf::inf, 0, 0}, direction{0, mf::nan<double>(), 1}}) {
    const direction none = mf::normalize(w, tolerance);
    CHECK(std::isnan(none.x) && std::isnan(none.y) && std::isnan(none.z));
  }
}

TEST(white_furnace) {
  constexpr long all = 1 << 20;
  const std::array<double, 2> mirror{mf::inf, 0};
  for (const double degrees : {0.0, 70.0}) {
    const check::note at("degrees ", degrees);
    const direction wi = towards(degrees, 30);
    CHECK(std::abs(furnace<mf::conductor>(mf::ggx<double>(), 0.8, wi, mirror, all, false) - 1) < 0.02);
    CHECK(std::abs(furnace<mf::conductor>(mf::k0<double>(), 0.8, wi, mirror, all, false) - 1) < 0.02);
    CHECK(std::abs(furnace<mf::diffuse>(mf::beckmann<double>(), 0.8, wi, {1, 0}, all, false) - 1) < 0.02);
    CHECK(std::abs(furnace<mf::dielectric>(mf::beckmann<double>(), 0.8, wi, {1.5, 0}, all, true) - 1) < 0.02);
  }
}

TEST(walks_of_one_order_are_single_scattering) {
  const mf::beckmann<double> family;
  const mf::ndf<mf::beckmann<double>, double, round_shape> ndf(family, round_shape(0.7));
  const direction wi = towards(60, 30);
  const mf::conductor<double> mirror(mf::inf, 0);
  double sum = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double z = (i + 0.5) / n, phi = 2 * mf::pi * 0.6180339887498949 * i, s = std::sqrt(1 - z * z);
    sum += mf::eval(mirror, ndf, wi, direction{s * std::cos(phi), s * std::sin(phi), z});
  }
  const double single = sum * 2 * mf::pi / n;
  CHECK(single < 0.9);
  CHECK(std::abs(furnace<mf::conductor>(family, 0.7, wi, {mf::inf, 0}, 1, false) - single) < 0.01);
}
