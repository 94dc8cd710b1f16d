// One family -> all its NumPy loops.
//
// A model turns a row of parameters into a distribution; an operation turns a distribution and a row of
// values into a row of results. Their product is a ufunc (or, where values are directions, a generalised
// ufunc) with float32 and float64 loops. float32 loops evaluate in float64 and round once, so that alpha =
// 1e-4 and the far tails keep full accuracy.
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
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "microfacet/core/vec.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"

namespace microfacet::bindings {

// Kernels compute with nan and inf on purpose: the floating-point flags they raise are not the caller's.
class quiet_floating_point {
 public:
  quiet_floating_point() { std::feholdexcept(&environment_); }
  ~quiet_floating_point() { std::fesetenv(&environment_); }
  quiet_floating_point(const quiet_floating_point&) = delete;
  quiet_floating_point& operator=(const quiet_floating_point&) = delete;

 private:
  std::fenv_t environment_;
};

template <class Family, std::size_t... I>
Family make_family(const double* shape, std::index_sequence<I...>) {
  return Family(shape[I]...);
}

// Parameters alpha, then the family's own: the distributions of the elementwise functions.
template <class Family>
struct isotropic_model {
  static constexpr std::size_t shape_parameters = Family::parameters.size();
  static constexpr std::size_t count = 1 + shape_parameters;
  using distribution = ndf<Family, double, isotropic_shape<double>>;

  static distribution make(const double* p) {
    if constexpr (Family::shape_invariant) {
      return {make_family<Family>(p + 1, std::make_index_sequence<shape_parameters>()),
              isotropic_shape<double>(p[0])};
    } else {
      return {make_family<Family>(p, std::make_index_sequence<count>()), isotropic_shape<double>(1.0)};
    }
  }
};

// Parameters alpha_x, alpha_y, rotation, then the family's own: the distributions of the frozen classes.
template <class Family>
struct stretched_model {
  static constexpr std::size_t shape_parameters = Family::parameters.size();
  static constexpr std::size_t count = 3 + shape_parameters;
  using distribution = ndf<Family, double, anisotropic_shape<double>>;

  static distribution make(const double* p) {
    return {make_family<Family>(p + 3, std::make_index_sequence<shape_parameters>()),
            anisotropic_shape<double>(p[0], p[1], std::cos(p[2]), std::sin(p[2]))};
  }
};

// A family that is no stretch of one density has no anisotropic form: its directions take alpha.
template <class Family>
using direction_model =
    std::conditional_t<Family::shape_invariant, stretched_model<Family>, isotropic_model<Family>>;

// The lengths of an operation's inputs and output; 0 stands for a scalar.
template <std::size_t N>
struct layout {
  std::array<int, N> inputs;
  int output;

  constexpr bool vectors() const {
    return output > 0 || std::any_of(inputs.begin(), inputs.end(), [](int n) { return n > 0; });
  }
  constexpr int values() const {
    int total = 0;
    for (const int n : inputs) total += n > 0 ? n : 1;
    return total;
  }
};

// WideParameters: parameters are float64 in the float32 loop too, as those of a frozen distribution are.
template <class Model, class Operation, bool WideParameters>
struct ufunc_loops {
  static constexpr auto shape = Operation::shape;
  static constexpr std::size_t value_inputs = shape.inputs.size();
  static constexpr std::size_t inputs = value_inputs + Model::count;

  template <class T>
  static void loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void*) {
    const quiet_floating_point guard;
    std::array<double, shape.values()> values{};
    std::array<double, Model::count> parameters{}, previous{};
    std::array<double, shape.output + 1> results{};
    std::optional<typename Model::distribution> distribution;
    for (npy_intp i = 0; i < dimensions[0]; ++i) {
      const npy_intp* core = steps + inputs + 1;  // strides inside vectors follow those of the arguments
      double* value = values.data();
      for (std::size_t a = 0; a < value_inputs; ++a) {
        const char* source = args[a] + i * steps[a];
        if (shape.inputs[a] == 0) {
          *value++ = load<T>(source);
        } else {
          for (int k = 0; k < shape.inputs[a]; ++k) *value++ = load<T>(source + k * *core);
          ++core;
        }
      }
      for (std::size_t a = 0; a < Model::count; ++a) {
        parameters[a] = load<std::conditional_t<WideParameters, double, T>>(args[value_inputs + a] +
                                                                            i * steps[value_inputs + a]);
      }
      if (!distribution || std::memcmp(parameters.data(), previous.data(), sizeof previous) != 0) {
        distribution.emplace(Model::make(parameters.data()));
        previous = parameters;
      }
      Operation::apply(*distribution, values.data(), results.data());
      char* target = args[inputs] + i * steps[inputs];
      if (shape.output == 0) {
        *reinterpret_cast<T*>(target) = static_cast<T>(results[0]);
      } else {
        for (int k = 0; k < shape.output; ++k)
          *reinterpret_cast<T*>(target + k * *core) = static_cast<T>(results[k]);
      }
    }
  }

  template <class T>
  static double load(const char* source) {
    return static_cast<double>(*reinterpret_cast<const T*>(source));
  }

  static std::string signature() {
    std::string text;
    const auto core = [](int n) { return n > 0 ? "(" + std::to_string(n) + ")" : std::string("()"); };
    for (const int n : shape.inputs) text += core(n) + ",";
    for (std::size_t i = 0; i < Model::count; ++i) text += "(),";
    text.back() = '-';
    return text + ">" + core(shape.output);
  }

  // NumPy keeps pointers to these tables for as long as the ufunc lives.
  static PyObject* make() {
    static PyUFuncGenericFunction functions[] = {&loop<float>, &loop<double>};
    static void* data[] = {nullptr, nullptr};
    static std::array<char, 2 * (inputs + 1)> types = [] {
      std::array<char, 2 * (inputs + 1)> t{};
      std::fill(t.begin(), t.end(), static_cast<char>(NPY_DOUBLE));
      std::fill_n(t.begin(), inputs + 1, static_cast<char>(NPY_FLOAT));
      if (WideParameters) std::fill_n(t.begin() + value_inputs, Model::count, static_cast<char>(NPY_DOUBLE));
      return t;
    }();
    const std::string text = signature();
    return PyUFunc_FromFuncAndDataAndSignature(functions, data, types.data(), 2, static_cast<int>(inputs), 1,
                                               PyUFunc_None, Operation::name, nullptr, 0,
                                               shape.vectors() ? text.c_str() : nullptr);
  }
};

inline bool add(PyObject* space, const char* name, PyObject* value) {
  if (value == nullptr) return false;
  const int status = PyObject_SetAttrString(space, name, value);
  Py_DECREF(value);
  return status == 0;
}

template <class Model, bool WideParameters, class... Operation>
bool add_all(PyObject* space) {
  return (add(space, Operation::attribute, ufunc_loops<Model, Operation, WideParameters>::make()) && ...);
}

}  // namespace microfacet::bindings
