// Reflects a beam from a rough metal with the headers alone: normals that the beam sees, each weighed by
// F G2/G1, against the integral of the same BSDF. What is missing to 1 with F = 1 is light that would be
// scattered again.

#include <cmath>
#include <cstdio>
#include <random>

#include "microfacet/family/all.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace mf = microfacet;
using direction = mf::vec3<double>;

namespace {

direction reflect(const direction& w, const direction& m) {
  const double twice = 2 * mf::dot(w, m);
  return {twice * m.x - w.x, twice * m.y - w.y, twice * m.z - w.z};
}

// Schlick's Fresnel term of a metal like gold, in red.
double fresnel(double cosine) { return 0.95 + 0.05 * std::pow(1 - cosine, 5); }

struct albedos {
  double mirror = 0, metal = 0;
};

template <class Distribution>
albedos sampled(const Distribution& ndf, const direction& wi, int count) {
  std::mt19937_64 generator(1);
  const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  albedos sum;
  for (int i = 0; i < count; ++i) {
    const double xi0 = uniform(), xi1 = uniform(), xi2 = uniform();
    const direction m = mf::sample_visible(ndf, wi, xi0, xi1, xi2), wo = reflect(wi, m);
    if (!(wo.z > 0)) continue;
    const double weight = ndf.G2(wi, wo) / ndf.G1(wi) / count;
    sum.mirror += weight, sum.metal += weight * fresnel(mf::dot(wi, m));
  }
  return sum;
}

// int D(m) (wi . m) G2/wi.z dm over normals m that reflect upwards, on a grid of slopes that is dense near 0.
template <class Distribution>
albedos integrated(const Distribution& ndf, const direction& wi) {
  constexpr int radii = 1200, azimuths = 240;
  constexpr double reach = 18;
  albedos sum;
  for (int i = 0; i < radii; ++i) {
    const double s = reach * (i + 0.5) / radii, r = 1e-5 * std::sinh(s),
                 dr = 1e-5 * std::cosh(s) * reach / radii;
    for (int j = 0; j < azimuths; ++j) {
      const double phi = 2 * mf::pi * (j + 0.5) / azimuths, z = 1 / std::sqrt(1 + r * r);
      const direction m{r * z * std::cos(phi), r * z * std::sin(phi), z}, wo = reflect(wi, m);
      const double cosine = mf::dot(wi, m);
      if (!(wo.z > 0) || !(cosine > 0)) continue;
      const double area = z * z * z * r * dr * 2 * mf::pi / azimuths;
      const double weight = ndf.D(m) * cosine * ndf.G2(wi, wo) / wi.z * area;
      sum.mirror += weight, sum.metal += weight * fresnel(cosine);
    }
  }
  return sum;
}

int failures = 0;

template <class Family>
void show(const char* name, const Family& family, double alpha) {
  const mf::isotropic_shape<double> shape(alpha);
  const mf::ndf<Family, double, mf::isotropic_shape<double>> ndf(family, shape);
  const direction wi{std::sin(1.2), 0, std::cos(1.2)};
  const albedos a = sampled(ndf, wi, 100000), b = integrated(ndf, wi);
  std::printf("%-22s %10.4f %10.4f %10.4f %10.4f\n", name, a.mirror, b.mirror, a.metal, b.metal);
  if (!(std::abs(a.mirror - b.mirror) < 0.005 && std::abs(a.metal - b.metal) < 0.005)) ++failures;
}

template <class Family>
void show_prepared(const char* name, const Family& family, double alpha) {
  static mf::radial_tables<double> tables;
  tables.build(family, mf::of_all | mf::of_visible);
  show(name, mf::tabulated<double>(tables), alpha);
}

}  // namespace

int main() {
  std::printf("albedo at 69 degrees, alpha = 0.5\n%-22s %21s %21s\n", "", "F = 1", "Schlick");
  std::printf("%-22s %10s %10s %10s %10s\n", "", "sampled", "integral", "sampled", "integral");
  show("Beckmann", mf::beckmann<double>(), 0.5);
  show("GGX", mf::ggx<double>(), 0.5);
  show("Student-T, gamma 2.5", mf::student_t<double>(2.5), 0.5);
  show("Student-T, gamma 3", mf::student_t<double>(3), 0.5);
  show("K0", mf::k0<double>(), 0.5);
  show_prepared("Bessel K, a 1.5", mf::bessel_k<double>(1.5), 0.5);
  show_prepared("GTR, gamma 1.5", mf::gtr<double>(0.5, 1.5), 1);
  return failures;
}
