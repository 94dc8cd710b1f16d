// Densities of the user's own: tables that Python makes and names by a number, their handle, which stands
// where a family has its shape parameters.
#pragma once

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <unordered_map>

#include "bindings/density/fork_safe_lock.hpp"
#include "bindings/density/operations.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "microfacet/tabulated/user_density.hpp"

namespace microfacet::bindings {

struct radial_entry {
  user_density_tables<double> wide;
  user_density_tables<float> narrow;
};

class radial_registry {
 public:
  double add(std::shared_ptr<const radial_entry> entry) {
    const locked lock(shared_lock);
    entries_.emplace(++last_, std::move(entry));
    return static_cast<double>(last_);
  }
  void remove(double handle) {
    const locked lock(shared_lock);
    entries_.erase(static_cast<long long>(handle));
  }
  std::shared_ptr<const radial_entry> find(double handle) {
    const locked lock(shared_lock);
    const auto found =
        handle > 0 && handle < 0x1p53 ? entries_.find(static_cast<long long>(handle)) : entries_.end();
    return found == entries_.end() ? nullptr : found->second;
  }

 private:
  std::unordered_map<long long, std::shared_ptr<const radial_entry>> entries_;
  long long last_ = 0;
};
inline radial_registry registry;

// What a handle that names nothing gives.
template <class T>
struct unknown_density {
  using scalar = T;
  static constexpr std::string_view name = "radial";
  static constexpr std::array<parameter, 1> parameters{{{"handle", 0.0, inf, 0.0}}};
  static constexpr std::array<std::string_view, 1> sources{"heitz2014masking"};
  static constexpr bool shape_invariant = true, float32_arithmetic = true;
  static constexpr unsigned tabulate = of_all;

  explicit unknown_density(const T&) {}
  T zero_or_nan() const { return nan<T>(); }
  T P22(const double_double<T>&) const { return nan<T>(); }
  T D(const T&, const double_double<T>&) const { return nan<T>(); }
  T survival(const double_double<T>&) const { return nan<T>(); }
  T radius2(const T&) const { return nan<T>(); }
  T P2(const slope<T>&) const { return nan<T>(); }
  T slope_sf(const slope<T>&) const { return nan<T>(); }
  T mean_excess(const slope<T>&) const { return nan<T>(); }
};

struct radial_tag {
  template <class T>
  using type = unknown_density<T>;
  template <class Lanes>
  using table_density = tabulated_user_density<Lanes>;
  template <class Real>
  static std::shared_ptr<const user_density_tables<Real>> tables(double handle) {
    const auto entry = registry.find(handle);
    if (entry == nullptr) return nullptr;
    if constexpr (sizeof(Real) == 4) {
      return {entry, &entry->narrow};
    } else {
      return {entry, &entry->wide};
    }
  }
};

struct python_error {};

// What `make` gives Python: nothing, with Python's error set, where something is thrown.
template <class Make>
PyObject* for_python(const Make& make) {
  try {
    return make();
  } catch (const python_error&) {
    return nullptr;
  } catch (const std::bad_alloc&) {
    return PyErr_NoMemory();
  }
}

// The user's function at n slopes exp(L): Python is given the logarithms.
inline auto python_function(PyObject* function) {
  return [function](const double* L, double* f, int n) {
    npy_intp length = n;
    PyObject* at = PyArray_SimpleNew(1, &length, NPY_DOUBLE);
    if (at == nullptr) throw python_error();
    std::memcpy(PyArray_DATA(reinterpret_cast<PyArrayObject*>(at)), L,
                static_cast<std::size_t>(n) * sizeof(double));
    PyObject* result = PyObject_CallFunctionObjArgs(function, at, nullptr);
    Py_DECREF(at);
    if (result == nullptr) throw python_error();
    PyObject* values = PyArray_FROM_OTF(result, NPY_DOUBLE, NPY_ARRAY_IN_ARRAY);
    Py_DECREF(result);
    if (values == nullptr) throw python_error();
    auto* array = reinterpret_cast<PyArrayObject*>(values);
    const bool fits = PyArray_SIZE(array) == length;
    if (fits) std::memcpy(f, PyArray_DATA(array), static_cast<std::size_t>(n) * sizeof(double));
    Py_DECREF(values);
    if (!fits) {
      PyErr_SetString(PyExc_ValueError, "a density must return as many values as it is given slopes");
      throw python_error();
    }
  };
}

// (capsule, handle): the entry lives as long as the capsule.
inline PyObject* registered(std::shared_ptr<radial_entry> entry) {
  entry->narrow.build(tabulated_user_density<double>(entry->wide));
  auto handle = std::make_unique<double>();
  *handle = registry.add(std::move(entry));
  PyObject* capsule = PyCapsule_New(handle.get(), "microfacet.radial", [](PyObject* c) {
    auto* named = static_cast<double*>(PyCapsule_GetPointer(c, "microfacet.radial"));
    registry.remove(*named);
    delete named;
  });
  if (capsule == nullptr) {
    registry.remove(*handle);
    return nullptr;
  }
  return Py_BuildValue("(Nd)", capsule, *handle.release());
}

inline PyObject* build_radial(PyObject*, PyObject* arguments) {
  PyObject *density, *above;
  double lower, upper, at_zero;
  if (!PyArg_ParseTuple(arguments, "OdddO", &density, &lower, &upper, &at_zero, &above)) return nullptr;
  return for_python([&]() -> PyObject* {
    const auto family = std::make_unique<user_density>(python_function(density), lower, upper, at_zero,
                                                       above != Py_None, python_function(above));
    if (!(family->norm() > 0 && family->norm() < inf))
      return Py_BuildValue("(Odd)", Py_None, family->norm(), 0.0);
    auto entry = std::make_shared<radial_entry>();
    entry->wide.build(*family);
    const double error = entry->wide.error().error;
    return Py_BuildValue("(Ndd)", registered(std::move(entry)), family->norm(), error);
  });
}

// Tables are plain values: their bytes, behind a word that says which layout.
inline constexpr std::array<char, 16> radial_magic{"microfacet rad2"};

inline PyObject* dump_radial(PyObject*, PyObject* handle) {
  const double number = PyFloat_AsDouble(handle);
  if (PyErr_Occurred() != nullptr) return nullptr;
  const auto entry = registry.find(number);
  if (entry == nullptr) return PyErr_Format(PyExc_ValueError, "no density has this handle");
  PyObject* bytes = PyBytes_FromStringAndSize(nullptr, radial_magic.size() + sizeof entry->wide);
  if (bytes == nullptr) return nullptr;
  std::memcpy(PyBytes_AS_STRING(bytes), radial_magic.data(), radial_magic.size());
  std::memcpy(PyBytes_AS_STRING(bytes) + radial_magic.size(), &entry->wide, sizeof entry->wide);
  return bytes;
}
inline PyObject* load_radial(PyObject*, PyObject* bytes) {
  return for_python([bytes]() -> PyObject* {
    auto entry = std::make_shared<radial_entry>();
    static_assert(std::is_trivially_copyable_v<user_density_tables<double>>);
    if (!PyBytes_Check(bytes) ||
        PyBytes_GET_SIZE(bytes) != static_cast<Py_ssize_t>(radial_magic.size() + sizeof entry->wide) ||
        std::memcmp(PyBytes_AS_STRING(bytes), radial_magic.data(), radial_magic.size()) != 0)
      return PyErr_Format(PyExc_ValueError, "these bytes are no density of this version");
    std::memcpy(&entry->wide, PyBytes_AS_STRING(bytes) + radial_magic.size(), sizeof entry->wide);
    return registered(std::move(entry));
  });
}

// tables(float64, handle) -> bytes: of a smooth density tables as of a family, which draw visible normals, too; else
// those that are searched.
inline PyObject* tables_of_radial(PyObject*, PyObject* args) {
  int in_float64 = 0;
  double handle = 0;
  if (!PyArg_ParseTuple(args, "pd", &in_float64, &handle)) return nullptr;
  const auto bytes_of = [](const auto& tables) {
    return PyBytes_FromStringAndSize(reinterpret_cast<const char*>(&tables),
                                     static_cast<Py_ssize_t>(sizeof tables));
  };
  const auto entry = registry.find(handle);
  if (entry == nullptr) return Py_NewRef(Py_None);
  const auto made = [&](const auto& searched) {
    using real = typename std::remove_cvref_t<decltype(searched)>::table::real;
    const auto tables = std::make_unique<radial_tables<real>>();
    build_tables(*tables, any_density_of(tabulated_user_density<lanes<double>>(entry->wide)),
                 of_all | of_visible);
    return tables->good(of_all) ? bytes_of(*tables) : bytes_of(searched);
  };
  return for_python([&] { return in_float64 != 0 ? made(entry->wide) : made(entry->narrow); });
}

inline bool add_radial(PyObject* space) {
  static PyMethodDef methods[] = {
      {"build", build_radial, METH_VARARGS,
       "build(density, lower, upper, at_zero, survival) -> ((capsule, handle), norm, error)"},
      {"dump", dump_radial, METH_O, "dump(handle) -> bytes"},
      {"load", load_radial, METH_O, "load(bytes) -> (capsule, handle)"},
      {"tables", tables_of_radial, METH_VARARGS, "tables(float64, handle) -> bytes"},
      {nullptr, nullptr, 0, nullptr}};
  return PyModule_AddFunctions(space, methods) == 0 && add(space, "parameters", PyTuple_New(0)) &&
         add_direction_operations<stretched_model<radial_tag>>(space, "stretched_");
}

}  // namespace microfacet::bindings
