// Tables of densities: any parameters build them in bounded work, and any numbers, alone or in lanes, may be
// looked up.

#include <memory>

#include "fuzz_family.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "microfacet/tabulated/user_density.hpp"

namespace mf = microfacet;

namespace {

long calls = 0;

// Counts what a build asks of its family.
template <class Family>
class counted : public Family {
  using T = double;

 public:
  using Family::Family;
  T P22(const mf::double_double<T>& r2) const { return ++calls, Family::P22(r2); }
  T D(const T& z, const mf::double_double<T>& h2) const { return ++calls, Family::D(z, h2); }
  T survival(const mf::double_double<T>& r2) const { return ++calls, Family::survival(r2); }
  T radius2(const T& xi) const { return ++calls, Family::radius2(xi); }
  T P2(const mf::slope<T>& t) const { return ++calls, Family::P2(t); }
  T slope_sf(const mf::slope<T>& t) const { return ++calls, Family::slope_sf(t); }
  T mean_excess(const mf::slope<T>& t) const { return ++calls, Family::mean_excess(t); }
};

template <class T>
void look_up(const mf::tabulated<T>& density, fuzz::input& in) {
  const T x = in.number<T>(), y = in.number<T>();
  const mf::slope<T> t(x);
  fuzz::compute(density.P22(mf::double_double<T>(x))), fuzz::compute(density.P22(t.squared));
  fuzz::compute(density.D(y, t.squared)), fuzz::compute(density.survival(t.squared));
  fuzz::compute(density.survival(mf::double_double<T>(y))), fuzz::compute(density.radius2(y));
  fuzz::compute(density.P2(t)), fuzz::compute(density.slope_sf(t)), fuzz::compute(density.mean_excess(t));
  fuzz::compute(density.P22_of_slope(x)),
      fuzz::compute(density.visible().moment_radius(mf::double_double<T>(y)));
}
template <class Table>
void look_up_lanes([[maybe_unused]] const Table& table, [[maybe_unused]] fuzz::input& in) {
#if MICROFACET_VECTOR_EXTENSIONS
  using T = typename Table::real;
  using lanes = mf::pack<T, 16>;
  const auto some = [&in] {
    lanes x(T(0));
    for (int i = 0; i < lanes::size; ++i) x.set(i, in.number<T>());
    return x;
  };
  const lanes x = some(), y = some();
  fuzz::compute(table(mf::double_double<lanes>(x, y))), fuzz::compute(table.of_root(x));
#endif
}

template <class T, class Tag>
void of_family(fuzz::input& in) {
  using family = counted<typename Tag::template type<double>>;
  const auto f = fuzz::family_of_numbers<family>(in);
  constexpr std::array<unsigned, 7> tables{mf::of_P22,      mf::of_survival,    mf::of_radius, mf::of_P2,
                                           mf::of_slope_sf, mf::of_mean_excess, mf::of_visible};
  const unsigned wanted = tables[in.choice(tables.size())];
  const auto t = std::make_unique<mf::radial_tables<T>>();
  calls = 0;
  t->build(f, wanted);
  fuzz::require_within("calls of a family to build a table", static_cast<double>(calls), 0, 3e6);
  for (int i = 0; i < 4; ++i) look_up<T>(mf::tabulated<T>(*t), in);
  look_up_lanes(t->root_D, in);
}

// A density of the user's: any powers towards 0 and infinity, an edge, noise, or nothing sensible at all.
void of_users_density(fuzz::input& in) {
  const double low = in.number<double>(), high = in.number<double>(), edge = in.number<double>(),
               noise = in.choice(2) ? in.number<double>() : 0, end = in.choice(2) ? 85 : in.number<double>();
  const auto density = [&](const double* L, double* f, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
      f[i] = L[i] > end
                 ? 0
                 : std::abs(std::exp((L[i] < edge ? low : high) * L[i]) * (1 + noise * std::sin(L[i])));
  };
  const auto family = std::make_unique<mf::user_density>(density, -690.0, 85.0, std::abs(in.number<double>()),
                                                         in.choice(2) != 0, density);
  for (int i = 0; i < 4; ++i) {
    const double x = std::abs(in.number<double>());
    fuzz::require_positive("P22", family->P22(mf::double_double<double>(x)));
    fuzz::require_positive("mean_excess", family->mean_excess(mf::slope<double>(x)));
  }
}

}  // namespace

FUZZ {
  const unsigned chosen = in.choice(fuzz::families + 1);
  if (chosen == fuzz::families) return of_users_density(in);
  fuzz::in_family(in, chosen, [&]<class T, class Tag>() { of_family<T, Tag>(in); });
}
