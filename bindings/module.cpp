// The table of contents of a module of kernels. Everything in this folder is compiled once for each instruction set,
// as a module of its own (MICROFACET_MODULE), so that no inline function of one build can stand in for another's;
// microfacet._core chooses.
#define MICROFACET_IMPORT_NUMPY
#include <new>
#include <tuple>

#include "bindings/names.hpp"
#include "bindings/parts.hpp"
#include "microfacet/family/all.hpp"

namespace microfacet::bindings {
namespace {

template <class... Tag>
bool add_parts(PyObject* module, const std::tuple<Tag...>&) {
  PyObject* names = PyTuple_New(sizeof...(Tag));
  Py_ssize_t i = 0;
  (PyTuple_SET_ITEM(names, i++, PyUnicode_FromString(Tag::template type<double>::name.data())), ...);
  return add(module, "families", names) && (add_family<Tag>(module) && ...) &&
         add(module, "roughness", Py_BuildValue("(dd)", roughness.lower, roughness.upper)) &&
         add_user_densities(module) && add_slope_tables(module) && add_interfaces(module);
}

PyModuleDef definition{.m_base = PyModuleDef_HEAD_INIT,
                       .m_name = MICROFACET_NAME,
                       .m_doc = "Compiled kernels of microfacet.",
                       .m_size = -1};

}  // namespace
}  // namespace microfacet::bindings

#define MICROFACET_INIT_OF(MODULE) PyInit_##MODULE
#define MICROFACET_INIT(MODULE) MICROFACET_INIT_OF(MODULE)
PyMODINIT_FUNC MICROFACET_INIT(MICROFACET_MODULE)() {
  import_array();
  import_umath();
  PyObject* module = PyModule_Create(&microfacet::bindings::definition);
  if (module == nullptr) return nullptr;
  try {
    if (microfacet::bindings::add_parts(module, microfacet::all_families())) return module;
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  }
  Py_DECREF(module);
  return nullptr;
}
