// Materials as ufuncs: values (directions, optical constants, uniform numbers) in the precision of the loop;
// then numbers that are double and the same for all elements but for the first of a walk, the number of the
// element; then the parameters of the distribution.
#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <memory>

#include "bindings/loop/blocks.hpp"
#include "bindings/loop/lanes.hpp"
#include "bindings/loop/numpy.hpp"
#include "bindings/material/distribution.hpp"
#include "bindings/material/single.hpp"
#include "bindings/material/walking.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/diffuse.hpp"

namespace microfacet::bindings {
namespace {

struct material_operation {
  const char* name;
  std::size_t values, elements, constants, outputs;
  std::size_t directions, uniforms;  // the values begin with these
  material_kernel<float> single;
  material_kernel<double> wide;
  template <class Real>
  material_kernel<Real> kernel() const {
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return wide;
    }
  }
  std::size_t numbers() const { return values + elements + constants; }
};

// Directions of unit length.
template <template <class> class, class Real>
void unit_direction(const array_distribution<Real>&, material_block<Real>& b) {
  std::copy_n(b.in.begin(), 3, b.out.begin());
}

#define MICROFACET_MATERIAL(NAME, VALUES, ELEMENTS, CONSTANTS, OUTPUTS, DIRECTIONS, UNIFORMS, KERNEL, \
                            MATERIAL)                                                                 \
  {NAME,                                                                                              \
   VALUES,                                                                                            \
   ELEMENTS,                                                                                          \
   CONSTANTS,                                                                                         \
   OUTPUTS,                                                                                           \
   DIRECTIONS,                                                                                        \
   UNIFORMS,                                                                                          \
   &KERNEL<MATERIAL, float>,                                                                          \
   &KERNEL<MATERIAL, double>}
constexpr material_operation operations[] = {
    MICROFACET_MATERIAL("unit_direction", 3, 0, 0, 3, 1, 0, unit_direction, diffuse),
    MICROFACET_MATERIAL("conductor_eval", 8, 0, 2, 1, 2, 0, single_eval, conductor),
    MICROFACET_MATERIAL("conductor_pdf", 8, 0, 1, 1, 2, 0, single_pdf, conductor),
    MICROFACET_MATERIAL("conductor_sample", 9, 0, 3, 5, 1, 4, single_sample, conductor),
    MICROFACET_MATERIAL("conductor_facets", 8, 0, 1, 2, 2, 0, single_facets, conductor),
    MICROFACET_MATERIAL("conductor_walk", 5, 1, 2, 5, 1, 0, walk_sample, conductor),
    MICROFACET_MATERIAL("conductor_walk_eval", 8, 1, 5, 1, 2, 0, walk_eval, conductor),
    MICROFACET_MATERIAL("dielectric_eval", 7, 0, 2, 1, 2, 0, single_eval, dielectric),
    MICROFACET_MATERIAL("dielectric_pdf", 7, 0, 1, 1, 2, 0, single_pdf, dielectric),
    MICROFACET_MATERIAL("dielectric_sample", 8, 0, 3, 5, 1, 4, single_sample, dielectric),
    MICROFACET_MATERIAL("dielectric_facets", 7, 0, 1, 2, 2, 0, single_facets, dielectric),
    MICROFACET_MATERIAL("dielectric_walk", 4, 1, 2, 5, 1, 0, walk_sample, dielectric),
    MICROFACET_MATERIAL("dielectric_walk_eval", 7, 1, 5, 1, 2, 0, walk_eval, dielectric),
    MICROFACET_MATERIAL("diffuse_walk", 4, 1, 2, 5, 1, 0, walk_sample, diffuse),
    MICROFACET_MATERIAL("diffuse_walk_eval", 7, 1, 5, 1, 2, 0, walk_eval, diffuse),
};
#undef MICROFACET_MATERIAL

struct material_ufunc {
  const material_operation* operation;
  material_family family;
  std::size_t inputs() const { return operation->numbers() + family.parameters; }
};

struct material_call {
  const material_ufunc& ufunc;
  char* const* args;
  const npy_intp* steps;
  npy_intp n;
};

// Directions of any length; of length 1 to a few roundings of T.
template <class T, class Compute>
void normalize(material_block<Compute>& b, std::size_t first) {
  using pack = lanes<Compute>;
  const pack tolerance(static_cast<Compute>(
      8 * std::max<double>(std::numeric_limits<T>::epsilon(), std::numeric_limits<Compute>::epsilon())));
  for (int i = 0; i < b.padded; i += width<pack>) {
    const vec3<pack> w = normalized(b.template direction<pack>(first, i), tolerance);
    put(w.x, b.in[first], i), put(w.y, b.in[first + 1], i), put(w.z, b.in[first + 2], i);
  }
}

template <class Compute, class T>
void run_blocks(const array_distribution<Compute>& d, void* data) {
  const auto& call = *static_cast<const material_call*>(data);
  const material_operation& op = *call.ufunc.operation;
  const auto b = std::make_unique<material_block<Compute>>();
  b->narrow_results = sizeof(T) < sizeof(Compute);
  for (std::size_t k = 0; k < op.constants; ++k)
    b->constant[k] = *reinterpret_cast<const double*>(call.args[op.values + op.elements + k]);
  for (npy_intp first = 0; first < call.n; first += walk_block) {
    const std::ptrdiff_t count = std::min<npy_intp>(walk_block, call.n - first);
    constexpr std::ptrdiff_t full = filled_up<Compute>;
    b->count = static_cast<int>(count), b->padded = static_cast<int>((count + full - 1) / full * full);
    const auto at = [&](std::size_t a) { return call.args[a] + first * call.steps[a]; };
    for (std::size_t a = 0; a < op.values; ++a) {
      const bool uniform = a >= 3 * op.directions && a < 3 * op.directions + op.uniforms;
      (uniform ? gather_uniform<T, Compute> : gather<T, Compute>)(at(a), call.steps[a], count, b->in[a]);
    }
    for (std::size_t k = 0; k < op.directions; ++k) normalize<T>(*b, 3 * k);
    if (op.elements != 0) gather<double>(at(op.values), call.steps[op.values], count, b->element);
    op.template kernel<Compute>()(d, *b);
    for (std::size_t k = 0, a = call.ufunc.inputs(); k < op.outputs; ++k, ++a)
      scatter<Compute, T>(b->out[k], at(a), call.steps[a], count);
  }
}

// How many distributions were made for calls: a loop that runs over the channels of a material instead of the
// elements makes one for each element.
std::atomic<long long> prepared_distributions{0};

PyObject* count_prepared(PyObject*, PyObject*) { return PyLong_FromLongLong(prepared_distributions.load()); }
PyMethodDef prepared_counter{"distributions_prepared", &count_prepared, METH_NOARGS,
                             "How many distributions the materials' kernels have tabulated."};

template <class T>
void run_constant(const material_call& call) {
  prepared_distributions.fetch_add(1, std::memory_order_relaxed);
  const material_operation& op = *call.ufunc.operation;
  std::array<double, 8> parameters{};
  for (std::size_t k = 0; k < call.ufunc.family.parameters; ++k)
    parameters[k] = *reinterpret_cast<const double*>(call.args[op.numbers() + k]);
  void* const data = const_cast<material_call*>(&call);
  const auto with = [&]<class Compute>(Compute) {
    return call.ufunc.family.with<Compute>()(parameters.data(), &run_blocks<Compute, T>, data);
  };
  if (std::is_same_v<T, float> && with(0.0F)) return;
  if (with(0.0) || with(0.0F)) return;
  for (std::size_t a = call.ufunc.inputs(); a < call.ufunc.inputs() + op.outputs; ++a)
    for (npy_intp i = 0; i < call.n; ++i) *reinterpret_cast<T*>(call.args[a] + i * call.steps[a]) = nan<T>();
}

template <class T>
void material_loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void* data) {
  const auto& ufunc = *static_cast<const material_ufunc*>(data);
  const npy_intp n = dimensions[0];
  if (n == 0) return;
  const quiet_floating_point guard;
  const std::size_t varying = ufunc.operation->values + ufunc.operation->elements;
  if (std::all_of(steps + varying, steps + ufunc.inputs(), [](npy_intp s) { return s == 0; }))
    return run_constant<T>({ufunc, args, steps, n});
  std::array<char*, 32> at;
  for (npy_intp i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < ufunc.inputs() + ufunc.operation->outputs; ++a)
      at[a] = args[a] + i * steps[a];
    run_constant<T>({ufunc, at.data(), steps, 1});
  }
}

}  // namespace

bool add_materials(PyObject* space, const material_family& family) {
  for (const material_operation& op : operations) {
    auto* ufunc = new material_ufunc{&op, family};
    const block_plan plan{op.values, ufunc->inputs(), op.outputs, true};
    if (!add_ufunc(space, op.name, op.name, plan, ufunc,
                   {&guarded<&material_loop<float>>, &guarded<&material_loop<double>>}))
      return false;
  }
  return add(space, prepared_counter.ml_name, PyCFunction_New(&prepared_counter, nullptr));
}

}  // namespace microfacet::bindings
