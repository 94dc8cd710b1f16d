// Materials at any constants, directions and uniforms: single scattering, and walks of all orders.

#include <memory>

#include "fuzz.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/diffuse.hpp"
#include "microfacet/bsdf/single_scattering.hpp"
#include "microfacet/bsdf/walk/on_arrays.hpp"
#include "microfacet/bsdf/walk/random_walk.hpp"
#include "microfacet/family/ggx.hpp"
#include "microfacet/family/student_t.hpp"

namespace mf = microfacet;

namespace {

template <class T>
mf::vec3<T> direction(fuzz::input& in) {
  const mf::vec3<T> w{in.number<T>(), in.number<T>(), in.number<T>()};
  const T length = std::sqrt(mf::dot(w, w));
  return in.choice(4) ? mf::vec3<T>{w.x / length, w.y / length, w.z / length} : w;
}
template <class T>
bool is_unit(const mf::vec3<T>& w) {
  return std::abs(std::sqrt(mf::dot(w, w)) - T(1)) < T(8) * std::numeric_limits<T>::epsilon();
}

template <class Material, class T, class Distribution>
void once(const Material& material, const Distribution& ndf, fuzz::input& in) {
  const mf::vec3<T> wi = direction<T>(in), wo = direction<T>(in);
  const bool correlated = in.choice(2) != 0, radiance = in.choice(2) != 0;
  fuzz::require_positive("eval", static_cast<double>(eval(material, ndf, wi, wo, correlated, radiance)));
  fuzz::require_positive("pdf", static_cast<double>(pdf(material, ndf, wi, wo)));
  std::array<T, 4> xi;
  for (T& u : xi) u = in.choice(4) ? in.uniform<T>() : in.number<T>();
  const auto drawn = sample(material, ndf, wi, mf::vec3<T>{xi[0], xi[1], xi[2]}, xi[3], correlated, radiance);
  if (is_unit(wi)) {
    const T size = std::sqrt(mf::dot(drawn.wo, drawn.wo));
    fuzz::require_within("length of wo", static_cast<double>(size), 0.99, 1.01);
  }
  fuzz::require_positive("weight", static_cast<double>(drawn.weight));
  fuzz::require_positive("pdf of a sample", static_cast<double>(drawn.pdf));
}

template <template <class> class Material, class T, class Distribution>
void walk(const Distribution& ndf, fuzz::input& in) {
  using arrays = mf::on_arrays<T, Distribution>;
  const arrays distribution(ndf);
  const auto walks = std::make_unique<mf::random_walk<T, arrays, Material>>(distribution);
  mf::walk_task<T> task;
  task.count = 1, task.seed = in.bits<std::uint64_t>(), task.element[0] = in.bits<std::uint64_t>();
  const mf::vec3<T> wi = direction<T>(in), wo = direction<T>(in);
  task.wi.x[0] = wi.x, task.wi.y[0] = wi.y, task.wi.z[0] = wi.z;
  for (auto& p : task.parameters) p[0] = in.number<T>();
  mf::block3<T> out{};
  mf::block<T> weight{}, order{}, sum{};
  walks->sample(task, out, weight, order);
  fuzz::require_positive("weight of a walk", static_cast<double>(weight[0]));
  fuzz::require_within("order of a walk", static_cast<double>(order[0]), 0, 2000);
  out.x[0] = wo.x, out.y[0] = wo.y, out.z[0] = wo.z;
  walks->evaluate(task, out, 0, 1, 50, sum);
  fuzz::require_positive("value of a walk", static_cast<double>(sum[0]));
}

template <class T, class Family>
void ask(const Family& family, fuzz::input& in) {
  const mf::anisotropic_shape<T> shape(in.number<T>(), in.number<T>(), in.number<T>(), in.number<T>());
  const mf::ndf<Family, T> ndf(family, shape);
  const T eta = in.number<T>(), k = in.number<T>(), cosine = in.number<T>();
  fuzz::require_within("a metal's reflectance", static_cast<double>(mf::fresnel_conductor(cosine, eta, k)), 0,
                       1 + 1e-5);
  fuzz::require_within("reflectance", static_cast<double>(mf::fresnel_dielectric(cosine, eta).reflected), 0,
                       1);
  switch (in.choice(5)) {
    case 0:
      return once<mf::conductor<T>, T>(mf::conductor<T>(eta, k), ndf, in);
    case 1:
      return once<mf::dielectric<T>, T>(mf::dielectric<T>(eta), ndf, in);
    case 2:
      return walk<mf::conductor, T>(ndf, in);
    case 3:
      return walk<mf::dielectric, T>(ndf, in);
    default:
      return walk<mf::diffuse, T>(ndf, in);
  }
}

template <class T>
void of_family(fuzz::input& in) {
  if (in.choice(2) == 0)
    ask<T>(mf::ggx<T>(), in);
  else
    ask<T>(mf::student_t<T>(in.number<T>()), in);
}

}  // namespace

FUZZ {
  if (in.choice(2) == 0)
    of_family<float>(in);
  else
    of_family<double>(in);
}
