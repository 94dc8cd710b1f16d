// Every family on lanes, also when the lanes of one batch lie in different regimes of a formula, outside its domain,
// or at infinity: a batch with nothing but <cmath> gives the scalar's values, and a pack gives every lane the bits
// that it has among others or alone.

#include "batch.hpp"

#include "check.hpp"
#include "families.hpp"
#include "microfacet/core/pack.hpp"

namespace {

namespace mf = microfacet;

// To the accuracy contract in double, to a few roundings of the exponents in float; nan, infinity and zero alike.
template <class T>
bool near(T a, T b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  const T most = std::numeric_limits<T>::max(), least = sizeof(T) == 4 ? T(1e-30) : T(1e-300);
  if (std::abs(b) < least) return std::abs(a) < 2 * least;
  return a == b || (std::abs(b) < most && std::abs(a - b) <= (sizeof(T) == 4 ? T(2e-5) : T(1e-13)) * std::abs(b));
}

template <class T>
bool same_bits(T a, T b) {
  return std::isnan(a) ? std::isnan(b) : mf::elementary::bits(a) == mf::elementary::bits(b);
}

// Arguments for all lanes, turned so that every value meets every other one in some batch.
template <class Batch, class T>
Batch deal(const std::vector<T>& values, std::size_t first) {
  Batch b(T(0));
  for (int i = 0; i < Batch::size; ++i)
    b.set(i, values[(first + static_cast<std::size_t>(i) * (1 + first / values.size())) % values.size()]);
  return b;
}

template <class Batch, class T, class Scalar, class Batched>
void lane_by_lane(const char* name, const std::vector<T>& values, const Scalar& scalar, const Batched& batched) {
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
    compare("slope_excess", radii, []<class X>(const auto& d, const X& x) { return d.slope_excess(x); });
    for (const double z : {1.0, 0.6, 0.01})
      compare("D", radii, [z]<class X>(const auto& d, const X& x) { return d.D(X(z), x); });
  });
}

// The parameters vary from lane to lane too; one lane lies outside the domain and stays alone with that.
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
          const check::note where(name, ".", function, ", shape ", shape[i], ", x = ", x, ": ", y[i], ", scalar ", want);
          CHECK(near(y[i], want) && std::isnan(y[i]) == (shape[i] < 0));
          if constexpr (mf::elementary::has_lanes<Batch>) CHECK(same_bits(y[i], evaluate(make(Batch(shape[i])), at)[0]));
        }
      };
      check("P22", []<class X>(const auto& d, const X& t) { return d.P22(t); });
      check("P2", []<class X>(const auto& d, const X& t) { return d.P2(t); });
      check("slope_sf", []<class X>(const auto& d, const X& t) { return d.slope_sf(t); });
      check("slope_excess", []<class X>(const auto& d, const X& t) { return d.slope_excess(t); });
      check("survival", []<class X>(const auto& d, const X& t) { return d.survival(t); });
      check("radius2", []<class X>(const auto& d, const X&) { return d.radius2(X(0.3)); });
    };
    compare("student_t", []<class S>(const S& gamma) { return mf::student_t<S>(gamma); });
    compare("bessel_k", []<class S>(const S& order) { return mf::bessel_k<S>(order); });
    compare("gtr", []<class S>(const S& gamma) { return mf::gtr<S>(S(0.3), gamma); });
  }
}

}  // namespace

TEST(double_batches) { all_functions<double, lanes::batch<double>>(); }
TEST(float_batches) { all_functions<float, lanes::batch<float>>(); }
TEST(batches_with_parameters_of_their_own) {
  mixed_parameters<double, lanes::batch<double>>(), mixed_parameters<float, lanes::batch<float>>();
}
#if MICROFACET_VECTOR_EXTENSIONS
TEST(double_packs) { all_functions<double, mf::pack<double, 32>>(); }
TEST(float_packs) { all_functions<float, mf::pack<float, 32>>(); }
TEST(packs_with_parameters_of_their_own) {
  mixed_parameters<double, mf::pack<double, 32>>(), mixed_parameters<float, mf::pack<float, 32>>();
}
#endif
