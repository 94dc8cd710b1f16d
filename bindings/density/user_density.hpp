// Densities of the user's own: tables that Python makes and names by a number, their handle, which stands
// where a family has its shape parameters.
#pragma once

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include "bindings/density/named_entries.hpp"
#include "bindings/density/operations.hpp"
#include "microfacet/tabulated/tabulated.hpp"
#include "microfacet/tabulated/user_density.hpp"

namespace microfacet::bindings {

// Tables of one density in both precisions.
template <template <class> class Tables>
struct tables_of_density {
  Tables<double> wide;
  Tables<float> narrow;

  // Of the density in double precision; the other one is made of these tables. Without a mean slope there is nothing
  // that a direction sees.
  template <class Density>
  void build(const Density& density, bool has_mean, unsigned done = 0) {
    wide.build(density, (has_mean ? of_all : of_all & ~of_mean_excess) & ~done, true);
    if (!has_mean) wide.mean_excess = Tables<double>::table::zero_or_nan();
    if (has_mean) wide.build(tabulated<double, Tables<double>>(wide), of_visible, true);
    narrow_down();
  }
  void narrow_down() {
    narrow = Tables<float>();
    narrow.build(tabulated<double, Tables<double>>(wide), of_all | of_visible, true);
  }
};
template <class T>
using prepared_tables = radial_tables<T>;
using prepared_density = tables_of_density<prepared_tables>;
using searched_density = tables_of_density<user_density_tables>;

// One of both: few pieces, as of a family, or many that are searched, where a density is smooth only piecewise.
struct radial_entry {
  static constexpr const char* name = "microfacet.radial";
  std::unique_ptr<prepared_density> prepared;
  std::unique_ptr<searched_density> searched;

  // Tables of few pieces have to be this good in both precisions.
  static bool good(const radial_error& e, bool single) {
    return e.error <= (single ? 4e-6 : 1e-10) && e.far_error <= (single ? 5e-5 : 1e-9);
  }
};

// What a handle that names nothing gives.
template <class T>
struct unknown_density : radial_defaults<T, 0, of_all> {
  static constexpr std::string_view name = "radial";
  static constexpr bool tables_alone = true;
  static constexpr std::array<parameter, 1> parameters{{{"handle", 0.0, inf, 0.0}}};
  static constexpr std::array<std::string_view, 1> sources{"heitz2014masking"};

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

// Densities by their handles, of each kind of tables.
template <auto Kind>
struct radial_tag {
  template <class T>
  using type = unknown_density<T>;
  template <class Real>
  static auto tables(double handle) {
    const auto entry = entries_of<radial_entry>.find(handle);
    const auto of = [&](const auto& both) {
      if constexpr (sizeof(Real) == 4) {
        return std::shared_ptr<const std::remove_cvref_t<decltype(both->narrow)>>(entry, &both->narrow);
      } else {
        return std::shared_ptr<const std::remove_cvref_t<decltype(both->wide)>>(entry, &both->wide);
      }
    };
    using found = decltype(of((*entry).*Kind));
    return entry == nullptr || (*entry).*Kind == nullptr ? found() : of((*entry).*Kind);
  }
};
using prepared_tag = radial_tag<&radial_entry::prepared>;
struct searched_tag : radial_tag<&radial_entry::searched> {
  template <class Lanes>
  using table_density = tabulated_user_density<Lanes>;
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

}  // namespace microfacet::bindings
