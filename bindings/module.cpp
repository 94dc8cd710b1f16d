// microfacet._core: one namespace per family, each with its ufuncs and the facts its header states.
#define MICROFACET_IMPORT_NUMPY
#include "microfacet/family/all.hpp"
#include "operations.hpp"

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

template <class Family>
bool add_family(PyObject* module) {
  const std::string name(Family::name);
  PyObject* space = PyModule_New(("microfacet._core." + name).c_str());
  if (space == nullptr) return false;
  const bool complete = add_operations<Family>(space) && add(space, "parameters", parameters<Family>()) &&
                        add(space, "sources", sources<Family>()) &&
                        add(space, "shape_invariant", PyBool_FromLong(Family::shape_invariant));
  if (!complete) {
    Py_DECREF(space);
    return false;
  }
  return add(module, name.c_str(), space);
}

template <class... Tag>
PyObject* add_families(PyObject* module, const std::tuple<Tag...>&) {
  PyObject* names = PyTuple_New(static_cast<Py_ssize_t>(sizeof...(Tag)));
  Py_ssize_t i = 0;
  const bool complete = (add_family<typename Tag::template type<double>>(module) && ...);
  (PyTuple_SET_ITEM(names, i++, text(Tag::template type<double>::name)), ...);
  if (!complete || !add(module, "families", names)) return nullptr;
  return module;
}

PyModuleDef definition{PyModuleDef_HEAD_INIT,
                       "microfacet._core",
                       "Compiled kernels of microfacet.",
                       -1,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr};

}  // namespace
}  // namespace microfacet::bindings

PyMODINIT_FUNC PyInit__core() {
  import_array();
  import_umath();
  PyObject* module = PyModule_Create(&microfacet::bindings::definition);
  if (module == nullptr) return nullptr;
  if (microfacet::bindings::add_families(module, microfacet::all_families()) == nullptr) {
    Py_DECREF(module);
    return nullptr;
  }
  return module;
}
