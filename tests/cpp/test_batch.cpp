// Every family on a SIMD batch: lane by lane the scalar, also when the lanes of one batch lie in different
// regimes of a formula, outside its domain, or at infinity.

#include "batch.hpp"

#include "check.hpp"
#include "families.hpp"

namespace {

namespace mf = microfacet;
using lanes::batch;

// any() may end a loop later for a batch than for its lanes, which changes a sum in its last places.
template <class T>
bool same(T a, T b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return a == b || std::abs(a - b) <= 4 * std::numeric_limits<T>::epsilon() * std::abs(b);
}

// Arguments for all lanes, turned so that every value meets every other one in some batch.
template <class T>
batch<T> deal(const std::vector<T>& values, std::size_t first) {
  batch<T> b;
  for (int i = 0; i < batch<T>::size; ++i)
    b.set(i, values[(first + static_cast<std::size_t>(i) * (1 + first / values.size())) % values.size()]);
  return b;
}

template <class T, class Scalar, class Batched>
void lane_by_lane(const char* name, const std::vector<T>& values, const Scalar& scalar,
                  const Batched& batched) {
  for (std::size_t first = 0; first < 2 * values.size(); ++first) {
    const batch<T> x = deal(values, first), y = batched(x);
    for (int i = 0; i < batch<T>::size; ++i) {
      const T want = scalar(x[i]);
      const check::note at(name, "(", x[i], "): lane ", i, " is ", y[i], ", the scalar ", want);
      CHECK(same(y[i], want));
    }
  }
}

template <class T>
void all_functions() {
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  const std::vector<T> radii{0, T(1e-20), T(1e-4), T(0.3), T(0.9), T(1.1), 4, 30, T(1e6), T(1e15), inf, nan};
  const std::vector<T> uniforms{0,      T(1e-10), T(1e-3),   T(0.2),        T(0.49),
                                T(0.5), T(0.9),   T(0.9999), T(1 - 0x1p-20)};
  std::vector<T> slopes = radii;
  for (const T r : radii) slopes.push_back(-r);

  families::each([&]<class Tag>(const families::arguments& a) {
    const auto f = families::make<T, Tag>(a);
    const auto g = families::make<batch<T>, Tag>(a);
    const double first = a.empty() ? 0 : a[0], last = a.empty() ? 0 : a.back();
    const check::note family(Tag::template type<T>::name, " ", first, " ", last,
                             sizeof(T) == 4 ? " float" : " double");
    lane_by_lane("P22", radii, [&](T x) { return f.P22(x); }, [&](batch<T> x) { return g.P22(x); });
    lane_by_lane(
        "survival", radii, [&](T x) { return f.survival(x); }, [&](batch<T> x) { return g.survival(x); });
    lane_by_lane(
        "radius2", uniforms, [&](T x) { return f.radius2(x); }, [&](batch<T> x) { return g.radius2(x); });
    lane_by_lane("P2", slopes, [&](T x) { return f.P2(x); }, [&](batch<T> x) { return g.P2(x); });
    lane_by_lane(
        "slope_sf", slopes, [&](T x) { return f.slope_sf(x); }, [&](batch<T> x) { return g.slope_sf(x); });
    lane_by_lane(
        "slope_excess", radii, [&](T x) { return f.slope_excess(x); },
        [&](batch<T> x) { return g.slope_excess(x); });
    for (const T z : {T(1), T(0.6), T(0.01)})
      lane_by_lane(
          "D", radii, [&](T x) { return f.D(z, x); }, [&](batch<T> x) { return g.D(batch<T>(z), x); });
  });
}

// The parameters vary from lane to lane too; one lane lies outside the domain and stays alone with that.
template <class T>
void mixed_parameters() {
  const std::vector<T> shapes{T(2.2), 3, T(1.6), 11, -1, T(40.5), T(1.9), T(900)};
  for (const T x : {T(0.01), T(0.7), T(3)}) {
    const auto compare = [&](const char* name, const auto& make) {
      const batch<T> shape = deal(shapes, 0);
      const auto g = make(shape);
      const batch<T> at(x), P22 = g.P22(at), P2 = g.P2(at), sf = g.slope_sf(at), excess = g.slope_excess(at);
      const batch<T> survival = g.survival(at), radius2 = g.radius2(batch<T>(T(0.3)));
      for (int i = 0; i < batch<T>::size; ++i) {
        const check::note where(name, ", shape ", shape[i], ", x = ", x);
        const auto f = make(shape[i]);
        CHECK(same(P22[i], f.P22(x)));
        CHECK(same(P2[i], f.P2(x)));
        CHECK(same(sf[i], f.slope_sf(x)));
        CHECK(same(excess[i], f.slope_excess(x)));
        CHECK(same(survival[i], f.survival(x)));
        CHECK(same(radius2[i], f.radius2(T(0.3))));
        CHECK(std::isnan(P22[i]) == (shape[i] < 0));
      }
    };
    compare("student_t", []<class S>(const S& gamma) { return mf::student_t<S>(gamma); });
    compare("bessel_k", []<class S>(const S& order) { return mf::bessel_k<S>(order); });
    compare("gtr", []<class S>(const S& gamma) { return mf::gtr<S>(S(0.3), gamma); });
  }
}

}  // namespace

TEST(double_batches) { all_functions<double>(); }
TEST(float_batches) { all_functions<float>(); }
TEST(lanes_with_parameters_of_their_own) { mixed_parameters<double>(), mixed_parameters<float>(); }
