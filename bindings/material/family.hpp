// A family as an array_distribution.
#pragma once

#include <cstddef>

#include "bindings/density/distributions.hpp"
#include "bindings/density/operations.hpp"
#include "bindings/material/distribution.hpp"
#include "bindings/material/single.hpp"

namespace microfacet::bindings {

// The kernels of one model that materials use. They are those of the quantities of directions.
template <class Model>
struct kernels_for_materials {
  using family = typename Model::family;
  template <class Operation>
  static const operation_kernels* of() {
    return &kernels_of_operation<Model, Operation, true>;
  }
  static const operation_kernels* of(quantity q) {
    switch (q) {
      case quantity::D:
        return of<D_of_normal>();
      case quantity::sigma:
        return of<sigma_of_direction>();
      case quantity::visible:
        return of<visible_sample>();
      case quantity::visible_of_mixture:
        if constexpr (samples_visible<family> && !closed_visible_sampling<family>)
          return of<visible_sample_of_mixture>();
        break;
      case quantity::visible_bounded:
        if constexpr (bounded_facet_sampling<family>) return of<bounded_sample>();
        break;
      case quantity::count:
        break;
    }
    return nullptr;
  }

  template <class Real>
  static bool with(const double* parameters, void (*then)(const array_distribution<Real>&, void*),
                   void* data) {
    if (std::is_same_v<Real, float> && !fits_float32<Model>(parameters, true)) return false;
    parameter_values<Model> numbers;
    std::copy_n(parameters, numbers.size(), numbers.begin());
    array_distribution<Real> d;
    const auto run = [&](const void* own, const void* one_register, const void* two_registers) {
      for (std::size_t k = 0; k < d.functions.size(); ++k) {
        const operation_kernels* op = of(static_cast<quantity>(k));
        if (op == nullptr) continue;
        const kernel_set<Real>& kernels = op->of<Real>();
        const bool closed = op->samples_visible && draws_in_closed_form<Model>(numbers.data());
        const void* const table = closed                          ? nullptr
                                  : kernels.table_of_one_register ? one_register
                                                                  : two_registers;
        if (kernels.table != nullptr && table != nullptr) {
          d.functions[k] = {kernels.table, table};
        } else if (kernels.constant != nullptr && own != nullptr) {
          d.functions[k] = {kernels.constant, own};
        }
      }
      then(d, data);
      return true;
    };
    if constexpr (family::tabulate == 0) {
      const auto own = constant_distribution<Model, lanes<Real>>(numbers);
      d.fused = &fused_kernels_of<known_distribution<std::remove_const_t<decltype(own)>>, Real>;
      d.fused_distribution = &own;
      return run(&own, nullptr, nullptr);
    } else {
      const auto run_on = [&](const void* one_register, const void* two_registers) {
        if constexpr (family::tables_alone) {
          return run(nullptr, one_register, two_registers);
        } else if constexpr (family::float32_arithmetic || std::is_same_v<Real, double>) {
          const auto own = constant_distribution<Model, lanes<Real>>(numbers);
          return run(&own, one_register, two_registers);
        } else {
          return run(nullptr, one_register, two_registers);
        }
      };
      const auto tables = tables_of<Model, Real>(numbers.data(), visible_sample::functions);
      if (tables != nullptr) {
        const auto one = tabulated_distribution<Model, lanes<Real>>(*tables, numbers);
        const auto two = tabulated_distribution<Model, lanes<Real, most_registers>>(*tables, numbers);
        if constexpr (std::is_same_v<decltype(one), const tabulated_directions<Real>>) {
          d.fused = &fused_kernels_on_tables<Real>(), d.fused_distribution = &one;
          return run_on(&one, &two);
        } else if constexpr (std::is_same_v<Real, double>) {
          d.fused = &fused_kernels_on_arrays();
          return run_on(&one, &two);
        } else {
          return false;  // what is searched is compiled once
        }
      }
      if constexpr (std::is_same_v<Real, double> && !family::tables_alone) {
        d.fused = &fused_kernels_on_arrays();
        return run_on(nullptr, nullptr);
      } else {
        return false;
      }
    }
  }
};

template <class Model>
bool add_materials_of(PyObject* space) {
  using kernels = kernels_for_materials<Model>;
  return add_materials(space,
                       {Model::count, &kernels::template with<float>, &kernels::template with<double>});
}

}  // namespace microfacet::bindings
