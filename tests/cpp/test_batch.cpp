// Every family on lanes, also when the lanes of one batch lie in different regimes of a formula, outside its
// domain, or at infinity: a batch with nothing but <cmath> gives the scalar's values, and a pack gives every
// lane the bits that it has among others or alone.

#include "batch.hpp"

#include "agreement.hpp"
#include "check.hpp"
#include "families.hpp"
#include "microfacet/core/pack.hpp"

namespace {

namespace mf = microfacet;
using namespace lanes;

template <class Batch, class T, class Scalar, class Batched>
void lane_by_lane(const char* name, const std::vector<T>& values, const Scalar& scalar,
                  const Batched& batched) {
  for (std::size_t first = 0; first < 2 * values.size(); ++first) {
    const Batch x = deal<Batch>(values, first), y = batched(x);
    for (int i = 0; i < Batch::size; ++i) {
      const T want = scalar(x[i]);
      const check::note at(name, "(", x[i], "): lane ", i, " is ", y[i], ", the scalar ", want);
      CHECK(near(y[i], want));
      if constexpr (mf::elementary::has_lanes<Batch>) CHECK(same_bits(y[i], batched(Batch(x[i]))[0]));
    }
  }
}

template <class T, class Batch>
void all_functions() {
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  const std::vector<T> radii{0, T(1e-20), T(1e-4), T(0.3), T(0.9), T(1.1), 4, 30, T(1e6), T(1e15), inf, nan};
  const std::vector<T> uniforms{0,      T(1e-10), T(1e-3),   T(0.2),        T(0.49),
                                T(0.5), T(0.9),   T(0.9999), T(1 - 0x1p-20)};
  std::vector<T> slopes = radii;
  for (const T r : radii) slopes.push_back(-r);

  families::each([&]<class Tag>(const families::arguments& a) {
    const auto f = families::make<T, Tag>(a);
    const auto g = families::make<Batch, Tag>(a);
    const double first = a.empty() ? 0 : a[0], last = a.empty() ? 0 : a.back();
    const check::note family(Tag::template type<T>::name, " ", first, " ", last,
                             sizeof(T) == 4 ? " float" : " double");
    const auto compare = [&](const char* name, const std::vector<T>& values, const auto& function) {
      lane_by_lane<Batch>(
          name, values, [&](T x) { return function(f, x); }, [&](const Batch& x) { return function(g, x); });
    };
    compare("P22", radii, []<class X>(const auto& d, const X& x) { return d.P22(x); });
    compare("survival", radii, []<class X>(const auto& d, const X& x) { return d.survival(x); });
    compare("radius2", uniforms, []<class X>(const auto& d, const X& x) { return d.radius2(x); });
    compare("P2", slopes, []<class X>(const auto& d, const X& x) { return d.P2(x); });
    compare("slope_sf", slopes, []<class X>(const auto& d, const X& x) { return d.slope_sf(x); });
    compare("mean_excess", radii, []<class X>(const auto& d, const X& x) { return d.mean_excess(x); });
    for (const double z : {1.0, 0.6, 0.01})
      compare("D", radii, [z]<class X>(const auto& d, const X& x) { return d.D(X(z), x); });
  });
}

}  // namespace

TEST(double_batches) { all_functions<double, lanes::batch<double>>(); }
#if MICROFACET_VECTOR_EXTENSIONS
TEST(double_packs) { all_functions<double, mf::pack<double, 32>>(); }
TEST(float_packs) { all_functions<float, mf::pack<float, 32>>(); }
#endif
