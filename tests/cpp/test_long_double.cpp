// A long double is a scalar like any other: functions of directions and slopes are as right as those of a
// double.

#include <cmath>

#include "check.hpp"
#include "families.hpp"
#include "microfacet/bsdf/fresnel.hpp"
#include "microfacet/smith/ndf.hpp"

namespace mf = microfacet;

namespace {

template <class T, class Tag>
auto distribution(const families::arguments& a, double alpha) {
  using family = typename Tag::template type<T>;
  const T stretch = T(family::shape_invariant ? alpha : 1.0);
  return mf::ndf<family, T, mf::isotropic_shape<T>>(families::make<T, Tag>(a),
                                                    mf::isotropic_shape<T>(stretch));
}

void check_value(long double got, double want) {
  if (!(want > 1e-290 && want < 1e290)) return;
  CHECK_NEAR(got, want, std::abs(std::log(want)) > 50 ? 1e-12 : 1e-13);
}

}  // namespace

TEST(long_double) {
  families::each([]<class Tag>(const families::arguments& a) {
    for (const double alpha : {1e-3, 0.2, 4.0}) {
      const auto wide = distribution<long double, Tag>(a, alpha);
      const auto narrow = distribution<double, Tag>(a, alpha);
      for (const double u : {1e-9, 0.02, 0.4, 0.9, 0.9999, 1.0}) {
        const check::note at(Tag::template type<double>::name, " alpha ", alpha, " u ", u);
        const mf::cosine<long double> c{u};
        const mf::cosine<double> d{u};
        check_value(wide.D(c), narrow.D(d));
        check_value(wide.sigma(c), narrow.sigma(d));
        check_value(wide.Lambda(c), narrow.Lambda(d));
        check_value(wide.G1(c), narrow.G1(d));
        check_value(wide.P22(u, 0.3), narrow.P22(u, 0.3));
        check_value(wide.P2(u), narrow.P2(u));
        check_value(wide.slope_cdf(-u), narrow.slope_cdf(-u));
      }
    }
  });
  for (const double u : {0.01, 0.5, 1.0}) {
    const long double wide = mf::fresnel_dielectric(static_cast<long double>(u), 1.5L).reflected;
    CHECK_NEAR(wide, mf::fresnel_dielectric(u, 1.5).reflected, 1e-14);
  }
}
