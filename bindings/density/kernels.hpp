// Kernels: one operation of one distribution over contiguous arrays, and which of them an operation of a model has.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "bindings/density/distributions.hpp"
#include "bindings/loop/blocks.hpp"
#include "bindings/loop/lanes.hpp"
#include "microfacet/core/vec.hpp"

namespace microfacet::bindings {

template <std::size_t N>
struct name_of_operation {
  char text[N];
  consteval name_of_operation(const char (&literal)[N]) { std::copy_n(literal, N, text); }
};

// Turns a distribution and lanes of values into lanes of results: a derived class states how by `apply`, and
// which of these are otherwise.
template <name_of_operation Name, std::size_t Inputs, unsigned Functions, std::size_t Outputs = 1>
struct operation {
  static constexpr const char* name = Name.text;
  static constexpr std::size_t inputs = Inputs, outputs = Outputs;
  static constexpr unsigned functions = Functions;    // of the density
  static constexpr std::size_t uniforms = 0;          // the last inputs, if they are random numbers
  static constexpr bool of_cosine = false;            // the first input is a cosine
  static constexpr bool samples_visible = false;      // draws normals that a direction sees
  static constexpr bool solves = false;               // iterates, unless the family has a closed form
  static constexpr bool samples_from_tables = false;  // in float32, even where there is a closed form
};

template <class Lanes>
MICROFACET_INLINE void store_at(const Lanes& y, lane_of<Lanes>* const* out, std::ptrdiff_t i) {
  store(y, out[0] + i);
}
template <class Lanes>
MICROFACET_INLINE void store_at(const vec3<Lanes>& y, lane_of<Lanes>* const* out, std::ptrdiff_t i) {
  store(y.x, out[0] + i), store(y.y, out[1] + i), store(y.z, out[2] + i);
}

// One step of lanes, from element i on.
template <class Operation, class Lanes, class Distribution>
MICROFACET_INLINE void evaluate(const Distribution& d, const lane_of<Lanes>* const* in,
                                lane_of<Lanes>* const* out, std::ptrdiff_t i) {
  std::array<Lanes, Operation::inputs> x;
  for (std::size_t a = 0; a < x.size(); ++a) x[a] = load<Lanes>(in[a] + i);
  store_at(Operation::apply(d, x.data()), out, i);
}

template <class Operation, class Lanes, class Distribution>
void evaluate_constant(const void* distribution, const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                       std::ptrdiff_t n) {
  // A copy, which no store to an array can change.
  const Distribution d = *static_cast<const Distribution*>(distribution);
  for (std::ptrdiff_t i = 0; i < n; i += width<Lanes>) evaluate<Operation, Lanes>(d, in, out, i);
}

// The same without a call inside: for what is one chain of operations, a table or a short closed form.
template <class Operation, class Lanes, class Distribution>
[[gnu::flatten]] void evaluate_flat(const void* distribution, const lane_of<Lanes>* const* in,
                                    lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_constant<Operation, Lanes, Distribution>(distribution, in, out, n);
}

// On the tables of any family, which have one type: defined in table_kernels.hpp, and compiled once. The second is for
// operations that iterate.
template <class Operation, class Lanes, class Shape>
[[gnu::flatten]] void evaluate_flat_from_tables(const void* distribution, const lane_of<Lanes>* const* in,
                                                lane_of<Lanes>* const* out, std::ptrdiff_t n);
template <class Operation, class Lanes, class Shape>
void evaluate_from_tables(const void* distribution, const lane_of<Lanes>* const* in,
                          lane_of<Lanes>* const* out, std::ptrdiff_t n);
// Of the densities that have tables alone, at roughnesses that vary: the context is a pointer to the tables.
template <class Operation, class Lanes>
[[gnu::flatten]] void evaluate_varying_from_tables(const void* tables, const lane_of<Lanes>* const* in,
                                                   lane_of<Lanes>* const* out, std::ptrdiff_t n);

// Parameters that vary are arrays like the values, and stand behind them.
template <class Model, class Operation, class Lanes>
void evaluate_varying(const void*, const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                      std::ptrdiff_t n) {
  for (std::ptrdiff_t i = 0; i < n; i += width<Lanes>) {
    const auto p = [&]<std::size_t... I>(std::index_sequence<I...>) {
      return std::array<double_double<Lanes>, Model::count>{
          double_double<Lanes>(load<Lanes>(in[Operation::inputs + I] + i))...};
    }(std::make_index_sequence<Model::count>());
    evaluate<Operation, Lanes>(varying_distribution<Model>(p.data()), in, out, i);
  }
}
// The same without a call inside: what an operation does not need of the parameters is not made of them.
template <class Model, class Operation, class Lanes>
[[gnu::flatten]] void evaluate_varying_flat(const void* none, const lane_of<Lanes>* const* in,
                                            lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_varying<Model, Operation, Lanes>(none, in, out, n);
}

// Kernels on one kind of number, null where there is none: at constant parameters, at varying ones, and on
// tables of the density; and what makes the distributions that the first and the last of them read, and the tables
// that the second reads where there is nothing else.
template <class Real>
struct kernel_set {
  using maker = bool (*)(const double* parameters, unsigned functions, distribution_in_use&);
  block_kernel<Real> constant = nullptr, varying = nullptr, table = nullptr;
  bool table_of_one_register = false;
  maker own_forms = nullptr, tables = nullptr, varying_tables = nullptr;
};

// All that a loop has to know of an operation of a model.
struct operation_kernels {
  block_plan plan;
  unsigned functions;
  bool samples_visible;
  std::array<interval, most_parameters> float32_ranges;  // of each parameter
  bool (*fits_float32)(const double* parameters, bool samples_visible);
  bool (*draws_in_closed_form)(const double* parameters);
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

// How an operation is evaluated from tables. Two registers interleave the chains of look-ups; what iterates, as visible
// normals do in float64, or searches is no chain.
template <class Operation, class Real, bool Searches = false>
constexpr bool table_of_one_register =
    Searches || (Operation::samples_from_tables && std::is_same_v<Real, double>);

template <class Model, class Operation, bool Varying, class Real>
constexpr kernel_set<Real> kernels_of() {
  using family = typename Model::family;
  constexpr bool single = std::is_same_v<Real, float>;
  // A density of the user's has tables alone, which are searched.
  constexpr bool searches = requires { typename Model::tag::template table_density<lanes<float>>; };
  constexpr bool alone = searches || family::tables_alone;
  // In float32 constants or tables say where an inversion starts, and nothing loops.
  constexpr bool iterates = Operation::solves && !closed_visible_sampling<family> &&
                            !(single && (family::tabulate != 0 || started_inversion<family>));
  constexpr bool in_closed_form = tail_quotients<family>;
  // All that the operation needs of the density is a short closed form.
  constexpr bool is_short = (Operation::functions & family::tabulate) == 0 && !iterates;
  // float32 serves the short forms of a family whose other functions need more, but not with wide parameters.
  constexpr bool native = !single || family::float32_arithmetic, computes = native || (is_short && Varying);
  // Tables pay where all that the operation needs of the density is costly, as float32 is for a family that
  // computes in double: none stands for a short closed form. Visible normals without closed forms are drawn
  // from tables wherever there are any; with closed forms, composing them from tables is faster than solving
  // in float32.
  constexpr bool pays = Operation::samples_visible
                            ? !in_closed_form || (Operation::samples_from_tables && single)
                            : (Operation::functions & ~family::tabulate) == 0 || !native;
  kernel_set<Real> k;
  if constexpr (!alone && computes) {
    using own = decltype(constant_distribution<Model, lanes<Real>>({}));
    if constexpr (is_short) {
      k.constant = &evaluate_flat<Operation, lanes<Real>, own>;
    } else {
      k.constant = &evaluate_constant<Operation, lanes<Real>, own>;
    }
    k.own_forms = &use_own_forms<Model, lanes<Real>>;
    if constexpr (Varying && is_short) {
      k.varying = &evaluate_varying_flat<Model, Operation, lanes<Real>>;
    } else if constexpr (Varying) {
      k.varying = &evaluate_varying<Model, Operation, lanes<Real>>;
    }
  }
  if constexpr (family::tables_alone && Varying && family::parameters.empty()) {
    static_assert(family::shape_invariant);
    k.varying = &evaluate_varying_from_tables<Operation, lanes<Real, most_registers>>;
    k.varying_tables = &use_bare_tables<Model, Real>;
  }
  if constexpr (family::tabulate != 0 && pays) {
    constexpr bool one_register = table_of_one_register<Operation, Real, searches>;
    using table_lanes = lanes<Real, one_register ? 1 : most_registers>;
    using own = decltype(tabulated_distribution<Model, table_lanes>(
        *tables_of<Model, Real>(nullptr, Operation::functions), {}));
    using shape = std::remove_cvref_t<decltype(std::declval<own>().shape())>;
    k.table_of_one_register = one_register;
    k.tables = &use_tables<Model, table_lanes>;
    if constexpr (searches) {
      k.table = &evaluate_constant<Operation, table_lanes, own>;
    } else if constexpr (one_register) {
      k.table = &evaluate_from_tables<Operation, table_lanes, shape>;
    } else {
      k.table = &evaluate_flat_from_tables<Operation, table_lanes, shape>;
    }
  }
  return k;
}

// Wide parameters are those of a frozen distribution: float64 in the float32 loop too, and constant.
template <class Model, class Operation, bool WideParameters>
inline constexpr operation_kernels kernels_of_operation{
    {Operation::inputs, Operation::inputs + Model::count, Operation::outputs, WideParameters,
     Operation::uniforms, Operation::of_cosine},
    Operation::functions,
    Operation::samples_visible,
    float32_ranges<Model>(),
    &fits_float32<Model>,
    &draws_in_closed_form<Model>,
    kernels_of<Model, Operation, !WideParameters, float>(),
    kernels_of<Model, Operation, !WideParameters, double>()};

}  // namespace microfacet::bindings
