// Python and NumPy, and a ufunc from its loops.
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
#include <cstddef>
#include <new>
#include <string>

#include "bindings/loop/blocks.hpp"

namespace microfacet::bindings {

inline bool add(PyObject* space, const char* name, PyObject* value) {
  if (value == nullptr) return false;
  const int status = PyObject_SetAttrString(space, name, value);
  Py_DECREF(value);
  return status == 0;
}

// C calls a loop, without the GIL unless it is short: no exception may leave it. Python is told where memory
// ends, and NumPy looks for that after the loop.
template <PyUFuncGenericFunction Loop>
void guarded(char** args, const npy_intp* dimensions, const npy_intp* steps, void* data) {
  try {
    Loop(args, dimensions, steps, data);
  } catch (const std::bad_alloc&) {
    const PyGILState_STATE state = PyGILState_Ensure();
    PyErr_NoMemory();
    PyGILState_Release(state);
  }
}

// The loop of a quantity of a density, whose operation_kernels are its data (loops.cpp).
template <class T>
void density_loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void* data);

// NumPy keeps pointers to these for as long as the ufunc lives, which is until Python ends.
struct ufunc_record {
  std::array<PyUFuncGenericFunction, 2> loops;
  std::array<void*, 2> data;
  std::array<char, 2 * 32> types;
};

// A float32 and a float64 loop. Arguments behind the values of the plan are float64 in both, if they are
// wide.
inline bool add_ufunc(PyObject* space, const std::string& name, const char* own_name, const block_plan& plan,
                      const void* data, const std::array<PyUFuncGenericFunction, 2>& loops) {
  const std::size_t arguments = plan.inputs + plan.outputs;
  auto* record = new ufunc_record{loops, {const_cast<void*>(data), const_cast<void*>(data)}, {}};
  char* const types = record->types.data();
  std::fill_n(types, arguments, static_cast<char>(NPY_FLOAT));
  std::fill_n(types + arguments, arguments, static_cast<char>(NPY_DOUBLE));
  if (plan.wide_parameters)
    std::fill(types + plan.values, types + plan.inputs, static_cast<char>(NPY_DOUBLE));
  return add(space, name.c_str(),
             PyUFunc_FromFuncAndData(record->loops.data(), record->data.data(), types, 2,
                                     static_cast<int>(plan.inputs), static_cast<int>(plan.outputs),
                                     PyUFunc_None, own_name, nullptr, 0));
}

}  // namespace microfacet::bindings
