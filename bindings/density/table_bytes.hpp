// The tables of a density as bytes, for whoever reads them without this module's kernels.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <new>

#include "bindings/density/models.hpp"
#include "bindings/loop/numpy.hpp"

namespace microfacet::bindings {

// tables(float64, *parameters) -> bytes, or None where the parameters lie outside the domain or the tables would miss
// the accuracy contract.
template <class Tag>
PyObject* table_bytes(PyObject*, PyObject* const* args, Py_ssize_t count) {
  using model = isotropic_model<Tag>;
  constexpr auto own = static_cast<Py_ssize_t>(model::count - model::first);
  if (count != own + 1)
    return PyErr_Format(PyExc_TypeError, "tables takes %zd arguments, got %zd", own + 1, count);
  std::array<double, model::count> parameters{};
  for (Py_ssize_t i = 0; i < own; ++i)
    parameters[model::first + static_cast<std::size_t>(i)] = PyFloat_AsDouble(args[i + 1]);
  const int in_float64 = PyObject_IsTrue(args[0]);
  if (PyErr_Occurred() != nullptr) return nullptr;
  const auto bytes_of = [](const auto& tables) -> PyObject* {
    if (tables == nullptr) return Py_NewRef(Py_None);
    return PyBytes_FromStringAndSize(reinterpret_cast<const char*>(tables.get()),
                                     static_cast<Py_ssize_t>(sizeof(*tables)));
  };
  try {
    if (in_float64 != 0) return bytes_of(tables_of<model, double>(parameters.data(), of_all | of_visible));
    return bytes_of(tables_of<model, float>(parameters.data(), of_all | of_visible));
  } catch (const std::bad_alloc&) {
    return PyErr_NoMemory();
  }
}

template <class Tag>
bool add_table_bytes(PyObject* space) {
  static PyMethodDef method{"tables",
                            reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(table_bytes<Tag>)),
                            METH_FASTCALL, "The tables of a density as bytes."};
  return add(space, method.ml_name, PyCFunction_New(&method, nullptr));
}

}  // namespace microfacet::bindings
