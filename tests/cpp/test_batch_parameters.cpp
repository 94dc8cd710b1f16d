// Families whose parameters differ from lane to lane.

#include "agreement.hpp"
#include "check.hpp"
#include "microfacet/core/pack.hpp"
#include "microfacet/family/all.hpp"

namespace {

namespace mf = microfacet;
using namespace lanes;

// One lane lies outside the domain and stays alone with that.
template <class T, class Batch>
void mixed_parameters() {
  const std::vector<T> shapes{T(2.2), 3, T(1.6), 11, -1, T(40.5), T(1.9), T(900)};
  for (const T x : {T(0.01), T(0.7), T(3)}) {
    const auto compare = [&](const char* name, const auto& make) {
      const Batch shape = deal<Batch>(shapes, 0), at(x);
      const auto check = [&](const char* function, const auto& evaluate) {
        const Batch y = evaluate(make(shape), at);
        for (int i = 0; i < Batch::size; ++i) {
          const T want = evaluate(make(shape[i]), x);
          const check::note nan_unless(name, ".", function, ", shape ", shape[i], ", x = ", x, ": ", y[i],
                                       ", scalar ", want);
          CHECK(near(y[i], want) && std::isnan(y[i]) == (shape[i] < 0));
          if constexpr (mf::elementary::has_lanes<Batch>)
            CHECK(same_bits(y[i], evaluate(make(Batch(shape[i])), at)[0]));
        }
      };
      check("P22", []<class X>(const auto& d, const X& t) { return d.P22(t); });
      check("P2", []<class X>(const auto& d, const X& t) { return d.P2(t); });
      check("slope_sf", []<class X>(const auto& d, const X& t) { return d.slope_sf(t); });
      check("mean_excess", []<class X>(const auto& d, const X& t) { return d.mean_excess(t); });
      check("survival", []<class X>(const auto& d, const X& t) { return d.survival(t); });
      check("radius2", []<class X>(const auto& d, const X&) { return d.radius2(X(0.3)); });
    };
    compare("student_t", []<class S>(const S& gamma) { return mf::student_t<S>(gamma); });
    compare("bessel_k", []<class S>(const S& order) { return mf::bessel_k<S>(order); });
    compare("gtr", []<class S>(const S& gamma) { return mf::gtr<S>(S(0.3), gamma); });
  }
}

}  // namespace

#if MICROFACET_VECTOR_EXTENSIONS
TEST(packs) {
  mixed_parameters<double, mf::pack<double, 32>>(), mixed_parameters<float, mf::pack<float, 32>>();
}
#endif
