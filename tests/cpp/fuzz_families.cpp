// Densities of slopes at any parameters and arguments.

#include "fuzz_family.hpp"

namespace mf = microfacet;

namespace {

// Any arguments may be given; those of the domain have a density or a probability.
template <class T, class Family>
void ask(const Family& family, fuzz::input& in) {
  const T x = in.number<T>(), y = in.number<T>();
  const mf::slope<T> t(x);
  fuzz::compute(family.P22(t.squared)), fuzz::compute(family.P22(mf::double_double<T>(x)));
  fuzz::compute(family.D(x, mf::double_double<T>(y))),
      fuzz::compute(family.survival(mf::double_double<T>(x)));
  fuzz::compute(family.radius2(x)), fuzz::compute(family.mean_excess(t));

  const T z = std::abs(y), size = std::abs(x), u = in.uniform<T>();
  const mf::double_double<T> square = in.choice(2) ? mf::two_prod(x, x) : mf::double_double<T>(size);
  const auto number = [](const T& value) { return static_cast<double>(value); };
  const double all = 1 + 1e-5;  // probabilities are rounded
  fuzz::require_positive("P22", number(family.P22(square)));
  fuzz::require_positive("D", number(family.D(z, square)));
  fuzz::require_within("survival", number(family.survival(square)), 0, all);
  fuzz::require_positive("radius2", number(family.radius2(u)));
  fuzz::require_positive("P2", number(family.P2(t)));
  fuzz::require_within("slope_sf", number(family.slope_sf(t)), 0, all);
  fuzz::require_positive("mean_excess", number(family.mean_excess(mf::slope<T>(size))));
}

template <class T, class Tag>
void of_family(fuzz::input& in) {
  using family = typename Tag::template type<T>;
  const auto f = fuzz::family_of_numbers<family>(in);
  fuzz::judged = sizeof(T) > 4 || family::float32_arithmetic;
  for (int i = 0; i < 4; ++i) ask<T>(f, in);
}

}  // namespace

FUZZ {
  fuzz::in_family(in, in.choice(fuzz::families), [&]<class T, class Tag>() { of_family<T, Tag>(in); });
}
