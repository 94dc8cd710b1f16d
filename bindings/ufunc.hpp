// One family -> all its NumPy loops.
//
// A model turns lanes of parameters into distributions; an operation turns distributions and lanes of values
// into lanes of results. Their product is a ufunc with float32 and float64 loops. What a float32 loop
// computes in is the family's choice: float32 where its forms keep the accuracy contract in it, else float64.
// A family that is costly to evaluate is prepared (family/prepared.hpp) where its parameters are constant and
// that pays.
#pragma once

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#define PY_ARRAY_UNIQUE_SYMBOL microfacet_array_api
#define PY_UFUNC_UNIQUE_SYMBOL microfacet_ufunc_api
#ifndef MICROFACET_IMPORT_NUMPY
#define NO_IMPORT_ARRAY
#define NO_IMPORT_UFUNC
#endif
#include <numpy/ndarrayobject.h>
#include <numpy/ufuncobject.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "blocks.hpp"
#include "kernels.hpp"
#include "lanes.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/family/prepared.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/smith/sample_visible_bounded.hpp"
#include "microfacet/smith/sample_visible_mixture.hpp"
#include "models.hpp"

namespace microfacet::bindings {

// From this length on a ufunc prepares a density whose parameters are constant.
inline constexpr npy_intp long_array = 8192;

template <std::size_t Inputs, std::size_t Outputs = 1>
struct layout {
  static constexpr std::size_t inputs = Inputs, outputs = Outputs;
};

// WideParameters: parameters are float64 in the float32 loop too, as those of a frozen distribution are.
template <class Model, class Operation, bool WideParameters>
struct ufunc_loops {
  static constexpr std::size_t values = Operation::shape.inputs, outputs = Operation::shape.outputs;
  static constexpr std::size_t inputs = values + Model::count;
  static constexpr block_plan plan{values, inputs, outputs, WideParameters};

  template <class T>
  using stored_parameter = std::conditional_t<WideParameters, double, T>;
  template <class Lanes>
  using parameter_lanes = std::array<twofold<Lanes>, Model::count>;

  template <class Lanes, class Parameter>
  MICROFACET_INLINE static parameter_lanes<Lanes> parameters(const Parameter& parameter) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return parameter_lanes<Lanes>{parameter(I)...};
    }(std::make_index_sequence<Model::count>());
  }
  template <class T>
  static parameter_values<Model> constant_parameters(char* const* args) {
    parameter_values<Model> numbers;
    for (std::size_t a = 0; a < Model::count; ++a)
      numbers[a] = static_cast<double>(*reinterpret_cast<const stored_parameter<T>*>(args[values + a]));
    return numbers;
  }

  // Neither samplers that iterate nor tables that are searched are a chain that a call would interrupt.
  static constexpr bool of_visible_normals = requires { Operation::samples_visible; };
  static constexpr bool iterates = requires { Operation::solves; } && !requires {
    &Model::family::visible_slopes_of;
  } && !requires { &Model::family::visible_facet; };
  static constexpr bool searches = requires { typename Model::tag::template table_density<lanes<float>>; };

  template <class Lanes, class Distribution>
  static constexpr block_kernel<lane_of<Lanes>> table_kernel() {
    if constexpr (iterates || searches) {
      return &evaluate_constant<Operation, Lanes, Distribution>;
    } else {
      return &evaluate_flat<Operation, Lanes, Distribution>;
    }
  }
  template <class Lanes, class Distribution>
  static constexpr block_kernel<lane_of<Lanes>> own_kernel() {
    if constexpr (Model::family::costly == 0 && !iterates) {
      return &evaluate_flat<Operation, Lanes, Distribution>;
    } else {
      return &evaluate_constant<Operation, Lanes, Distribution>;
    }
  }
  template <class Lanes>
  static void evaluate_varying(const void*, const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                               npy_intp n) {
    for (npy_intp i = 0; i < n; i += width<Lanes>) {
      const auto p =
          parameters<Lanes>([&](std::size_t a) { return twofold<Lanes>(load<Lanes>(in[values + a] + i)); });
      evaluate<Operation, Lanes>(own_distribution<Model>(p.data()), in, out, i);
    }
  }

  static std::array<char*, inputs + outputs> shifted(char* const* args, const npy_intp* steps, npy_intp i) {
    std::array<char*, inputs + outputs> at;
    for (std::size_t a = 0; a < at.size(); ++a) at[a] = args[a] + i * steps[a];
    return at;
  }

  // A normal on the horizon by rounding alone stays above it.
  template <class Compute, class T>
  static void keep_above(char* const* args, const npy_intp* steps, npy_intp n) {
    if constexpr (of_visible_normals && !std::is_same_v<Compute, T>) {
      for (npy_intp i = 0; i < n; ++i) {
        T& z = *reinterpret_cast<T*>(args[inputs + 2] + i * steps[inputs + 2]);
        if (z == T(0)) z = smallest<T>();
      }
    }
  }

  template <class Compute, class T>
  static void run(char* const* args, const npy_intp* steps, npy_intp n, bool constant) {
    if (constant) {
      const auto d = constant_distribution<Model, lanes<Compute>>(constant_parameters<T>(args));
      in_blocks<Compute, T>(plan, args, steps, n, true, own_kernel<lanes<Compute>, decltype(d)>(), &d);
      keep_above<Compute, T>(args, steps, n);
    } else if constexpr (WideParameters) {
      // Frozen distributions have constant parameters: no kernel of its own for others.
      for (npy_intp i = 0; i < n; ++i) run<Compute, T>(shifted(args, steps, i).data(), steps, 1, true);
    } else {
      in_blocks<Compute, T>(plan, args, steps, n, false, &evaluate_varying<lanes<Compute>>, nullptr);
    }
  }

  template <class Compute, class T>
  static bool run_prepared(char* const* args, const npy_intp* steps, npy_intp n) {
    const parameter_values<Model> numbers = constant_parameters<T>(args);
    const auto tables = prepared_tables<Model, Compute>(numbers.data(), Operation::needs);
    if (tables == nullptr) return false;
    using table_lanes = lanes<Compute, iterates || searches ? 1 : most_registers>;
    const auto d = prepared_distribution<Model, table_lanes>(*tables, numbers);
    in_blocks<Compute, T>(plan, args, steps, n, true, table_kernel<table_lanes, decltype(d)>(), &d);
    keep_above<Compute, T>(args, steps, n);
    if constexpr (of_visible_normals && std::is_same_v<Compute, float>) draw_rest_in_double(args, steps, n);
    return true;
  }

  // Directions so far below the horizon that tables in float32 do not reach them were left at nan.
  static void draw_rest_in_double(char* const* args, const npy_intp* steps, npy_intp n) {
    const auto left = [&](npy_intp i) {
      const float z = *reinterpret_cast<const float*>(args[inputs + 2] + i * steps[inputs + 2]);
      return z != z;
    };
    for (npy_intp first = 0, last; first < n; first = last + 1) {
      while (first < n && !left(first)) ++first;
      last = first;
      while (last < n && left(last)) ++last;
      if (last == first) continue;
      const auto at = shifted(args, steps, first);
      if constexpr (pays_to_prepare()) {
        run_prepared<double, float>(at.data(), steps, last - first);
      } else {
        run<double, float>(at.data(), steps, last - first, true);
      }
    }
  }

  template <class T>
  static void fill_with_nan(char* const* args, const npy_intp* steps, npy_intp n) {
    for (std::size_t a = inputs; a < inputs + outputs; ++a)
      for (npy_intp i = 0; i < n; ++i) *reinterpret_cast<T*>(args[a] + i * steps[a]) = nan<T>();
  }

  // Whether the scales of element i leave float32 room for their squares and the reciprocals of these.
  static bool fits_float32(char* const* args, const npy_intp* steps, npy_intp i) {
    for (std::size_t a = values; a < values + Model::scales; ++a) {
      const double scale = *reinterpret_cast<const stored_parameter<float>*>(args[a] + i * steps[a]);
      if (scale < 1e-6 || scale > 1e6) return false;
    }
    // Steep slopes of a heavy tail leave float32.
    if constexpr (requires { Operation::samples_visible && Model::family::sampling_fits_float32(0.0); }) {
      constexpr std::size_t own = values + Model::first;
      return Model::family::sampling_fits_float32(
          static_cast<double>(*reinterpret_cast<const stored_parameter<float>*>(args[own] + i * steps[own])));
    }
    return true;
  }

  // Whether a result takes the place of an argument, which then cannot be read a second time.
  static bool in_place(char* const* args) {
    return std::any_of(args + inputs, args + inputs + outputs,
                       [&](const char* out) { return std::find(args, args + inputs, out) != args + inputs; });
  }
  // Whether tables in float32 serve: visible normals may need a second look (draw_rest_in_double).
  static bool serves_float32(char* const* args, const npy_intp* steps) {
    return fits_float32(args, steps, 0) && !(of_visible_normals && in_place(args));
  }

  // Runs of elements of one kind, each in its own arithmetic.
  static void run_in_float32(char* const* args, const npy_intp* steps, npy_intp n, bool constant) {
    for (npy_intp first = 0, last = 0; first < n; first = last) {
      const bool fits = fits_float32(args, steps, first);
      last = constant ? n : first + 1;
      while (last < n && fits_float32(args, steps, last) == fits) ++last;
      const auto at = shifted(args, steps, first);
      if (fits)
        run<float, float>(at.data(), steps, last - first, constant);
      else
        run<double, float>(at.data(), steps, last - first, constant);
    }
  }

  // Whether all that the operation needs of the density is costly: no table stands for a short closed form.
  static constexpr bool pays_to_prepare() {
    if constexpr (Model::family::costly == 0) {
      return false;
    } else if constexpr (of_visible_normals) {
      return !requires { &Model::family::sf_over_density; };
    } else {
      return (Operation::needs & ~Model::family::costly) == 0;
    }
  }

  // A family that solves for visible normals by closed forms composes them from tables in float32, faster.
  static constexpr bool composes_from_tables =
      requires { Operation::composes && &Model::family::sf_over_density; } && Model::family::costly != 0;

  template <class T>
  static void loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void*) {
    const npy_intp n = dimensions[0];
    if (n == 0) return;
    const quiet_floating_point guard;
    const bool constant = std::all_of(steps + values, steps + inputs, [](npy_intp s) { return s == 0; });
    if constexpr (pays_to_prepare()) {
      if (constant && (WideParameters || n >= long_array)) {
        const bool fits = std::is_same_v<T, double> || serves_float32(args, steps);
        if (fits ? run_prepared<T, T>(args, steps, n) : run_prepared<double, T>(args, steps, n)) return;
      }
      if constexpr (of_visible_normals) {  // from tables alone, in float32 if they need it
        if (constant && run_prepared<double, T>(args, steps, n)) return;
        return fill_with_nan<T>(args, steps, n);
      }
    }
    if constexpr (composes_from_tables && std::is_same_v<T, float>) {
      if (constant && serves_float32(args, steps) && run_prepared<float, float>(args, steps, n)) return;
    }
    if constexpr (!of_visible_normals || !pays_to_prepare()) {
      if constexpr (std::is_same_v<T, float> && Model::family::native_float32) {
        run_in_float32(args, steps, n, constant);
      } else {
        run<double, T>(args, steps, n, constant);
      }
    }
  }

  // NumPy keeps pointers to these tables for as long as the ufunc lives.
  static PyObject* make() {
    constexpr std::size_t arguments = inputs + outputs;
    static PyUFuncGenericFunction functions[] = {&loop<float>, &loop<double>};
    static void* data[] = {nullptr, nullptr};
    static std::array<char, 2 * arguments> types = [] {
      std::array<char, 2 * arguments> t{};
      std::fill(t.begin(), t.end(), static_cast<char>(NPY_DOUBLE));
      std::fill_n(t.begin(), arguments, static_cast<char>(NPY_FLOAT));
      if (WideParameters) std::fill_n(t.begin() + values, Model::count, static_cast<char>(NPY_DOUBLE));
      return t;
    }();
    return PyUFunc_FromFuncAndData(functions, data, types.data(), 2, static_cast<int>(inputs),
                                   static_cast<int>(outputs), PyUFunc_None, Operation::name, nullptr, 0);
  }
};

inline bool add(PyObject* space, const char* name, PyObject* value) {
  if (value == nullptr) return false;
  const int status = PyObject_SetAttrString(space, name, value);
  Py_DECREF(value);
  return status == 0;
}

template <class Model, bool WideParameters, class... Operation>
bool add_all(PyObject* space, const char* prefix) {
  return (add(space, (std::string(prefix) + Operation::name).c_str(),
              ufunc_loops<Model, Operation, WideParameters>::make()) &&
          ...);
}

}  // namespace microfacet::bindings
