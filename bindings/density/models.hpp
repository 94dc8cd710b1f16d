// What the parameters of a ufunc mean: lanes of parameters -> distributions.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>

#include "bindings/density/table_cache.hpp"
#include "bindings/loop/lanes.hpp"
#include "microfacet/smith/ndf.hpp"

namespace microfacet::bindings {

// A model says what the parameters of a ufunc are: `scales` roughnesses (alpha, or alpha_x and alpha_y),
// perhaps a rotation, then the family's own. The density's parameters start at `first`: behind the shape, or
// with alpha for a family that is no stretch of one density.
template <class Tag>
struct isotropic_model {
  using tag = Tag;
  using family = typename Tag::template type<double>;
  static constexpr std::size_t first = family::shape_invariant ? 1 : 0, scales = 1;
  static constexpr std::size_t count = 1 + family::parameters.size();

  template <class Lanes>
  static isotropic_shape<Lanes> shape(const double_double<Lanes>* p) {
    return isotropic_shape<Lanes>(family::shape_invariant ? p[0] : double_double<Lanes>(Lanes(1)));
  }
};

// Directions of a family that is no stretch: under the shape of the other families' directions, so that its
// tables are read by their kernels.
template <class Tag>
struct unstretched_model : isotropic_model<Tag> {
  template <class Lanes>
  static anisotropic_shape<Lanes> shape(const double_double<Lanes>*) {
    const Lanes one(1);
    return anisotropic_shape<Lanes>(one, one, one, Lanes(0));
  }
};

template <class Tag>
struct stretched_model {
  using tag = Tag;
  using family = typename Tag::template type<double>;
  static constexpr std::size_t first = 3, scales = 2;
  static constexpr std::size_t count = 3 + family::parameters.size();

  template <class Lanes>
  static anisotropic_shape<Lanes> shape(const double_double<Lanes>* p) {
    return anisotropic_shape<Lanes>(p[0], p[1], each_lane(p[2], [](double x) { return std::cos(x); }),
                                    each_lane(p[2], [](double x) { return std::sin(x); }));
  }

 private:
  template <class Lanes, class Function>
  static Lanes each_lane(const double_double<Lanes>& x, const Function& function) {
    using real = typename scalar_traits<Lanes>::real;
    std::array<real, sizeof(Lanes) / sizeof(real)> high, low;
    const Lanes rest = low_of(x);
    std::memcpy(high.data(), &x.high, sizeof x.high);
    std::memcpy(low.data(), &rest, sizeof rest);
    for (std::size_t i = 0; i < high.size(); ++i)
      high[i] = static_cast<real>(function(static_cast<double>(high[i]) + static_cast<double>(low[i])));
    Lanes result;
    std::memcpy(&result, high.data(), sizeof result);
    return result;
  }
};

// The interval in which parameter a leaves float32 room for its square, and a scale for the reciprocal of that.
template <class Model>
constexpr std::array<double, 2> float32_interval(std::size_t a) {
  if (a < Model::scales) return {1e-6, 1e6};
  const double most = a < Model::count - Model::family::parameters.size() ? inf : 1e18;
  return {-most, most};
}
template <class Model>
bool fits_float32(const double* parameters, bool samples_visible) {
  using family = typename Model::family;
  for (std::size_t a = 0; a < Model::count; ++a) {
    const auto [lower, upper] = float32_interval<Model>(a);
    if (parameters[a] < lower || parameters[a] > upper) return false;
  }
  // Steep slopes of a heavy tail leave float32.
  if constexpr (float32_sampling_range<family>) {
    if (samples_visible) return family::sampling_fits_float32(parameters[Model::first]);
  }
  return true;
}

// Whether the family itself draws visible normals in closed form, which no table does.
template <class Model>
bool draws_in_closed_form(const double* parameters) {
  if constexpr (special_slope_sampling<typename Model::family>) {
    return Model::family::draws_in_closed_form(parameters[Model::first]);
  } else {
    return false;
  }
}

template <class Model, class Lanes>
auto make_family(const double_double<Lanes>* p) {
  return [p]<std::size_t... I>(std::index_sequence<I...>) {
    return typename Model::tag::template type<Lanes>(p[Model::first + I].high...);
  }(std::make_index_sequence<Model::count - Model::first>());
}
template <class Family, class Shape, class Lanes>
ndf<Family, Lanes, Shape> make_distribution(const Family& family, const Shape& shape,
                                            const double_double<Lanes>*) {
  return {family, shape};
}

// No variable of a function: its first call would hold a lock of the compiler's, which a fork copies.
template <class Tag, class Real, std::size_t Parameters>
inline table_cache<Real, Parameters> cache_of;

// The tables of a density, for as long as someone uses them; none where the parameters lie outside the domain
// or the tables miss the accuracy contract.
template <class Tag, class Real>
std::shared_ptr<const radial_tables<Real>> cached_tables(const double* parameters, unsigned functions) {
  using family = typename Tag::template type<double>;
  constexpr std::size_t own = family::parameters.size(), count = own + (family::shape_invariant ? 0 : 1);
  std::array<double, count> key;
  for (std::size_t i = 0; i < count; ++i) {
    const bool scale = i + own < count;
    const parameter domain = scale ? roughness : family::parameters[i + own - count];
    key[i] = parameters[i];
    const double lower = (functions & of_slope_excess) != 0 ? domain.lower : domain.density_lower;
    if (!(key[i] > lower && key[i] < domain.upper)) return nullptr;
  }
  return cache_of<Tag, Real, count>.get(
      key, functions, [&key](radial_tables<Real>& tables, unsigned missing) {
        const auto build = [&]<std::size_t... I>(std::index_sequence<I...>) {
          tables.build(typename Tag::template type<lanes<double>>(lanes<double>(key[I])...), missing);
        };
        build(std::make_index_sequence<count>());
      });
}

template <class Model, class Real>
auto tables_of(const double* parameters, unsigned functions) {
  if constexpr (requires { Model::tag::template tables<Real>(0.0); }) {  // tables with a name: radial.hpp
    return Model::tag::template tables<Real>(parameters[Model::first]);
  } else {
    return cached_tables<typename Model::tag, Real>(parameters + Model::first, functions);
  }
}

// The density that reads such tables.
template <class Model, class Lanes, class Tables>
auto table_density(const Tables& tables) {
  if constexpr (requires { typename Model::tag::template table_density<Lanes>; }) {
    return typename Model::tag::template table_density<Lanes>(tables);
  } else {
    return tabulated<Lanes>(tables);
  }
}

template <class Model, class Lanes>
MICROFACET_INLINE auto own_distribution(const double_double<Lanes>* p) {
  return make_distribution(make_family<Model>(p), Model::shape(p), p);
}

// Parameters that are the same for all elements, with all digits of what is stored. What is made of them does
// not depend on the operation, and is compiled once.
template <class Model>
using parameter_values = std::array<double, Model::count>;

template <class Model, class Lanes>
std::array<double_double<Lanes>, Model::count> in_all_lanes(const parameter_values<Model>& numbers) {
  const auto lanes_of = [](double number) {
    const auto high = static_cast<lane_of<Lanes>>(number);
    return double_double<Lanes>(Lanes(high),
                                Lanes(static_cast<lane_of<Lanes>>(number - static_cast<double>(high))));
  };
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<double_double<Lanes>, Model::count>{lanes_of(numbers[I])...};
  }(std::make_index_sequence<Model::count>());
}
template <class Model, class Lanes>
[[gnu::noinline]] auto constant_distribution(const parameter_values<Model>& numbers) {
  const auto p = in_all_lanes<Model, Lanes>(numbers);
  return own_distribution<Model>(p.data());
}
template <class Model, class Lanes, class Tables>
[[gnu::noinline]] auto tabulated_distribution(const Tables& tables, const parameter_values<Model>& numbers) {
  const auto p = in_all_lanes<Model, Lanes>(numbers);
  return make_distribution(table_density<Model, Lanes>(tables), Model::shape(p.data()), p.data());
}

}  // namespace microfacet::bindings
