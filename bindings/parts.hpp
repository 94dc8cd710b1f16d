// What a module consists of. Each part is a translation unit of its own, so that they compile in parallel.
#pragma once

#include "bindings/loop/numpy.hpp"

namespace microfacet::bindings {

// Adds the namespace of a family to the module: family.cpp, compiled once for each family.
template <class Tag>
bool add_family(PyObject* module);

bool add_user_densities(PyObject* module);  // user_densities.cpp
bool add_slope_tables(PyObject* module);    // slope_tables.cpp
bool add_interfaces(PyObject* module);      // interfaces.cpp

}  // namespace microfacet::bindings
