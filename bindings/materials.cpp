// Materials as ufuncs: values (directions, optical constants, uniform numbers) in the precision of the loop;
// then numbers that are double and the same for all elements but for the first of a walk, the number of the
// element; then the parameters of the distribution.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "blocks.hpp"
#include "distribution.hpp"
#include "lanes.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/diffuse.hpp"
#include "microfacet/bsdf/random_walk.hpp"
#include "microfacet/bsdf/single_scattering.hpp"
#include "numpy.hpp"

namespace microfacet::bindings {
namespace {

inline constexpr std::size_t most_values = 12, most_constants = 6;

// One block of elements, whose arrays are valid up to `padded`.
template <class Real>
struct material_block {
  int count, padded;
  std::array<walk_array<Real>, most_values> in;
  walk_array<double> element;
  std::array<double, most_constants> constant;
  std::array<walk_array<Real>, 5> out;

  template <class Lanes>
  Lanes at(std::size_t k, int i) const {
    return load<Lanes>(in[k].data() + i);
  }
  template <class Lanes>
  vec3<Lanes> direction(std::size_t k, int i) const {
    return {at<Lanes>(k, i), at<Lanes>(k + 1, i), at<Lanes>(k + 2, i)};
  }
  walk_vectors<Real> vectors(std::size_t k) const { return {in[k], in[k + 1], in[k + 2]}; }
};

template <class Real>
using material_kernel = void (*)(const array_distribution<Real>&, material_block<Real>&);

struct material_operation {
  const char* name;
  std::size_t values, elements, constants, outputs;
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

template <class Lanes>
void put(const Lanes& x, walk_array<lane_of<Lanes>>& a, int i) {
  store(x, a.data() + i);
}
template <class Lanes>
void put(const vec3<Lanes>& v, walk_vectors<lane_of<Lanes>>& a, int i) {
  put(v.x, a.x, i), put(v.y, a.y, i), put(v.z, a.z, i);
}
template <class Lanes>
vec3<Lanes> at(const walk_vectors<lane_of<Lanes>>& a, int i) {
  return {load<Lanes>(a.x.data() + i), load<Lanes>(a.y.data() + i), load<Lanes>(a.z.data() + i)};
}
template <class Lanes>
Lanes at(const walk_array<lane_of<Lanes>>& a, int i) {
  return load<Lanes>(a.data() + i);
}

// Single scattering, in steps of all elements.
template <template <class> class Material, class Real>
class single_step {
  using L = lanes<Real>;
  using pair = scattering_pair<Material<L>, L>;

 public:
  single_step(const array_distribution<Real>& distribution, material_block<Real>& block)
      : d_(distribution), b_(block) {}

  // wi, wo, material | correlated, radiance
  [[gnu::flatten]] void eval() {
    each([&](int i) {
      const pair p = given(i);
      put(p.wi(), wi_, i), put(p.blocking(), blocking_, i), put(p.facet(), m_, i);
    });
    look();
    d_.area(b_.padded, blocking_, blocked_);
    each([&](int i) {
      put(given(i).eval(at<L>(m_, i), statistics(i), correlated(), radiance()), b_.out[0], i);
    });
  }
  // wi, wo, material | bounded
  [[gnu::flatten]] void pdf() {
    each([&](int i) {
      const pair p = given(i);
      put(p.wi(), wi_, i), put(p.mirror(), m_, i), put(p.lens(), other_, i);
    });
    look();
    if (transmits) d_.D(b_.padded, other_, D_of_other_);
    if (b_.constant[0] != 0 && d_.has(quantity::pdf_bounded)) {
      d_.pdf_bounded(b_.padded, m_, wi_, D_);
      each([&](int i) { put(bounded_density(at<L>(wi_, i), at<L>(m_, i), at<L>(D_, i)), b_.out[0], i); });
      return;
    }
    each([&](int i) {
      put(given(i).pdf(at<L>(m_, i), at<L>(D_, i), at<L>(other_, i), at<L>(D_of_other_, i), at<L>(area_, i)),
          b_.out[0], i);
    });
  }
  // wi, xi (4), material | correlated, radiance, bounded
  [[gnu::flatten]] void sample() {
    each([&](int i) { put(pair(material(7, i), wi(i), wi(i)).wi(), wi_, i); });
    const bool bounded = b_.constant[2] != 0 && d_.has(quantity::visible_bounded);
    d_.draw(bounded ? quantity::visible_bounded : quantity::visible, b_.padded, wi_, &b_.in[3], m_);
    each([&](int i) {
      const pair p = drawn(i);
      put(p.blocking(), blocking_, i), put(p.other_facet(), other_, i);
    });
    look();
    d_.area(b_.padded, blocking_, blocked_);
    if (transmits) d_.D(b_.padded, other_, D_of_other_);
    if (bounded) d_.pdf_bounded(b_.padded, m_, wi_, pdf_bounded_);
    each([&](int i) { finish(i, bounded); });
  }
  // wi, m, material | correlated: what the facets m send on their way and out, of light from wi, per
  // steradian of normals: mirrored, and passed.
  [[gnu::flatten]] void facets() {
    each([&](int i) {
      put(pair(material(6, i), wi(i), wi(i)).wi(), wi_, i);
      put(b_.template direction<L>(3, i), m_, i);
      put(through(i, L(0)).blocking(), blocking_, i), put(through(i, L(1)).blocking(), other_, i);
    });
    look();
    d_.area(b_.padded, blocking_, blocked_), d_.area(b_.padded, other_, pdf_bounded_);
    each([&](int i) {
      const auto part = [&](const L& xi, const walk_array<Real>& blocked) {
        return through(i, xi).of_facet(at<L>(m_, i), {at<L>(D_, i), at<L>(area_, i), at<L>(blocked, i)},
                                       correlated());
      };
      put(part(L(0), blocked_), b_.out[0], i);
      // Beyond the critical angle nothing passes.
      const L crosses = through(i, L(1)).passed();
      put(select(crosses > L(0), part(L(1), pdf_bounded_), L(L(0) * crosses)), b_.out[1], i);
    });
  }

 private:
  static constexpr bool transmits = requires(const Material<L> m) { m.eta(); };
  using draw = typename pair::draw;

  void finish(int i, bool bounded) {
    const pair p = drawn(i);
    draw r = p.result(at<L>(m_, i), statistics(i), at<L>(other_, i), at<L>(D_of_other_, i), correlated(),
                      radiance());
    if (bounded) {
      const L density = bounded_density(at<L>(wi_, i), at<L>(m_, i), at<L>(pdf_bounded_, i));
      r.weight = select(density > L(0), L(r.weight * (r.pdf / density)), L(L(0) * r.weight)), r.pdf = density;
    }
    put(r.wo.x, b_.out[0], i), put(r.wo.y, b_.out[1], i), put(r.wo.z, b_.out[2], i);
    put(r.weight, b_.out[3], i), put(r.pdf, b_.out[4], i);
  }
  static L bounded_density(const vec3<L>& wi, const vec3<L>& m, const L& density) {
    const L cosine = dot(wi, m);
    return select((cosine > L(0)) & (wi.z > L(0)), L(density * reflection_jacobian(wi, m)),
                  L(L(0) * density));
  }

  template <class Function>
  void each(const Function& function) const {
    for (int i = 0; i < b_.padded; i += width<L>) function(i);
  }
  void look() { d_.D(b_.padded, m_, D_), d_.area(b_.padded, wi_, area_); }
  bool correlated() const { return b_.constant[0] != 0; }
  bool radiance() const { return b_.constant[1] != 0; }
  vec3<L> wi(int i) const { return b_.template direction<L>(0, i); }
  Material<L> material(std::size_t k, int i) const {
    const std::array<L, 2> p{b_.template at<L>(k, i), b_.template at<L>(k + Material<L>::parameters - 1, i)};
    return Material<L>(p.data());
  }
  pair given(int i) const { return pair(material(6, i), wi(i), b_.template direction<L>(3, i)); }
  pair drawn(int i) const {
    return pair::drawn(material(7, i), wi(i), at<L>(m_, i), b_.template at<L>(6, i));
  }
  pair through(int i, const L& xi) const { return pair::drawn(material(6, i), wi(i), at<L>(m_, i), xi); }
  facet_statistics<L> statistics(int i) const { return {at<L>(D_, i), at<L>(area_, i), at<L>(blocked_, i)}; }

  const array_distribution<Real>& d_;
  material_block<Real>& b_;
  walk_vectors<Real> wi_, m_, other_, blocking_;
  walk_array<Real> D_, D_of_other_{}, area_, blocked_, pdf_bounded_;
};

// A number that is none of the whole ones that a double holds counts as 0.
std::uint64_t whole(double x) { return x >= 0 && x < 0x1p53 ? static_cast<std::uint64_t>(x) : 0; }

template <template <class> class Material, class Real>
walk_task<Real> task_of(const material_block<Real>& b, std::size_t material) {
  walk_task<Real> t;
  t.count = b.count, t.wi = b.vectors(0), t.seed = whole(b.constant[0]);
  for (std::size_t k = 0; k < 2; ++k)
    t.parameters[k] = b.in[material + std::min(k, std::size_t{Material<Real>::parameters - 1})];
  for (std::size_t i = 0; i < walk_block; ++i) t.element[i] = whole(b.element[i]);
  return t;
}
template <template <class> class Material, class Real>
using walks = random_walk<lanes<Real>, array_distribution<Real>, Material>;

// What a walk from wi gives, and 1/eta^2 of radiance that ends on the other side; nothing from below an
// opaque surface.
template <template <class> class Material, class Real>
Real factor_of_walk(const material_block<Real>& b, std::size_t material, std::size_t i, Real wo_z,
                    bool radiance) {
  const Real wi_z = b.in[2][i];
  if constexpr (requires(const Material<Real> m) { m.eta(); }) {
    if (radiance && wi_z * wo_z < 0) {
      const Real eta = b.in[material][i], relative = wi_z > 0 ? eta : 1 / eta;
      return 1 / (relative * relative);
    }
    return wi_z == 0 || wo_z == 0 ? Real(0) : Real(1);
  } else {
    return wi_z > 0 && wo_z > 0 ? Real(1) : Real(0);
  }
}

// wi, material | element | seed, radiance
template <template <class> class Material, class Real>
void walk_sample(const array_distribution<Real>& d, material_block<Real>& b) {
  const auto walk = std::make_unique<walks<Material, Real>>(d);
  walk_vectors<Real> wo{};
  walk->sample(task_of<Material>(b, 3), wo, b.out[3], b.out[4]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    b.out[0][i] = wo.x[i], b.out[1][i] = wo.y[i], b.out[2][i] = wo.z[i];
    b.out[3][i] *= factor_of_walk<Material>(b, 3, i, wo.z[i], b.constant[1] != 0);
  }
}
// wi, wo, material | element | seed, radiance, number of walks, first and last order
template <template <class> class Material, class Real>
void walk_eval(const array_distribution<Real>& d, material_block<Real>& b) {
  const auto walk = std::make_unique<walks<Material, Real>>(d);
  const walk_task<Real> task = task_of<Material>(b, 6);
  const walk_vectors<Real> wo = b.vectors(3);
  walk_array<Real> sum{};
  const std::uint64_t number = whole(b.constant[2]);
  const auto first = static_cast<long>(whole(b.constant[3])), last = static_cast<long>(whole(b.constant[4]));
  for (std::uint64_t k = 0; k < number; ++k) walk->evaluate(task, wo, k, first, last, sum);
  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    Real invalid = 0;  // a direction that is none; of a material that is none the sum is nan
    for (std::size_t k = 0; k < 6; ++k)
      if (!(std::abs(b.in[k][i]) < Real(inf))) invalid = nan<Real>();
    const Real factor = factor_of_walk<Material>(b, 6, i, wo.z[i], b.constant[1] != 0);
    b.out[0][i] = (factor == 0 ? Real(0) : sum[i] / static_cast<Real>(number) * factor) + invalid;
  }
}

template <template <class> class Material, class Real>
void single_eval(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).eval();
}
template <template <class> class Material, class Real>
void single_pdf(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).pdf();
}
template <template <class> class Material, class Real>
void single_sample(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).sample();
}
template <template <class> class Material, class Real>
void single_facets(const array_distribution<Real>& d, material_block<Real>& b) {
  single_step<Material, Real>(d, b).facets();
}

#define MICROFACET_MATERIAL(NAME, VALUES, ELEMENTS, CONSTANTS, OUTPUTS, KERNEL, MATERIAL) \
  {NAME, VALUES, ELEMENTS, CONSTANTS, OUTPUTS, &KERNEL<MATERIAL, float>, &KERNEL<MATERIAL, double>}
constexpr material_operation operations[] = {
    MICROFACET_MATERIAL("conductor_eval", 8, 0, 2, 1, single_eval, conductor),
    MICROFACET_MATERIAL("conductor_pdf", 8, 0, 1, 1, single_pdf, conductor),
    MICROFACET_MATERIAL("conductor_sample", 9, 0, 3, 5, single_sample, conductor),
    MICROFACET_MATERIAL("conductor_facets", 8, 0, 1, 2, single_facets, conductor),
    MICROFACET_MATERIAL("conductor_walk", 5, 1, 2, 5, walk_sample, conductor),
    MICROFACET_MATERIAL("conductor_walk_eval", 8, 1, 5, 1, walk_eval, conductor),
    MICROFACET_MATERIAL("dielectric_eval", 7, 0, 2, 1, single_eval, dielectric),
    MICROFACET_MATERIAL("dielectric_pdf", 7, 0, 1, 1, single_pdf, dielectric),
    MICROFACET_MATERIAL("dielectric_sample", 8, 0, 3, 5, single_sample, dielectric),
    MICROFACET_MATERIAL("dielectric_facets", 7, 0, 1, 2, single_facets, dielectric),
    MICROFACET_MATERIAL("dielectric_walk", 4, 1, 2, 5, walk_sample, dielectric),
    MICROFACET_MATERIAL("dielectric_walk_eval", 7, 1, 5, 1, walk_eval, dielectric),
    MICROFACET_MATERIAL("diffuse_walk", 4, 1, 2, 5, walk_sample, diffuse),
    MICROFACET_MATERIAL("diffuse_walk_eval", 7, 1, 5, 1, walk_eval, diffuse),
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

template <class Compute, class T>
void run_blocks(const array_distribution<Compute>& d, void* data) {
  const auto& call = *static_cast<const material_call*>(data);
  const material_operation& op = *call.ufunc.operation;
  const auto b = std::make_unique<material_block<Compute>>();
  for (std::size_t k = 0; k < op.constants; ++k)
    b->constant[k] = *reinterpret_cast<const double*>(call.args[op.values + op.elements + k]);
  for (npy_intp first = 0; first < call.n; first += walk_block) {
    const std::ptrdiff_t count = std::min<npy_intp>(walk_block, call.n - first);
    constexpr std::ptrdiff_t full = filled_up<Compute>;
    b->count = static_cast<int>(count), b->padded = static_cast<int>((count + full - 1) / full * full);
    const auto at = [&](std::size_t a) { return call.args[a] + first * call.steps[a]; };
    for (std::size_t a = 0; a < op.values; ++a) gather<T>(at(a), call.steps[a], count, b->in[a]);
    if (op.elements != 0) gather<double>(at(op.values), call.steps[op.values], count, b->element);
    op.template kernel<Compute>()(d, *b);
    for (std::size_t k = 0, a = call.ufunc.inputs(); k < op.outputs; ++k, ++a)
      scatter<Compute, T>(b->out[k], at(a), call.steps[a], count);
  }
}

template <class T>
void run_constant(const material_call& call) {
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
    if (!add_ufunc(space, op.name, op.name, plan, ufunc, {&material_loop<float>, &material_loop<double>}))
      return false;
  }
  return true;
}

}  // namespace microfacet::bindings
