// Which kernels an operation of a model has. A model turns lanes of parameters into distributions; an
// operation turns distributions and lanes of values into lanes of results.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "bindings/density/models.hpp"
#include "bindings/loop/blocks.hpp"
#include "bindings/loop/kernels.hpp"
#include "bindings/loop/lanes.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::bindings {

template <std::size_t Inputs, std::size_t Outputs = 1>
struct layout {
  static constexpr std::size_t inputs = Inputs, outputs = Outputs;
};

// Kernels on one kind of number, null where there is none: at constant parameters, at varying ones, and on
// tables of the density, in one register or in two, which interleave.
template <class Real>
struct kernel_set {
  block_kernel<Real> constant = nullptr, varying = nullptr, table = nullptr;
  bool table_of_one_register = false;
};

// All that a loop has to know of an operation.
struct operation_kernels {
  block_plan plan;
  unsigned functions;    // functions of the density
  bool samples_visible;  // normals that a direction sees
  kernel_set<float> single;
  kernel_set<double> wide;

  template <class Real>
  const kernel_set<Real>& of() const {
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return wide;
    }
  }
};

template <class Model, class Operation>
struct policy {
  using family = typename Model::family;

  static constexpr bool samples_visible = requires { Operation::samples_visible; };
  static constexpr bool of_cosine = requires { Operation::of_cosine; };
  // A family of the user's has tables alone, which are searched.
  static constexpr bool searches = requires { typename Model::tag::template table_density<lanes<float>>; };
  // Samplers that iterate are no chain that a call would interrupt; nor are tables that are searched.
  // In float32 constants or tables say where they start.
  template <class Real>
  static constexpr bool iterates = requires { Operation::solves; } && !closed_visible_sampling<family> && !(std::is_same_v<Real, float> &&
                                                  (family::tabulate != 0 || started_inversion<family>));
  // Visible normals are drawn without a loop in float32 and iterate in float64.
  template <class Real>
  static constexpr bool one_register =
      searches || requires { Operation::solves; } || (requires { Operation::samples_from_tables; } && std::is_same_v<Real, double>);
  static constexpr bool in_closed_form = tail_quotients<family>;

  // All that the operation needs of the density is a short closed form.
  template <class Real>
  static constexpr bool in_short_form = (Operation::functions & family::tabulate) == 0 && !iterates<Real>;

  template <class Real>
  static constexpr bool computes_in = std::is_same_v<Real, double> || family::float32_arithmetic;

  // Where parameters vary, float32 serves the short forms of a family whose other functions need more.
  template <class Real>
  static constexpr bool varies_in = computes_in<Real> || in_short_form<Real>;

  // Tables pay where all that the operation needs of the density is costly, as float32 is for a family that
  // computes in double: none stands for a short closed form. Visible normals without closed forms are drawn
  // from tables wherever there are any.
  template <class Real>
  static constexpr bool prepares =
      family::tabulate != 0 &&
      (samples_visible ? !in_closed_form
                       : (Operation::functions & ~family::tabulate) == 0 || !computes_in<Real>);
  // With closed forms, in float32 drawing from tables is faster than solving.
  static constexpr bool samples_from_tables =
      requires { Operation::samples_from_tables; } && in_closed_form && family::tabulate != 0;
};

template <class Model, class Operation, class Lanes>
MICROFACET_INLINE void evaluate_parameters(const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                                           std::ptrdiff_t n) {
  for (std::ptrdiff_t i = 0; i < n; i += width<Lanes>) {
    const auto p = [&]<std::size_t... I>(std::index_sequence<I...>) {
      return std::array<double_double<Lanes>, Model::count>{
          double_double<Lanes>(load<Lanes>(in[Operation::shape.inputs + I] + i))...};
    }(std::make_index_sequence<Model::count>());
    evaluate<Operation, Lanes>(own_distribution<Model>(p.data()), in, out, i);
  }
}

template <class Model, class Operation, class Lanes>
void evaluate_varying(const void*, const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                      std::ptrdiff_t n) {
  evaluate_parameters<Model, Operation, Lanes>(in, out, n);
}
// The same without a call inside: what an operation does not need of the parameters is not made of them.
template <class Model, class Operation, class Lanes>
[[gnu::flatten]] void evaluate_varying_flat(const void*, const lane_of<Lanes>* const* in,
                                            lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_parameters<Model, Operation, Lanes>(in, out, n);
}

template <class Model, class Operation, bool Varying, class Real>
constexpr kernel_set<Real> kernels_of() {
  using p = policy<Model, Operation>;
  kernel_set<Real> k;
  if constexpr (!p::searches && p::template computes_in<Real>) {
    using own = decltype(constant_distribution<Model, lanes<Real>>({}));
    if constexpr (p::template in_short_form<Real>) {
      k.constant = &evaluate_flat<Operation, lanes<Real>, own>;
    } else {
      k.constant = &evaluate_constant<Operation, lanes<Real>, own>;
    }
  }
  if constexpr (!p::searches && Varying && p::template varies_in<Real>) {
    if constexpr (p::template in_short_form<Real>) {
      k.varying = &evaluate_varying_flat<Model, Operation, lanes<Real>>;
    } else {
      k.varying = &evaluate_varying<Model, Operation, lanes<Real>>;
    }
  }
  if constexpr (p::template prepares<Real> || (p::samples_from_tables && std::is_same_v<Real, float>)) {
    constexpr bool one_register = p::template one_register<Real>;
    using table_lanes = lanes<Real, one_register ? 1 : most_registers>;
    using own = decltype(tabulated_distribution<Model, table_lanes>(
        *tables_of<Model, Real>(nullptr, Operation::functions), {}));
    k.table_of_one_register = one_register;
    if constexpr (one_register) {
      k.table = &evaluate_constant<Operation, table_lanes, own>;
    } else {
      k.table = &evaluate_flat<Operation, table_lanes, own>;
    }
  }
  return k;
}

template <class Operation>
constexpr std::size_t uniforms_of() {
  if constexpr (requires { Operation::uniforms; }) {
    return Operation::uniforms;
  } else {
    return 0;
  }
}

// Wide parameters are those of a frozen distribution: float64 in the float32 loop too, and constant.
template <class Model, class Operation, bool WideParameters>
inline constexpr operation_kernels kernels_of_operation{
    {Operation::shape.inputs, Operation::shape.inputs + Model::count, Operation::shape.outputs,
     WideParameters, uniforms_of<Operation>(), policy<Model, Operation>::of_cosine},
    Operation::functions,
    policy<Model, Operation>::samples_visible,
    kernels_of<Model, Operation, !WideParameters, float>(),
    kernels_of<Model, Operation, !WideParameters, double>()};

}  // namespace microfacet::bindings
