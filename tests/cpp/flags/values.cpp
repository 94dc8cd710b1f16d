// What the headers give, line by line: a name and a value. The same program is compiled with the flags of
// others and without, and test_flags compares.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "../families.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/single_scattering.hpp"
#include "microfacet/bsdf/walk/on_arrays.hpp"
#include "microfacet/bsdf/walk/random_walk.hpp"
#include "microfacet/core/lanes.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "microfacet/tabulated/user_density.hpp"

namespace {

namespace mf = microfacet;

std::string where;
void say(const char* what, double at, double value) {
  std::printf("%s %s %.9g\t%.17g\n", where.c_str(), what, at, value);
}

// The first lane, the others being like it.
template <class R>
double number(const R& x) {
  mf::lane_of<R> first;
  std::memcpy(&first, &x, sizeof first);
  return static_cast<double>(first);
}

template <class R>
constexpr bool single = sizeof(mf::lane_of<R>) == 4;

// Functions of a cosine or a slope.
template <class R, class Ndf>
void elementwise(const Ndf& ndf) {
  for (const double at : {1e-12, 1e-5, 0.013, 0.2, 0.5, 0.83, 0.97, 0.999, 0.999999, 1 - 0x1p-24, 1.0}) {
    const auto u = static_cast<mf::lane_of<R>>(at);
    const mf::cosine<R> c{R(u)}, below{R(-u)};
    say("D", at, number(ndf.D(c)));
    say("sigma", at, number(ndf.sigma(c)));
    say("Lambda", at, number(ndf.Lambda(c)));
    say("G1", at, number(ndf.G1(c)));
    say("sigma", -at, number(ndf.sigma(below)));
    say("Lambda", -at, number(ndf.Lambda(below)));
    if (u < 1) say("sample_slope", at, number(mf::sample_slope(ndf.family(), ndf.shape(), R(u))));
  }
  for (const double at : {1e-9, 1e-3, 0.04, 0.3, 1.0, 4.0, 60.0, 1e5}) {
    if (at > 1e12 * number(ndf.shape().least())) continue;  // its square leaves the range of a float
    const R p = R(at);
    say("P22", at, number(ndf.P22(p, R(R(0.25) * p))));
    say("P2", at, number(ndf.P2(p)));
    say("slope_cdf", at, number(ndf.slope_cdf(p)));
    say("slope_cdf", -at, number(ndf.slope_cdf(-p)));
    say("survival", at, number(mf::survival(ndf, p)));
  }
}

template <class R>
void say(const char* what, double at, const mf::vec3<R>& v) {
  say((std::string(what) + ".x").c_str(), at, number(v.x));
  say((std::string(what) + ".y").c_str(), at, number(v.y));
  say((std::string(what) + ".z").c_str(), at, number(v.z));
}

template <class R, class Ndf>
void samples(const Ndf& ndf) {
  int n = 0;
  for (const double degrees : {0.0, 0.5, 30.0, 69.0, 89.0, 90.0, 93.0, 120.0}) {
    const double theta = degrees * mf::pi / 180;
    const mf::vec3<R> w{R(std::sin(theta) * 0.6), R(std::sin(theta) * -0.8), R(std::cos(theta))};
    // Below the horizon a nearly smooth surface, or one of light tails, is not seen at all.
    if (degrees > 90 && !(number(ndf.sigma(w)) > (single<R> ? 1e-30 : 1e-250))) continue;
    for (const double xi0 : {1e-6, 0.03, 0.4, 0.77, 0.999}) {
      const double golden = ++n * 0.6180339887498949, xi1 = golden - std::floor(golden),
                   xi2 = 0.99 - 0.97 * xi1;
      say("visible", n, mf::sample_visible(ndf, w, R(xi0), R(xi1), R(xi2)));
      say("mixture", n, mf::sample_visible_mixture(ndf, w, R(xi0), R(xi1), R(xi2), R(0.37)));
      if constexpr (mf::bounded_facet_sampling<std::remove_cvref_t<decltype(ndf.family())>>) {
        say("bounded", n, mf::sample_visible_bounded(ndf, w, R(xi0), R(xi1)));
      }
      say("normal", n, mf::sample_normal(ndf, R(xi0), R(xi1)));
    }
  }
}

template <class R, class Material, class Ndf>
void scattering(const char* name, const Material& material, const Ndf& ndf) {
  const std::string before = where;
  where += std::string(" ") + name;
  int n = 0;
  for (const double degrees : {3.0, 30.0, 75.0, 89.9, 130.0}) {
    const double theta = degrees * mf::pi / 180;
    const mf::vec3<R> wi{R(std::sin(theta)), R(0), R(std::cos(theta))};
    for (const double out : {0.0, 20.0, 30.0, 80.0, 100.0, 170.0}) {
      ++n;
      const double phi = 0.9 * n, to = out * mf::pi / 180;
      const mf::vec3<R> wo{R(std::sin(to) * std::cos(phi)), R(std::sin(to) * std::sin(phi)), R(std::cos(to))};
      say("eval", n, number(mf::eval(material, ndf, wi, wo)));
      say("pdf", n, number(mf::pdf(material, ndf, wi, wo)));
      const auto drawn =
          mf::sample(material, ndf, wi, mf::vec3<R>{R(0.17 * (n % 6)), R(0.3), R(0.7)}, R(0.19 * (n % 5)));
      say("sample", n, drawn.wo);
      // Close to the horizon a weight is proportional to the cosine, which has the rounding of the direction.
      say("weight", n, std::abs(number(drawn.wo.z)) < 0.01 ? 0.0 : number(drawn.weight));
    }
  }
  where = before;
}

template <class R, class Ndf>
void everything(const Ndf& ndf) {
  elementwise<R>(ndf);
  samples<R>(ndf);
}

template <class R>
const char* kind() {
  if constexpr (std::is_same_v<R, float>) {
    return "float ";
  } else if constexpr (std::is_same_v<R, double>) {
    return "double ";
  } else {
    return single<R> ? "pack of float " : "pack of double ";
  }
}

// Loops over numbers, which compilers may turn into vectors.
template <class R, class Ndf>
[[gnu::noinline]] void loops(const Ndf& ndf, const std::array<R, 64>& u, std::array<R, 64>& D,
                             std::array<R, 64>& area, std::array<R, 64>& log) {
  for (std::size_t i = 0; i < u.size(); ++i) D[i] = ndf.D(mf::cosine<R>(u[i]));
  for (std::size_t i = 0; i < u.size(); ++i) area[i] = ndf.sigma(mf::cosine<R>(u[i]));
  for (std::size_t i = 0; i < u.size(); ++i) log[i] = mf::elementary::log1p(R(-u[i]));
}
template <class R>
void loops() {
  const auto of = [](const auto& family) {
    using family_type = std::decay_t<decltype(family)>;
    where = kind<R>() + std::string("loop ") + std::string(family_type::name);
    std::array<R, 64> u, D, area, log;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<R>((static_cast<double>(i) + 0.5) / 64);
    loops<R>(mf::ndf<family_type, R, mf::isotropic_shape<R>>(family, mf::isotropic_shape<R>(R(0.3))), u, D,
             area, log);
    for (std::size_t i = 0; i < u.size(); ++i) {
      say("D", number(u[i]), number(D[i])), say("sigma", number(u[i]), number(area[i]));
      say("log1p", number(u[i]), number(log[i]));
    }
  };
  of(mf::ggx<R>()), of(mf::beckmann<R>()), of(mf::student_t<R>(R(2.5)));
}

// A family as it stands, where its arithmetic keeps the contract in this precision.
template <class R>
void closed() {
  families::each([]<class Tag>(const families::arguments& a) {
    using family = typename Tag::template type<R>;
    if constexpr (!single<R> || family::float32_arithmetic) {
      for (const double alpha : {1e-4, 0.1, 0.5, 3.0, 1e-12, 1e12}) {
        if (!family::shape_invariant && alpha != 0.5) continue;
        if (single<R> && (alpha < 1e-6 || alpha > 1e6)) continue;  // float headers hold no more
        const R stretch = R(family::shape_invariant ? alpha : 1.0);
        where = kind<R>() + std::string(family::name);
        for (const double p : a) where += " " + std::to_string(p);
        where += " log alpha " + std::to_string(std::log10(alpha));
        const mf::ndf<family, R, mf::isotropic_shape<R>> ndf(families::make<R, Tag>(a),
                                                             mf::isotropic_shape<R>(stretch));
        elementwise<R>(ndf);
        // Beyond these roughnesses products of a few of them overflow, if they are regrouped.
        if (alpha > 1e-5 && alpha < 1e5) samples<R>(ndf);
      }
    }
  });
}

template <class R, class Exact>
void tabulated(const char* name, const Exact& exact, double alpha) {
  using real = mf::lane_of<R>;
  const auto tables = std::make_unique<mf::radial_tables<real>>();
  tables->build(exact, mf::of_all | mf::of_visible);
  where = kind<R>() + std::string("tabulated ") + name;
  if (!single<R>) say("good", 0, tables->good(mf::of_all));
  const mf::isotropic_shape<R> shape{R(alpha)};
  const mf::ndf<mf::tabulated<R>, R, mf::isotropic_shape<R>> ndf(mf::tabulated<R>(*tables), shape);
  everything<R>(ndf);
}
template <class R>
void tabulated() {
  tabulated<R>("student_t", mf::student_t<double>(2.5), 0.5);
  tabulated<R>("gtr", mf::gtr<double>(0.3, 1.7), 1);
  tabulated<R>("bessel_k", mf::bessel_k<double>(1.3), 0.5);
}

template <class R>
void materials() {
  const mf::anisotropic_shape<R> shape(R(0.2), R(0.7), R(0.6), R(0.8));
  const auto both = [&]<class Family>(const Family& family) {
    where = kind<R>() + std::string(Family::name);
    const mf::ndf<Family, R, mf::anisotropic_shape<R>> ndf(family, shape);
    scattering<R>("conductor", mf::conductor<R>(R(0.2), R(3.9)), ndf);
    scattering<R>("dielectric", mf::dielectric<R>(R(1.5)), ndf);
  };
  both(mf::ggx<R>()), both(mf::beckmann<R>());
  for (const double c : {1e-3, 0.3, 0.7453559924999299, 0.75, 0.9, 1.0}) {
    where = kind<R>() + std::string("fresnel");
    for (const double eta : {0.5, 0.6666666666666666, 1.00001, 1.5, 40.0})
      say("dielectric", c, number(mf::fresnel_dielectric(R(c), R(eta)).reflected));
    for (const double k : {1e-3, 1.0, 8.0})
      say("conductor", c, number(mf::fresnel_conductor(R(c), R(1.1), R(k))));
  }
}

// The mean of what walks of all orders carry, whose numbers no flag may change.
template <class Lanes>
void walks() {
  using T = mf::lane_of<Lanes>;
  using distribution = mf::ndf<mf::ggx<Lanes>, Lanes, mf::isotropic_shape<Lanes>>;
  const distribution ndf(mf::ggx<Lanes>(), mf::isotropic_shape<Lanes>(Lanes(0.8)));
  const mf::on_arrays<Lanes, distribution> arrays(ndf);
  const auto walk =
      std::make_unique<mf::random_walk<Lanes, mf::on_arrays<Lanes, distribution>, mf::dielectric>>(arrays);
  mf::walk_task<T> task;
  task.count = mf::walk_block, task.seed = 3;
  for (std::size_t i = 0; i < mf::walk_block; ++i) {
    task.wi.x[i] = T(0.8), task.wi.z[i] = T(0.6), task.parameters[0][i] = T(1.5);
    task.element[i] = static_cast<std::uint64_t>(i);
  }
  mf::block3<T> wo{};
  mf::block<T> weight{}, order{};
  walk->sample(task, wo, weight, order);
  double all = 0, up = 0;
  for (std::size_t i = 0; i < mf::walk_block; ++i)
    all += static_cast<double>(order[i] * weight[i]), up += wo.z[i] > 0 ? 1 : 0;
  where = kind<Lanes>() + std::string("walks");
  say("orders", 0, all), say("reflected", 0, up);
}

// A density of one's own.
void own() {
  const auto laplace = [](const double* L, double* f, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) f[i] = std::exp(-2 * std::abs(std::expm1(L[i])));
  };
  const auto none = [](const double*, double*, std::size_t) {};
  const auto family = std::make_unique<mf::user_density>(laplace, -30.0, 6.0, std::exp(-2.0), false, none);
  where = "double user_density";
  say("norm", 0, family->norm());
  const auto tables = std::make_unique<mf::user_density_tables<double>>();
  tables->build(*family);
  const mf::ndf<mf::tabulated_user_density<double>, double, mf::isotropic_shape<double>> ndf(
      mf::tabulated_user_density<double>(*tables), mf::isotropic_shape<double>(0.4));
  elementwise<double>(ndf);
}

}  // namespace

int main() {
  closed<double>(), tabulated<float>();
  own(), loops<double>(), loops<float>();
#if !defined(FEW_VALUES)
  closed<float>(), tabulated<double>();
  materials<double>(), materials<float>();
  walks<double>(), walks<float>();
#if MICROFACET_VECTOR_EXTENSIONS
  closed<mf::pack<float, 16>>();
  tabulated<mf::pack<float, 16>>();
  materials<mf::pack<float, 16>>(), walks<mf::pack<float, 16>>();
#endif
#endif
}
