// What the parameters of a ufunc mean: lanes of parameters -> distributions.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "bindings/density/any_density.hpp"
#include "bindings/density/table_cache.hpp"
#include "bindings/loop/lanes.hpp"
#include "microfacet/smith/ndf.hpp"

namespace microfacet::bindings {

inline constexpr std::size_t most_parameters = 8;

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
  static isotropic_shape<Lanes> shape(const double_double<Lanes>* p, const double* = nullptr) {
    return isotropic_shape<Lanes>(family::shape_invariant ? p[0] : double_double<Lanes>(Lanes(1)));
  }
};

// Directions of a family that is no stretch: under the shape of the other families' directions, so that its
// tables are read by their kernels.
template <class Tag>
struct unstretched_model : isotropic_model<Tag> {
  template <class Lanes>
  static anisotropic_shape<Lanes> shape(const double_double<Lanes>*, const double*) {
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

  // The rotation is a parameter of frozen distributions alone, which is constant.
  template <class Lanes>
  static anisotropic_shape<Lanes> shape(const double_double<Lanes>* p, const double* numbers) {
    using real = lane_of<Lanes>;
    return anisotropic_shape<Lanes>(p[0], p[1], Lanes(static_cast<real>(std::cos(numbers[2]))),
                                    Lanes(static_cast<real>(std::sin(numbers[2]))));
  }
};

// Outside of these float32 has no room for the square of a parameter, nor for the reciprocal of a scale's. A nan
// lies nowhere.
struct interval {
  double lower, upper;
  bool excludes(double x) const { return (x < lower) | (x > upper); }
};
template <class Model>
constexpr std::array<interval, most_parameters> float32_ranges() {
  std::array<interval, most_parameters> ranges{};
  for (std::size_t a = 0; a < Model::count; ++a) {
    const double most = a < Model::count - Model::family::parameters.size() ? inf : 1e18;
    ranges[a] = a < Model::scales ? interval{1e-6, 1e6} : interval{-most, most};
  }
  return ranges;
}
template <class Model>
bool fits_float32(const double* parameters, bool samples_visible) {
  using family = typename Model::family;
  for (std::size_t a = 0; a < Model::count; ++a)
    if (float32_ranges<Model>()[a].excludes(parameters[a])) return false;
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
// Of lanes of type Lanes.
template <class Lanes, class Family, class Shape>
MICROFACET_INLINE ndf<Family, Lanes, Shape> make_distribution(const Family& family, const Shape& shape) {
  return {family, shape};
}
template <class Model, class Lanes>
MICROFACET_INLINE auto varying_distribution(const double_double<Lanes>* p) {
  return make_distribution<Lanes>(make_family<Model>(p), Model::shape(p));
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
    const double lower = (functions & of_mean_excess) != 0 ? domain.lower : domain.density_lower;
    if (!(key[i] > lower && key[i] < domain.upper)) return nullptr;
  }
  return cache_of<Tag, Real, count>.get(
      key, functions, [&key](radial_tables<Real>& tables, unsigned missing) {
        using density = typename Tag::template type<lanes<double>>;
        const auto build = [&]<std::size_t... I>(std::index_sequence<I...>) {
          build_tables(tables, any_density_of(density(lanes<double>(key[I])...)), missing);
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

}  // namespace microfacet::bindings
