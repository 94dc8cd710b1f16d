// Tables of densities, whatever their family: how they are built, and the kernels that read them. Instantiated for
// each kind of number in a translation unit of its own (tables_float32.cpp, tables_float64.cpp).
#pragma once

#include <array>

#include "bindings/density/any_density.hpp"
#include "bindings/density/operations.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::bindings {

template <class Real>
void build_tables(radial_tables<Real>& tables, const any_density& density, unsigned functions) {
  tables.build(density, functions);
}

template <class Operation, class Lanes, class Shape>
void evaluate_flat_from_tables(const void* distribution, const lane_of<Lanes>* const* in,
                               lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_constant<Operation, Lanes, ndf<tabulated<Lanes>, Lanes, Shape>>(distribution, in, out, n);
}
template <class Operation, class Lanes, class Shape>
void evaluate_from_tables(const void* distribution, const lane_of<Lanes>* const* in,
                          lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_constant<Operation, Lanes, ndf<tabulated<Lanes>, Lanes, Shape>>(distribution, in, out, n);
}

template <class Operation, class Lanes>
void evaluate_varying_from_tables(const void* tables, const lane_of<Lanes>* const* in,
                                  lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  const tabulated<Lanes> density(**static_cast<const radial_tables<lane_of<Lanes>>* const*>(tables));
  for (std::ptrdiff_t i = 0; i < n; i += width<Lanes>) {
    const double_double<Lanes> alpha(load<Lanes>(in[Operation::inputs] + i));
    evaluate<Operation, Lanes>(make_distribution<Lanes>(density, isotropic_shape<Lanes>(alpha)), in, out, i);
  }
}

template <template <class> class Shape, class Real, class Operation>
constexpr block_kernel<Real> kernel() {
  if constexpr (table_of_one_register<Operation, Real>) {
    return &evaluate_from_tables<Operation, lanes<Real>, Shape<lanes<Real>>>;
  } else {
    using table_lanes = lanes<Real, most_registers>;
    return &evaluate_flat_from_tables<Operation, table_lanes, Shape<table_lanes>>;
  }
}
// Compiled because they are mentioned.
template <template <class> class Shape, class Real, class... Operation>
constexpr auto kernels(operation_list<Operation...>) {
  return std::array{kernel<Shape, Real, Operation>()...};
}
template <class Real, class... Operation>
constexpr auto varying_kernels(operation_list<Operation...>) {
  return std::array{&evaluate_varying_from_tables<Operation, lanes<Real, most_registers>>...};
}
using visible_operations = operation_list<visible_sample, visible_sample_of_mixture>;
template <class Real>
struct table_kernels {
  [[gnu::used]] static constexpr auto isotropic = kernels<isotropic_shape, Real>(isotropic_operations());
  [[gnu::used]] static constexpr auto varying = varying_kernels<Real>(isotropic_operations());
  [[gnu::used]] static constexpr auto of_directions =
      kernels<anisotropic_shape, Real>(direction_operations());
  [[gnu::used]] static constexpr auto visible = kernels<anisotropic_shape, Real>(visible_operations());
};

}  // namespace microfacet::bindings
