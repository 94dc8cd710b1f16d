// One family -> all its NumPy loops. The product of a model and an operation (policy.hpp) is a ufunc with
// float32 and float64 loops. What a float32 loop computes in is the family's choice: float32 where its forms
// keep the accuracy contract in it, else float64. A family that is costly to evaluate is prepared
// (tabulated/tabulated.hpp) where its parameters are constant and that pays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "bindings/loop/blocks.hpp"
#include "bindings/loop/lanes.hpp"
#include "bindings/loop/numpy.hpp"
#include "bindings/loop/policy.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"

namespace microfacet::bindings {

// From this length on a ufunc prepares a density whose parameters are constant.
inline constexpr npy_intp long_array = 8192;

// The loops of all operations of a model: NumPy hands back the kernels of the one that is called.
// WideParameters: parameters are float64 in the float32 loop too, as those of a frozen distribution are.
template <class Model, bool WideParameters>
struct ufunc_loops {
  using family = typename Model::family;
  template <class T>
  using stored_parameter = std::conditional_t<WideParameters, double, T>;
  using arguments = std::array<char*, 16>;

  template <class T>
  static double stored(const operation_kernels& op, char* const* args, std::size_t parameter) {
    return static_cast<double>(
        *reinterpret_cast<const stored_parameter<T>*>(args[op.plan.values + parameter]));
  }
  template <class T>
  static parameter_values<Model> constant_parameters(const operation_kernels& op, char* const* args) {
    parameter_values<Model> numbers;
    for (std::size_t a = 0; a < Model::count; ++a) numbers[a] = stored<T>(op, args, a);
    return numbers;
  }
  static arguments shifted(const operation_kernels& op, char* const* args, const npy_intp* steps,
                           npy_intp i) {
    arguments at;
    for (std::size_t a = 0; a < op.plan.inputs + op.plan.outputs; ++a) at[a] = args[a] + i * steps[a];
    return at;
  }

  // A normal on the horizon by rounding alone stays above it.
  template <class Compute, class T>
  static void keep_above(const operation_kernels& op, char* const* args, const npy_intp* steps, npy_intp n) {
    if (!op.samples_visible || std::is_same_v<Compute, T>) return;
    const std::size_t out = op.plan.inputs + 2;
    for (npy_intp i = 0; i < n; ++i) {
      T& z = *reinterpret_cast<T*>(args[out] + i * steps[out]);
      if (z == T(0)) z = smallest<T>();
    }
  }

  template <class Compute, class T>
  static void run(const operation_kernels& op, char* const* args, const npy_intp* steps, npy_intp n,
                  bool constant) {
    if (constant) {
      const auto d = constant_distribution<Model, lanes<Compute>>(constant_parameters<T>(op, args));
      in_blocks<Compute, T>(op.plan, args, steps, n, true, op.of<Compute>().constant, &d);
      keep_above<Compute, T>(op, args, steps, n);
    } else if (WideParameters) {
      // Frozen distributions have constant parameters: no kernel of its own for others.
      for (npy_intp i = 0; i < n; ++i)
        run<Compute, T>(op, shifted(op, args, steps, i).data(), steps, 1, true);
    } else {
      in_blocks<Compute, T>(op.plan, args, steps, n, false, op.of<Compute>().varying, nullptr);
    }
  }

  // Whether there are tables of these parameters that keep the contract.
  template <class Compute, class T>
  static bool run_tabulated(const operation_kernels& op, char* const* args, const npy_intp* steps,
                            npy_intp n) {
    const auto numbers = constant_parameters<T>(op, args);
    const auto tables = tables_of<Model, Compute>(numbers.data(), op.functions);
    if (tables == nullptr) return false;
    const auto run = [&](const auto& d) {
      in_blocks<Compute, T>(op.plan, args, steps, n, true, op.of<Compute>().table, &d);
    };
    if (op.of<Compute>().table_of_one_register)
      run(tabulated_distribution<Model, lanes<Compute>>(*tables, numbers));
    else
      run(tabulated_distribution<Model, lanes<Compute, most_registers>>(*tables, numbers));
    keep_above<Compute, T>(op, args, steps, n);
    if constexpr (std::is_same_v<Compute, float> && std::is_same_v<T, float>)
      if (op.samples_visible) draw_rest_in_double(op, args, steps, n);
    return true;
  }

  // Directions so far below the horizon that tables in float32 do not reach them were left at nan.
  static void draw_rest_in_double(const operation_kernels& op, char* const* args, const npy_intp* steps,
                                  npy_intp n) {
    const std::size_t out = op.plan.inputs + 2;
    const auto left = [&](npy_intp i) {
      const float z = *reinterpret_cast<const float*>(args[out] + i * steps[out]);
      return z != z;
    };
    for (npy_intp first = 0, last; first < n; first = last + 1) {
      while (first < n && !left(first)) ++first;
      last = first;
      while (last < n && left(last)) ++last;
      if (last == first) continue;
      const arguments at = shifted(op, args, steps, first);
      const bool drawn =
          op.wide.table != nullptr && run_tabulated<double, float>(op, at.data(), steps, last - first);
      if (!drawn && op.wide.constant != nullptr) run<double, float>(op, at.data(), steps, last - first, true);
    }
  }

  template <class T>
  static void fill_with_nan(const operation_kernels& op, char* const* args, const npy_intp* steps,
                            npy_intp n) {
    for (std::size_t a = op.plan.inputs; a < op.plan.inputs + op.plan.outputs; ++a)
      for (npy_intp i = 0; i < n; ++i) *reinterpret_cast<T*>(args[a] + i * steps[a]) = nan<T>();
  }

  static bool fits_float32(const operation_kernels& op, char* const* args, const npy_intp* steps,
                           npy_intp i) {
    const arguments at = shifted(op, args, steps, i);
    return bindings::fits_float32<Model>(constant_parameters<float>(op, at.data()).data(),
                                         op.samples_visible);
  }
  // Whether a result takes the place of an argument, which then cannot be read a second time.
  static bool in_place(const operation_kernels& op, char* const* args) {
    char* const* const end = args + op.plan.inputs;
    return std::any_of(end, end + op.plan.outputs,
                       [&](const char* out) { return std::find(args, end, out) != end; });
  }
  // Whether tables in float32 serve: visible normals may need a second look (draw_rest_in_double).
  static bool serves_float32(const operation_kernels& op, char* const* args, const npy_intp* steps) {
    return fits_float32(op, args, steps, 0) && !(op.samples_visible && in_place(op, args));
  }

  // Whether no parameter of n elements leaves float32.
  static bool all_fit_float32(const operation_kernels& op, char* const* args, const npy_intp* steps,
                              npy_intp n) {
    int outside = 0;
    for (std::size_t a = 0; a < Model::count; ++a) {
      const auto [lower, upper] = float32_interval<Model>(a);
      const char* const parameter = args[op.plan.values + a];
      const npy_intp step = steps[op.plan.values + a];
      const auto count = [&](npy_intp stride) {
        for (npy_intp i = 0; i < n; ++i) {
          const double x =
              static_cast<double>(*reinterpret_cast<const stored_parameter<float>*>(parameter + i * stride));
          outside |= static_cast<int>(x < lower) | static_cast<int>(x > upper);
        }
      };
      if (step == sizeof(stored_parameter<float>))
        count(sizeof(stored_parameter<float>));  // as vectors
      else
        count(step);
    }
    return outside == 0;
  }
  // Blocks of one kind, and where there are both, runs of elements, each in its own arithmetic.
  static void run_in_float32(const operation_kernels& op, char* const* args, const npy_intp* steps,
                             npy_intp n, bool constant) {
    if (constant || op.samples_visible) return run_by_elements(op, args, steps, n, constant);
    for (npy_intp first = 0; first < n; first += block_length) {
      const npy_intp count = std::min<npy_intp>(block_length, n - first);
      const arguments at = shifted(op, args, steps, first);
      if (all_fit_float32(op, at.data(), steps, count))
        run<float, float>(op, at.data(), steps, count, false);
      else
        run_by_elements(op, at.data(), steps, count, false);
    }
  }
  static void run_by_elements(const operation_kernels& op, char* const* args, const npy_intp* steps,
                              npy_intp n, bool constant) {
    for (npy_intp first = 0, last = 0; first < n; first = last) {
      const bool fits = fits_float32(op, args, steps, first);
      last = constant ? n : first + 1;
      while (last < n && fits_float32(op, args, steps, last) == fits) ++last;
      const arguments at = shifted(op, args, steps, first);
      if (fits)
        run<float, float>(op, at.data(), steps, last - first, constant);
      else
        run<double, float>(op, at.data(), steps, last - first, constant);
    }
  }

  // Whether tables did it.
  template <class T>
  static bool ran_from_tables(const operation_kernels& op, char* const* args, const npy_intp* steps,
                              npy_intp n) {
    const bool alone = op.wide.constant == nullptr;
    if (!WideParameters && !alone && n < long_array) return false;
    if (op.samples_visible && draws_in_closed_form<Model>(constant_parameters<T>(op, args).data())) return false;
    if (std::is_same_v<T, float> && op.single.table != nullptr && serves_float32(op, args, steps) &&
        run_tabulated<float, T>(op, args, steps, n))
      return true;
    return op.wide.table != nullptr && run_tabulated<double, T>(op, args, steps, n);
  }

  template <class T>
  static void loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void* data) {
    const operation_kernels& op = *static_cast<const operation_kernels*>(data);
    const npy_intp n = dimensions[0];
    if (n == 0) return;
    const quiet_floating_point guard;
    const bool constant =
        std::all_of(steps + op.plan.values, steps + op.plan.inputs, [](npy_intp s) { return s == 0; });
    if constexpr (family::tabulate != 0) {
      if (constant && ran_from_tables<T>(op, args, steps, n)) return;
      if (op.wide.constant == nullptr) return fill_with_nan<T>(op, args, steps, n);
    }
    if (std::is_same_v<T, float> &&
        (constant || WideParameters ? op.single.constant : op.single.varying) != nullptr)
      run_in_float32(op, args, steps, n, constant);
    else
      run<double, T>(op, args, steps, n, constant);
  }
};

template <class Model, bool WideParameters, class... Operation>
bool add_all(PyObject* space, const char* prefix) {
  using loops = ufunc_loops<Model, WideParameters>;
  return (add_ufunc(space, std::string(prefix) + Operation::name, Operation::name,
                    kernels_of_operation<Model, Operation, WideParameters>.plan,
                    &kernels_of_operation<Model, Operation, WideParameters>,
                    {&guarded<&loops::template loop<float>>, &guarded<&loops::template loop<double>>}) &&
          ...);
}

}  // namespace microfacet::bindings
