// Evaluates a Student-T distribution: density, projected area and masking of a few directions, and a sample.

#include <cmath>
#include <cstdio>

#include "microfacet/family/student_t.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"

int main() {
  namespace mf = microfacet;

  const mf::student_t<double> family(2.5);  // gamma
  const double turn = 0.2;                  // alpha_x = 0.1 and alpha_y = 0.4, turned by 0.2 radians
  const mf::anisotropic_shape<double> shape(0.1, 0.4, std::cos(turn), std::sin(turn));
  const mf::ndf<mf::student_t<double>, double> ndf(family, shape);

  std::printf("%8s %12s %12s %12s\n", "theta", "D", "sigma", "G1");
  for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
    const double theta = degrees * mf::pi / 180;
    const mf::vec3<double> w{std::sin(theta), 0.0, std::cos(theta)};
    std::printf("%8.1f %12.5g %12.5g %12.5g\n", degrees, ndf.D(w), ndf.sigma(w), ndf.G1(w));
  }

  const mf::vec3<double> m = mf::sample_normal(ndf, 0.7, 0.3);  // two uniform random numbers
  std::printf("sample   (%.5f, %.5f, %.5f)\n", m.x, m.y, m.z);
}
