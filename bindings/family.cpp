// One family: its ufuncs, its materials and the facts that its header states. This file is compiled once for each
// family (MICROFACET_FAMILY) and instruction set.
#include <new>
#include <string>

#include "bindings/density/operations.hpp"
#include "bindings/density/table_bytes.hpp"
#include "bindings/material/family.hpp"
#include "bindings/names.hpp"
#include "bindings/parts.hpp"
#include MICROFACET_FAMILY_HEADER

namespace microfacet::bindings {
namespace {

PyObject* text(std::string_view s) {
  return PyUnicode_FromStringAndSize(s.data(), static_cast<Py_ssize_t>(s.size()));
}

template <class Family>
PyObject* parameters() {
  PyObject* list = PyTuple_New(static_cast<Py_ssize_t>(Family::parameters.size()));
  Py_ssize_t i = 0;
  for (const parameter& p : Family::parameters) {
    PyTuple_SET_ITEM(list, i++,
                     Py_BuildValue("(s#ddd)", p.name.data(), static_cast<Py_ssize_t>(p.name.size()), p.lower,
                                   p.upper, p.density_lower));
  }
  return list;
}

template <class Family>
PyObject* sources() {
  PyObject* list = PyTuple_New(static_cast<Py_ssize_t>(Family::sources.size()));
  Py_ssize_t i = 0;
  for (const std::string_view key : Family::sources) PyTuple_SET_ITEM(list, i++, text(key));
  return list;
}

}  // namespace

template <class Tag>
bool add_family(PyObject* module) {
  using Family = typename Tag::template type<double>;
  using directions =
      std::conditional_t<Family::shape_invariant, stretched_model<Tag>, unstretched_model<Tag>>;
  const std::string name(Family::name);
  PyObject* space = PyModule_New((MICROFACET_NAME "." + name).c_str());
  if (space == nullptr) return false;
  const bool complete = add_operations<Tag>(space) && add_materials_of<directions>(space) &&
                        add_table_bytes<Tag>(space) && add(space, "parameters", parameters<Family>()) &&
                        add(space, "sources", sources<Family>()) &&
                        add(space, "visible_dims", PyLong_FromLong(Family::visible_dimensions)) &&
                        add(space, "mixture_dims", PyLong_FromLong(Family::mixture_dimensions)) &&
                        add(space, "shape_invariant", PyBool_FromLong(Family::shape_invariant)) &&
                        add(space, "singular", PyBool_FromLong(Family::singular));
  if (!complete) {
    Py_DECREF(space);
    return false;
  }
  return add(module, name.c_str(), space);
}

template bool add_family<family_tag<MICROFACET_FAMILY>>(PyObject*);

}  // namespace microfacet::bindings
