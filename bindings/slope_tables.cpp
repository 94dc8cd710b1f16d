// Densities on grids of slopes: microfacet._core.<instruction set>.slopes. Their tables are made of doubles, in which the
// loops for float32 compute too.
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

#include "bindings/density/named_entries.hpp"
#include "bindings/density/operations.hpp"
#include "bindings/loop/blocks.hpp"
#include "bindings/loop/numpy.hpp"
#include "bindings/material/distribution.hpp"
#include "bindings/names.hpp"
#include "bindings/parts.hpp"
#include "microfacet/smith/slope_table.hpp"

namespace microfacet::bindings {
namespace {

struct slope_entry {
  static constexpr const char* name = "microfacet.slopes";
  slope_table table;
  mean_plane::frame frame;
  double error;

  slope_entry(const slope_axis& p, const slope_axis& q, const double* masses)
      : table(p, q, masses), frame(table.grid().mean()[0], table.grid().mean()[1]), error(table.error()) {}
  bool tilted() const { return table.grid().mean() != std::array{0.0, 0.0}; }
};

struct all_normals : operation<"sample", 2, of_radius, 3> {
  static constexpr std::size_t uniforms = 2;
  static vec3<double> apply(const slope_table& table, const double* x) { return table.sample(x[0], x[1]); }
};
struct seen_normals : visible_operation<"sample_visible", 2> {
  static vec3<double> apply(const slope_table& table, const double* x) {
    return table.sample_visible(direction(x), x[3], x[4]);
  }
};

template <class Operation, class Distribution>
void each_element(const void* distribution, const double* const* in, double* const* out, std::ptrdiff_t n) {
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    std::array<double, Operation::inputs> x;
    for (std::size_t a = 0; a < x.size(); ++a) x[a] = in[a][i];
    store_at(Operation::apply(*static_cast<const Distribution*>(distribution), x.data()), out, i);
  }
}

// Ufuncs of values and a handle.
template <class Operation>
inline constexpr block_plan plan_of{Operation::inputs, Operation::inputs + 1, Operation::outputs, true,
                                    Operation::uniforms};

template <class Operation, class T>
void slope_loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void*) {
  const quiet_floating_point guard;
  constexpr block_plan plan = plan_of<Operation>;
  const npy_intp n = dimensions[0], each = steps[plan.values] == 0 ? n : 1;
  for (npy_intp start = 0; start < n; start += each) {
    const auto entry = entries_of<slope_entry>.find(
        *reinterpret_cast<const double*>(args[plan.values] + start * steps[plan.values]));
    if (entry != nullptr) {
      in_blocks<double, T>(plan, args, steps, start, each, true, &each_element<Operation, slope_table>,
                           &entry->table);
      continue;
    }
    for (std::size_t a = plan.inputs; a < plan.inputs + plan.outputs; ++a)
      for (npy_intp i = start; i < start + each; ++i)
        *reinterpret_cast<T*>(args[a] + i * steps[a]) = nan<T>();
  }
}

template <class... Operation>
bool add_quantities(PyObject* space, operation_list<Operation...>) {
  return (add_ufunc(space, Operation::name, Operation::name, plan_of<Operation>, nullptr,
                    {&guarded<&slope_loop<Operation, float>>, &guarded<&slope_loop<Operation, double>>}) &&
          ...);
}

// Materials, in coordinates in which the mean plane is horizontal, and of areas of that plane.
struct about_mean_plane {
  const slope_entry& entry;

  double D(const vec3<double>& m) const {
    return entry.table.D(entry.frame.to_world(m)) / entry.frame.area();
  }
  double sigma(const vec3<double>& w) const {
    return entry.table.sigma(entry.frame.to_world(w)) / entry.frame.area();
  }
  vec3<double> sample_visible(const vec3<double>& w, double xi0, double xi1) const {
    return entry.frame.from_world(entry.table.sample_visible(entry.frame.to_world(w), xi0, xi1));
  }
};
struct seen_about_mean_plane : visible_operation<"sample_visible", 2> {
  static vec3<double> apply(const about_mean_plane& ndf, const double* x) {
    return ndf.sample_visible(direction(x), x[3], x[4]);
  }
};

bool in_float32(const double*, void (*)(const array_distribution<float>&, void*), void*) { return false; }
bool in_float64(const double* parameters, void (*then)(const array_distribution<double>&, void*),
                void* data) {
  const auto entry = entries_of<slope_entry>.find(parameters[0]);
  if (entry == nullptr) return false;
  array_distribution<double> d;
  const about_mean_plane about{*entry};
  const auto give = [&](quantity q, block_kernel<double> kernel, const void* distribution) {
    d.functions[static_cast<std::size_t>(q)] = {kernel, distribution};
  };
  if (entry->tilted()) {
    d.frame = &entry->frame;
    give(quantity::D, &each_element<D_of_normal, about_mean_plane>, &about);
    give(quantity::sigma, &each_element<sigma_of_direction, about_mean_plane>, &about);
    give(quantity::visible, &each_element<seen_about_mean_plane, about_mean_plane>, &about);
  } else {
    give(quantity::D, &each_element<D_of_normal, slope_table>, &entry->table);
    give(quantity::sigma, &each_element<sigma_of_direction, slope_table>, &entry->table);
    give(quantity::visible, &each_element<seen_normals, slope_table>, &entry->table);
  }
  d.fused = &fused_kernels_on_arrays();
  then(d, data);
  return true;
}

// build(p first, p step, q first, q step, masses) -> (capsule, handle, mean p, mean q, error): masses is an array of
// float64 of two axes, q then p, that Python has checked.
PyObject* build(PyObject*, PyObject* arguments) {
  slope_axis p, q;
  PyObject* given = nullptr;
  if (!PyArg_ParseTuple(arguments, "ddddO", &p.first, &p.step, &q.first, &q.step, &given)) return nullptr;
  PyObject* const array = PyArray_FROM_OTF(given, NPY_DOUBLE, NPY_ARRAY_IN_ARRAY);
  if (array == nullptr) return nullptr;
  auto* const masses = reinterpret_cast<PyArrayObject*>(array);
  PyObject* result = nullptr;
  if (PyArray_NDIM(masses) != 2 ||
      std::max(PyArray_DIM(masses, 0), PyArray_DIM(masses, 1)) > most_slope_cells ||
      std::min(PyArray_DIM(masses, 0), PyArray_DIM(masses, 1)) < 1) {
    PyErr_SetString(PyExc_ValueError, "masses must have two axes of 1 to 512 cells");
  } else {
    q.count = static_cast<int>(PyArray_DIM(masses, 0)), p.count = static_cast<int>(PyArray_DIM(masses, 1));
    try {
      const auto entry =
          std::make_shared<const slope_entry>(p, q, static_cast<const double*>(PyArray_DATA(masses)));
      const auto [mean_p, mean_q] = entry->table.grid().mean();
      double handle = 0;
      if (PyObject* capsule = capsule_of<slope_entry>(entry, handle))
        result = Py_BuildValue("(Ndddd)", capsule, handle, mean_p, mean_q, entry->error);
    } catch (const std::bad_alloc&) {
      PyErr_NoMemory();
    }
  }
  Py_DECREF(array);
  return result;
}

}  // namespace

bool add_slope_tables(PyObject* module) {
  PyObject* space = PyModule_New(MICROFACET_NAME ".slopes");
  if (space == nullptr) return false;
  static PyMethodDef methods[] = {{"build", build, METH_VARARGS,
                                   "build(p, dp, q, dq, masses) -> (capsule, handle, mean p, mean q, error)"},
                                  {nullptr, nullptr, 0, nullptr}};
  using quantities =
      operation_list<D_of_normal, pdf_of_normal, sigma_of_direction, Lambda_of_direction, G1_of_direction,
                     G2_of_directions, G2_uncorrelated_of_directions, D_visible_of_directions, P22_of_slopes,
                     P2_of_slope, cdf_of_slope, all_normals, seen_normals>;
  const bool complete = PyModule_AddFunctions(space, methods) == 0 && add_quantities(space, quantities()) &&
                        add_materials(space, {1, &in_float32, &in_float64}) &&
                        add(space, "visible_dims", PyLong_FromLong(2)) &&
                        add(space, "mixture_dims", PyLong_FromLong(2)) &&
                        add(space, "most_cells", PyLong_FromLong(most_slope_cells));
  if (!complete) {
    Py_DECREF(space);
    return false;
  }
  return add(module, "slopes", space);
}

}  // namespace microfacet::bindings
