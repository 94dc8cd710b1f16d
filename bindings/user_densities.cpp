// Densities of the user's own: microfacet._core.<instruction set>.radial.
#include "bindings/density/user_density.hpp"
#include "bindings/names.hpp"
#include "bindings/parts.hpp"

namespace microfacet::bindings {

bool add_user_densities(PyObject* module) {
  PyObject* space = PyModule_New(MICROFACET_NAME ".radial");
  if (space == nullptr) return false;
  if (!add_radial(space)) {
    Py_DECREF(space);
    return false;
  }
  return add(module, "radial", space);
}

}  // namespace microfacet::bindings
