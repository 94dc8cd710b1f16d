// Densities of slopes at any parameters and arguments.

#include <tuple>

#include "fuzz.hpp"
#include "microfacet/family/all.hpp"

namespace mf = microfacet;

namespace {

// Any arguments may be given; those of the domain have a density or a probability.
template <class T, class Family>
void ask(const Family& family, fuzz::input& in) {
  const T x = in.number<T>(), y = in.number<T>();
  const mf::slope<T> t(x);
  fuzz::compute(family.P22(t.squared)), fuzz::compute(family.P22(mf::twofold<T>(x)));
  fuzz::compute(family.D(x, mf::twofold<T>(y))), fuzz::compute(family.survival(mf::twofold<T>(x)));
  fuzz::compute(family.radius2(x)), fuzz::compute(family.slope_excess(t));

  const T z = std::abs(y), size = std::abs(x), u = in.uniform<T>();
  const mf::twofold<T> square = in.choice(2) ? mf::exact_product(x, x) : mf::twofold<T>(size);
  const auto number = [](const T& value) { return static_cast<double>(value); };
  const double all = 1 + 1e-5;  // probabilities are rounded
  fuzz::require_positive("P22", number(family.P22(square)));
  fuzz::require_positive("D", number(family.D(z, square)));
  fuzz::require_within("survival", number(family.survival(square)), 0, all);
  fuzz::require_positive("radius2", number(family.radius2(u)));
  fuzz::require_positive("P2", number(family.P2(t)));
  fuzz::require_within("slope_sf", number(family.slope_sf(t)), 0, all);
  fuzz::require_positive("slope_excess", number(family.slope_excess(mf::slope<T>(size))));
}

template <class T, class Tag>
void of_family(fuzz::input& in) {
  using family = typename Tag::template type<T>;
  constexpr std::size_t count = family::parameters.size() + (family::shape_invariant ? 0 : 1);
  const auto make = [&]<std::size_t... I>(std::index_sequence<I...>) {
    const std::array<T, count> p{((void)I, in.number<T>())...};
    return family(p[I]...);
  };
  const family f = make(std::make_index_sequence<count>());
  fuzz::judged = sizeof(T) > 4 || family::native_float32;
  for (int i = 0; i < 4; ++i) ask<T>(f, in);
}

}  // namespace

FUZZ {
  constexpr unsigned count = std::tuple_size_v<mf::all_families>;
  const unsigned chosen = in.choice(count);
  const bool single = in.choice(2) != 0;
  fuzz::one_of<count>(chosen, [&]<unsigned I>() {
    using tag = std::tuple_element_t<I, mf::all_families>;
    if (single)
      of_family<float, tag>(in);
    else
      of_family<double, tag>(in);
  });
}
