// Masking of many cosines at once: a Bessel K distribution, prepared in float32 and evaluated a register at a
// time. Compile with -march=native, or with the flags of the instruction set that you want; a scalar works
// too.

#include <cstdio>
#include <cstring>
#include <vector>

#include "microfacet/core/pack.hpp"
#include "microfacet/family/bessel_k.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace mf = microfacet;

#if defined(__AVX512F__)
using lanes = mf::pack<float, 64>;
#elif defined(__AVX__)
using lanes = mf::pack<float, 32>;
#elif MICROFACET_VECTOR_EXTENSIONS
using lanes = mf::pack<float, 16>;
#else
using lanes = float;
#endif

int main() {
  using family = mf::bessel_k<double>;
  mf::radial_tables<float> tables;  // a plain value of some kilobytes
  tables.build(family(1.5), mf::of_mean_excess);
  if (!tables.good(mf::of_mean_excess)) return 1;

  const mf::isotropic_shape<lanes> shape(lanes(0.3f));
  const mf::ndf<mf::tabulated<lanes>, lanes, mf::isotropic_shape<lanes>> ndf(mf::tabulated<lanes>(tables),
                                                                             shape);

  std::vector<float> u(1 << 16), G1(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<float>(i) / static_cast<float>(u.size());
  for (std::size_t i = 0; i < u.size(); i += sizeof(lanes) / sizeof(float)) {
    lanes x;
    std::memcpy(&x, &u[i], sizeof x);
    x = ndf.G1(mf::cosine<lanes>(x));
    std::memcpy(&G1[i], &x, sizeof x);
  }

  for (const std::size_t i : {u.size() / 8, u.size() / 4, u.size() / 2})
    std::printf("G1(%.3f) = %.6f\n", static_cast<double>(u[i]), static_cast<double>(G1[i]));
}
