// microfacet._graphs: quantities as graphs, for other languages and array libraries. Compiled once, whatever the
// instruction sets of the kernels are.
#define MICROFACET_IMPORT_NUMPY
#include <new>
#include <stdexcept>
#include <string>

#include "bindings/graph/python.hpp"
#include "bindings/graph/recording.hpp"
#include "bindings/loop/numpy.hpp"

namespace microfacet::bindings {
namespace {

// Parameters from a dictionary of numbers and None, and names from a sequence.
bool read_parameters(PyObject* dict, record::request& to) {
  PyObject *key = nullptr, *value = nullptr;
  for (Py_ssize_t i = 0; PyDict_Next(dict, &i, &key, &value);) {
    const char* name = PyUnicode_AsUTF8(key);
    if (name == nullptr) return false;
    auto& parameter = to.parameters[name];
    if (value == Py_None) continue;
    parameter = PyFloat_AsDouble(value);
    if (PyErr_Occurred() != nullptr) return false;
  }
  return true;
}
bool read_names(PyObject* sequence, std::vector<std::string>& to) {
  if (sequence == nullptr) return true;
  PyObject* fast = PySequence_Fast(sequence, "derivatives must be a sequence of names");
  if (fast == nullptr) return false;
  const object owner(fast);
  for (Py_ssize_t i = 0; i < PySequence_Fast_GET_SIZE(fast); ++i) {
    const char* name = PyUnicode_AsUTF8(PySequence_Fast_GET_ITEM(fast, i));
    if (name == nullptr) return false;
    to.emplace_back(name);
  }
  return true;
}

PyObject* record_python(PyObject*, PyObject* args, PyObject* keywords) {
  static const char* const names[] = {"family",          "quantity", "parameters", "float64",
                                      "derivatives",     "native",   "cosine",     "mixture",
                                      "retroreflective", "channels", "tables",     nullptr};
  const char *family = nullptr, *quantity = nullptr, *tables = nullptr;
  PyObject *parameters = nullptr, *derivatives = nullptr;
  int float64 = 0, native = 1, cosine = 0, mixture = 0, retroreflective = 0, channels = 1;
  Py_ssize_t size = 0;
  if (!PyArg_ParseTupleAndKeywords(args, keywords, "ssO!|$pOppppiz#:record", const_cast<char**>(names),
                                   &family, &quantity, &PyDict_Type, &parameters, &float64, &derivatives,
                                   &native, &cosine, &mixture, &retroreflective, &channels, &tables, &size))
    return nullptr;
  try {
    record::request asked{.quantity = quantity,
                          .parameters = {},
                          .derivatives = {},
                          .of_cosine = cosine != 0,
                          .mixture = mixture != 0,
                          .retroreflective = retroreflective != 0,
                          .channels = channels == 3 ? 3 : 1};
    if (!read_parameters(parameters, asked) || !read_names(derivatives, asked.derivatives)) return nullptr;
    const density_source source{family, tables == nullptr
                                            ? std::string_view()
                                            : std::string_view(tables, static_cast<std::size_t>(size))};
    return python_of(float64 != 0 ? record_graph<double>(source, asked, native != 0)
                                  : record_graph<float>(source, asked, native != 0));
  } catch (const std::invalid_argument& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const std::bad_alloc&) {
    if (PyErr_Occurred() == nullptr) PyErr_NoMemory();
  }
  return nullptr;
}

// What holds of the families, by their names.
template <class Property, class... Tag>
PyObject* families_with(const std::tuple<Tag...>*, const Property& property) {
  object names(PyDict_New());
  const auto add = [&]<class Family>(const Family* family) {
    PyDict_SetItemString(names.get(), std::string(Family::name).c_str(),
                         property(family) ? Py_True : Py_False);
  };
  (add(static_cast<const typename Tag::template type<float>*>(nullptr)), ...);
  return names.release();
}
bool add_properties(PyObject* module) {
  constexpr const microfacet::all_families* all = nullptr;
  const object exact(
      families_with(all, []<class F>(const F*) { return F::float32_graphs && !F::tables_alone; })),
      shorter(families_with(all, []<class F>(const F*) { return !F::float32_arithmetic; }));
  return PyModule_AddObjectRef(module, "exact_in_float32", exact.get()) == 0 &&
         PyModule_AddObjectRef(module, "shorter_from_tables", shorter.get()) == 0;
}

PyMethodDef methods[] = {
    {"record", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(record_python)),
     METH_VARARGS | METH_KEYWORDS,
     "record(family, quantity, parameters, *, float64=False, derivatives=(), native=True, cosine=False, "
     "mixture=False, "
     "retroreflective=False, channels=1, tables=None)\n--\n\nRecord a quantity of a family as a graph."},
    {nullptr, nullptr, 0, nullptr}};
PyModuleDef definition{.m_base = PyModuleDef_HEAD_INIT,
                       .m_name = "microfacet._graphs",
                       .m_doc = "Quantities as graphs.",
                       .m_size = -1,
                       .m_methods = methods};

}  // namespace
}  // namespace microfacet::bindings

PyMODINIT_FUNC PyInit__graphs() {
  using namespace microfacet::bindings;
  import_array();
  PyObject* module = PyModule_Create(&definition);
  if (module == nullptr) return nullptr;
  try {
    if (add_properties(module)) return module;
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  }
  Py_DECREF(module);
  return nullptr;
}
