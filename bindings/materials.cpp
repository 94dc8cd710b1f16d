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

// The functions on arrays, one step of lanes at a time.
class called_distribution {
  using L = lanes<double>;
  struct vectors {
    std::array<double, filled_up<double>> x{}, y{}, z{};
  };

 public:
  explicit called_distribution(const array_distribution<double>& d) : d_(&d) {}
  L D(const vec3<L>& m) const { return ask(quantity::D, m); }
  L sigma(const vec3<L>& w) const { return ask(quantity::sigma, w); }

 private:
  L ask(quantity q, const vec3<L>& w) const {
    vectors v;
    std::array<double, filled_up<double>> result;
    store(w.x, v.x.data()), store(w.y, v.y.data()), store(w.z, v.z.data());
    d_->call(q, width<L>, v, result.data());
    return load<L>(result.data());
  }

  const array_distribution<double>* d_;
};
struct from_arrays {
  using distribution = called_distribution;
  static distribution of(const array_distribution<double>& d) { return distribution(d); }
};

// A kernel of single scattering, of a material by its fused kernels; or one of walks.
struct material_operation {
  const char* name;
  std::size_t values, elements, constants, outputs;
  std::size_t directions, uniforms;  // the values begin with these
  bool transmits = false;
  event of = event::count;
  material_kernel<float> single = nullptr;
  material_kernel<double> wide = nullptr;

  template <class Real>
  material_kernel<Real> kernel(const array_distribution<Real>& d) const {
    if (of != event::count)
      return (transmits ? d.fused->dielectric : d.fused->conductor)[static_cast<std::size_t>(of)];
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return wide;
    }
  }
  std::size_t numbers() const { return values + elements + constants; }
  bool needs_distribution() const { return of != event::count || elements != 0; }
};

// Directions of unit length.
template <class Real>
void unit_direction(const array_distribution<Real>&, material_blocks<Real>& b) {
  using pack = lanes<Real>;
  while (b.next())
    for (int i = 0; i < b.padded; i += width<pack>) {
      const vec3<pack> w = b.template direction<pack>(0, i);
      store(w.x, b.out[0] + i), store(w.y, b.out[1] + i), store(w.z, b.out[2] + i);
    }
}

constexpr material_operation operations[] = {
    {"unit_direction", 3, 0, 0, 3, 1, 0, false, event::count, &unit_direction<float>,
     &unit_direction<double>},
    {"conductor_eval", 8, 0, 2, 1, 2, 0, false, event::eval},
    {"conductor_pdf", 8, 0, 1, 1, 2, 0, false, event::pdf},
    {"conductor_sample", 9, 0, 3, 5, 1, 4, false, event::sample},
    {"conductor_facets", 8, 0, 1, 2, 2, 0, false, event::facets},
    {"dielectric_eval", 7, 0, 2, 1, 2, 0, true, event::eval},
    {"dielectric_pdf", 7, 0, 1, 1, 2, 0, true, event::pdf},
    {"dielectric_sample", 8, 0, 3, 5, 1, 4, true, event::sample},
    {"dielectric_facets", 7, 0, 1, 2, 2, 0, true, event::facets},
#define MICROFACET_WALKS(MATERIAL, VALUES)                                                           \
  {#MATERIAL "_walk",                                                                                \
   VALUES - 3,                                                                                       \
   1,                                                                                                \
   2,                                                                                                \
   5,                                                                                                \
   1,                                                                                                \
   0,                                                                                                \
   false,                                                                                            \
   event::count,                                                                                     \
   &walk_sample<MATERIAL, float>,                                                                    \
   &walk_sample<MATERIAL, double>},                                                                  \
  {                                                                                                  \
    #MATERIAL "_walk_eval", VALUES, 1, 5, 1, 2, 0, false, event::count, &walk_eval<MATERIAL, float>, \
        &walk_eval<MATERIAL, double>                                                                 \
  }
    MICROFACET_WALKS(conductor, 8),
    MICROFACET_WALKS(dielectric, 7),
    MICROFACET_WALKS(diffuse, 7),
#undef MICROFACET_WALKS
};

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

// The blocks of a call. Contiguous arrays of the kernel's type are used in place, others pass through
// buffers.
template <class Compute, class T>
class blocks_of_call : public material_blocks<Compute> {
 public:
  blocks_of_call(const material_call& call, const mean_plane::frame* frame)
      : call_(call), op_(*call.ufunc.operation), frame_(frame) {
    this->turn = [](material_blocks<Compute>& b) { return static_cast<blocks_of_call&>(b).advance(); };
    this->narrow_results = sizeof(T) < sizeof(Compute);
    this->one_material = std::all_of(call.steps + first_of_material(), call.steps + op_.values,
                                     [](npy_intp step) { return step == 0; });
    this->tolerance = static_cast<Compute>(
        8 * std::max<double>(std::numeric_limits<T>::epsilon(), std::numeric_limits<Compute>::epsilon()));
    for (std::size_t k = 0; k < op_.constants; ++k)
      this->constant[k] = *reinterpret_cast<const double*>(call.args[op_.values + op_.elements + k]);
  }

 private:
  std::size_t first_of_material() const { return 3 * op_.directions + op_.uniforms; }
  char* at(std::size_t a) const { return call_.args[a] + first_ * call_.steps[a]; }
  bool in_place(std::size_t a) const {
    return frame_ == nullptr && std::is_same_v<T, Compute> && call_.steps[a] == sizeof(T) &&
           this->count % filled_up<Compute> == 0;
  }
  // The directions that a kernel is given, and the one that it gives, in coordinates of the mean plane.
  template <class Turn>
  void turn_to(const Turn& turned, block<Compute>* w) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(this->padded); ++i) {
      const vec3<double> to = turned(vec3<double>{w[0][i], w[1][i], w[2][i]});
      w[0][i] = static_cast<Compute>(to.x), w[1][i] = static_cast<Compute>(to.y);
      w[2][i] = static_cast<Compute>(to.z);
    }
  }
  bool advance() {
    if (frame_ != nullptr && this->count > 0 && op_.outputs > 2)
      turn_to([this](const vec3<double>& w) { return frame_->to_world(w); }, out_.data());
    for (std::size_t k = 0, a = call_.ufunc.inputs(); this->count > 0 && k < op_.outputs; ++k, ++a)
      if (!in_place(a)) scatter<Compute, T>(out_[k], at(a), call_.steps[a], this->count);
    first_ += this->count;
    if (first_ == call_.n) return false;
    this->count = static_cast<int>(std::min<npy_intp>(walk_block, call_.n - first_));
    this->padded = (this->count + filled_up<Compute> - 1) / filled_up<Compute> * filled_up<Compute>;
    for (std::size_t a = 0; a < op_.values; ++a) {
      this->in[a] = in_place(a) ? reinterpret_cast<const Compute*>(at(a)) : in_[a].data();
      const bool uniform = a >= 3 * op_.directions && a < first_of_material();
      if (!in_place(a))
        (uniform ? gather_uniform<T, Compute> : gather<T, Compute>)(at(a), call_.steps[a], this->count,
                                                                    in_[a]);
    }
    for (std::size_t k = 0; frame_ != nullptr && k < op_.directions; ++k)
      turn_to([this](const vec3<double>& w) { return frame_->from_world(w); }, &in_[3 * k]);
    if (op_.elements != 0)
      gather<double>(at(op_.values), call_.steps[op_.values], this->count, this->element);
    for (std::size_t k = 0, a = call_.ufunc.inputs(); k < op_.outputs; ++k, ++a)
      this->out[k] = in_place(a) ? reinterpret_cast<Compute*>(at(a)) : out_[k].data();
    return true;
  }

  const material_call& call_;
  const material_operation& op_;
  const mean_plane::frame* frame_;
  npy_intp first_ = 0;
  std::array<block<Compute>, most_values> in_;
  std::array<block<Compute>, most_results> out_;
};
template <class Compute, class T>
void run_blocks(const array_distribution<Compute>& d, void* data) {
  const auto& call = *static_cast<const material_call*>(data);
  const auto blocks = std::make_unique<blocks_of_call<Compute, T>>(call, d.frame);
  call.ufunc.operation->template kernel<Compute>(d)(d, *blocks);
}

// How many distributions were made for calls: a loop that runs over the channels of a material instead of the
// elements makes one for each element.
std::atomic<long long> prepared_distributions{0};

PyObject* count_prepared(PyObject*, PyObject*) { return PyLong_FromLongLong(prepared_distributions.load()); }
PyMethodDef prepared_counter{"distributions_prepared", &count_prepared, METH_NOARGS,
                             "How many distributions the materials' kernels have tabulated."};

template <class T>
void run_constant(const material_call& call) {
  const material_operation& op = *call.ufunc.operation;
  if (!op.needs_distribution()) return run_blocks<T, T>({}, const_cast<material_call*>(&call));
  prepared_distributions.fetch_add(1, std::memory_order_relaxed);
  std::array<double, 8> parameters{};
  for (std::size_t k = 0; k < call.ufunc.family.parameters; ++k)
    parameters[k] = *reinterpret_cast<const double*>(call.args[op.numbers() + k]);
  void* const data = const_cast<material_call*>(&call);
  const auto with = [&]<class Compute>(Compute) {
    return call.ufunc.family.with<Compute>()(parameters.data(), &run_blocks<Compute, T>, data);
  };
  if ((std::is_same_v<T, float> && with(0.0F)) || with(0.0)) return;
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

template <class Real>
const fused_kernels<Real>& fused_kernels_on_tables() {
  return fused_kernels_of<known_distribution<tabulated_directions<Real>>, Real>;
}
template const fused_kernels<float>& fused_kernels_on_tables<float>();
template const fused_kernels<double>& fused_kernels_on_tables<double>();
const fused_kernels<double>& fused_kernels_on_arrays() { return fused_kernels_of<from_arrays, double>; }

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
