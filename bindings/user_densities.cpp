// Densities of the user's own: microfacet._core.<instruction set>.radial makes their tables, and its kernels read
// those that are searched; those of `prepared` read tables like a family's.
#include "bindings/density/table_bytes.hpp"
#include "bindings/density/user_density.hpp"
#include "bindings/material/family.hpp"
#include "bindings/names.hpp"
#include "bindings/parts.hpp"

namespace microfacet::bindings {
namespace {

// (capsule, handle, whether its tables are prepared): the entry lives as long as the capsule.
PyObject* registered(std::shared_ptr<radial_entry> entry) {
  const bool prepared = entry->prepared != nullptr;
  double handle = 0;
  PyObject* capsule = capsule_of<radial_entry>(std::move(entry), handle);
  return capsule == nullptr ? nullptr : Py_BuildValue("(NdN)", capsule, handle, PyBool_FromLong(prepared));
}

// The largest error of the tables, in double precision.
double build_entry(radial_entry& entry, const user_density& density) {
  const bool has_mean = density.excess_at_0() < inf;
  const unsigned functions = has_mean ? of_all : of_all & ~of_mean_excess;
  auto prepared = std::make_unique<prepared_density>();
  // These cost little, and say whether the others are worth it.
  constexpr unsigned first = of_P22 | of_survival | of_radius;
  prepared->wide.build(density, first, true);
  if (radial_entry::good(prepared->wide.error(first), false)) {
    prepared->build(density, has_mean, first);
    if (radial_entry::good(prepared->wide.error(functions), false) &&
        radial_entry::good(prepared->narrow.error(functions), true)) {
      entry.prepared = std::move(prepared);
      return entry.prepared->wide.error(functions).error;
    }
  }
  entry.searched = std::make_unique<searched_density>();
  entry.searched->build(density, has_mean);
  return entry.searched->wide.error(functions).error;
}

PyObject* build_radial(PyObject*, PyObject* arguments) {
  PyObject *density, *above;
  double lower, upper, at_zero;
  if (!PyArg_ParseTuple(arguments, "OdddO", &density, &lower, &upper, &at_zero, &above)) return nullptr;
  return for_python([&]() -> PyObject* {
    const auto family = std::make_unique<user_density>(python_function(density), lower, upper, at_zero,
                                                       above != Py_None, python_function(above));
    if (!(family->norm() > 0 && family->norm() < inf))
      return Py_BuildValue("(Odd)", Py_None, family->norm(), 0.0);
    auto entry = std::make_shared<radial_entry>();
    const double error = build_entry(*entry, *family);
    return Py_BuildValue("(Ndd)", registered(std::move(entry)), family->norm(), error);
  });
}

// Tables are plain values: their bytes, behind a word that says which layout. Both kinds differ in size.
constexpr std::array<char, 16> radial_magic{"microfacet rad3"};

PyObject* dump_radial(PyObject*, PyObject* handle) {
  const double number = PyFloat_AsDouble(handle);
  if (PyErr_Occurred() != nullptr) return nullptr;
  const auto entry = entries_of<radial_entry>.find(number);
  if (entry == nullptr) return PyErr_Format(PyExc_ValueError, "no density has this handle");
  const auto bytes_of = [](const auto& tables) {
    PyObject* bytes =
        PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(radial_magic.size() + sizeof tables));
    if (bytes == nullptr) return bytes;
    std::memcpy(PyBytes_AS_STRING(bytes), radial_magic.data(), radial_magic.size());
    std::memcpy(PyBytes_AS_STRING(bytes) + radial_magic.size(), &tables, sizeof tables);
    return bytes;
  };
  return entry->prepared != nullptr ? bytes_of(entry->prepared->wide) : bytes_of(entry->searched->wide);
}
template <class Density>
bool loaded(std::unique_ptr<Density>& made, PyObject* bytes) {
  static_assert(std::is_trivially_copyable_v<Density>);
  if (PyBytes_GET_SIZE(bytes) != static_cast<Py_ssize_t>(radial_magic.size() + sizeof made->wide))
    return false;
  made = std::make_unique<Density>();
  std::memcpy(&made->wide, PyBytes_AS_STRING(bytes) + radial_magic.size(), sizeof made->wide);
  made->narrow_down();
  return true;
}
PyObject* load_radial(PyObject*, PyObject* bytes) {
  return for_python([bytes]() -> PyObject* {
    auto entry = std::make_shared<radial_entry>();
    const bool ours = PyBytes_Check(bytes) && PyBytes_GET_SIZE(bytes) >= Py_ssize_t{radial_magic.size()} &&
                      std::memcmp(PyBytes_AS_STRING(bytes), radial_magic.data(), radial_magic.size()) == 0;
    if (!ours || !(loaded(entry->prepared, bytes) || loaded(entry->searched, bytes)))
      return PyErr_Format(PyExc_ValueError, "these bytes are no density of this version");
    return registered(std::move(entry));
  });
}

template <class Tag>
bool add_density(PyObject* module, const char* full_name, const char* name, PyMethodDef* methods = nullptr) {
  using model = stretched_model<Tag>;
  using family = typename model::family;
  PyObject* space = PyModule_New(full_name);
  if (space == nullptr) return false;
  const bool complete = (methods == nullptr || PyModule_AddFunctions(space, methods) == 0) &&
                        add(space, "parameters", PyTuple_New(0)) &&
                        add_all<isotropic_model<Tag>, false>(space, "", isotropic_operations()) &&
                        add_direction_operations<model>(space, "stretched_") &&
                        add_materials_of<model>(space) && add_table_bytes<Tag>(space) &&
                        add(space, "visible_dims", PyLong_FromLong(family::visible_dimensions)) &&
                        add(space, "mixture_dims", PyLong_FromLong(family::mixture_dimensions));
  if (!complete) {
    Py_DECREF(space);
    return false;
  }
  return add(module, name, space);
}

PyMethodDef radial_methods[] = {{"build", build_radial, METH_VARARGS,
                                 "build(density, lower, upper, at_zero, survival) -> "
                                 "((capsule, handle, prepared), norm, error)"},
                                {"dump", dump_radial, METH_O, "dump(handle) -> bytes"},
                                {"load", load_radial, METH_O, "load(bytes) -> (capsule, handle, prepared)"},
                                {nullptr, nullptr, 0, nullptr}};

}  // namespace

bool add_user_densities(PyObject* module) {
  return add_density<searched_tag>(module, MICROFACET_NAME ".radial", "radial", radial_methods) &&
         add_density<prepared_tag>(module, MICROFACET_NAME ".prepared", "prepared");
}

}  // namespace microfacet::bindings
