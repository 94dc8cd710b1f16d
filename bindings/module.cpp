// One namespace per family, each with its ufuncs and the facts its header states. This file is compiled once
// for each instruction set, as a module of its own (MICROFACET_MODULE), so that no inline function of one
// build can stand in for another's; microfacet._core chooses.
#define MICROFACET_IMPORT_NUMPY
#include <new>
#include <string>

#include "family_for_materials.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/family/all.hpp"
#include "operations.hpp"
#include "radial.hpp"

#define MICROFACET_TEXT_OF(MODULE) #MODULE
#define MICROFACET_TEXT(MODULE) MICROFACET_TEXT_OF(MODULE)
#define MICROFACET_NAME MICROFACET_TEXT(MICROFACET_MODULE)

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

// How many uniforms a visible normal takes, unless a shape parameter changes that; 0 for a family without.
template <class Family>
PyObject* visible_dims() {
  if constexpr (samples_visible<Family>) return PyLong_FromLong(Family::visible_dimensions);
  return PyLong_FromLong(0);
}

template <class Family>
PyObject* mixture_dims() {
  if constexpr (requires { Family::mixture_dimensions; }) return PyLong_FromLong(Family::mixture_dimensions);
  return visible_dims<Family>();
}

// Materials are drawn by visible normals.
template <class Tag>
bool add_family_materials(PyObject* space) {
  using Family = typename Tag::template type<double>;
  if constexpr (samples_visible<Family>) {
    using model = std::conditional_t<Family::shape_invariant, stretched_model<Tag>, unstretched_model<Tag>>;
    return add_materials_of<model>(space);
  }
  return true;
}

template <class Tag>
bool add_family(PyObject* module) {
  using Family = typename Tag::template type<double>;
  const std::string name(Family::name);
  PyObject* space = PyModule_New(("microfacet._core." MICROFACET_NAME "." + name).c_str());
  if (space == nullptr) return false;
  const bool complete = add_operations<Tag>(space) && add_family_materials<Tag>(space) &&
                        add(space, "parameters", parameters<Family>()) &&
                        add(space, "sources", sources<Family>()) &&
                        add(space, "visible_dims", visible_dims<Family>()) &&
                        add(space, "mixture_dims", mixture_dims<Family>()) &&
                        add(space, "shape_invariant", PyBool_FromLong(Family::shape_invariant));
  if (!complete) {
    Py_DECREF(space);
    return false;
  }
  return add(module, name.c_str(), space);
}

// exp itself through the same loops: what the kernels are measured against.
struct exponential {
  static constexpr const char* name = "exp";
  static constexpr unsigned needs = 0;
  static constexpr layout<1> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    out[0] = elementary::exp(x[0]);
  }
};
struct no_model {
  struct family {
    static constexpr bool native_float32 = true, shape_invariant = false;
    static constexpr unsigned costly = 0;
    static constexpr std::array<parameter, 0> parameters{};
  };
  struct tag {
    template <class Lanes>
    struct type {};
  };
  static constexpr std::size_t count = 0, scales = 0, first = 0;
  template <class Lanes>
  static int shape(const twofold<Lanes>*) {
    return 0;
  }
};

// Smooth interfaces.
struct reflectance_of_dielectric {
  static constexpr const char* name = "fresnel_dielectric";
  static constexpr unsigned needs = 0;
  static constexpr layout<2> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    const T c = cosine<T>(x[0]).z;
    out[0] = where(c == c, fresnel_dielectric(c, x[1]).reflected);
  }
};
struct reflectance_of_conductor {
  static constexpr const char* name = "fresnel_conductor";
  static constexpr unsigned needs = 0;
  static constexpr layout<3> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    const T c = cosine<T>(x[0]).z;
    out[0] = where((c == c) & (x[2] < T(inf)), conductor<T>(x[1], x[2]).reflectance(c));
  }
};

bool add_radial_space(PyObject* module) {
  PyObject* space = PyModule_New("microfacet._core." MICROFACET_NAME ".radial");
  if (space == nullptr) return false;
  if (!add_radial(space)) {
    Py_DECREF(space);
    return false;
  }
  return add(module, "radial", space);
}

template <class... Tag>
PyObject* add_families(PyObject* module, const std::tuple<Tag...>&) {
  PyObject* names = PyTuple_New(static_cast<Py_ssize_t>(sizeof...(Tag)));
  Py_ssize_t i = 0;
  const bool complete = (add_family<Tag>(module) && ...);
  (PyTuple_SET_ITEM(names, i++, text(Tag::template type<double>::name)), ...);
  if (!complete || !add(module, "families", names) ||
      !add(module, "roughness", Py_BuildValue("(dd)", roughness.lower, roughness.upper)) ||
      !add_radial_space(module) ||
      !add_all<no_model, false, exponential, reflectance_of_dielectric, reflectance_of_conductor>(module, ""))
    return nullptr;
  return module;
}

PyModuleDef definition{PyModuleDef_HEAD_INIT,
                       "microfacet._core." MICROFACET_NAME,
                       "Compiled kernels of microfacet.",
                       -1,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr};

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
    if (microfacet::bindings::add_families(module, microfacet::all_families()) != nullptr) return module;
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  }
  Py_DECREF(module);
  return nullptr;
}
