#include "dielectric.hpp"

#include <mitsuba/render/ior.h>

#include "polarisation.hpp"

namespace microfacet::plugin {

namespace {

// A number or the name of a medium.
float index_of_refraction(const mi::Properties& properties, const char* name, const char* medium) {
  const float value = mi::lookup_ior(properties, name, medium);
  if (!(value > 0 && value < 1e4F))
    throw std::runtime_error(tfm::format("%s: \"%s\" is %g, an index of refraction lies in (0, 1e4)",
                                         properties.plugin_name(), name, value));
  return value;
}

}  // namespace

rough_dielectric::rough_dielectric(const mi::Properties& properties) : rough_bsdf(properties) {
  const float below = index_of_refraction(properties, "int_ior", "bk7"),
              above = index_of_refraction(properties, "ext_ior", "air");
  if (below == above)
    fail(properties, "\"int_ior\" equals ext_ior, %g: such an interface deflects nothing", below);
  eta_ = Float(below / above);
  dr::make_opaque(eta_);
  const auto texture = [&](const char* name) -> mi::ref<Texture> {
    if (!properties.has_property(name)) return nullptr;
    return properties.get_texture<Texture>(name, 1.F);
  };
  specular_reflectance_ = texture("specular_reflectance");
  specular_transmittance_ = texture("specular_transmittance");
  const std::uint32_t common = +mi::BSDFFlags::FrontSide | +mi::BSDFFlags::BackSide |
                               (alpha_u_ != alpha_v_ ? +mi::BSDFFlags::Anisotropic : 0U);
  m_components = {common | +mi::BSDFFlags::GlossyReflection,
                  common | +mi::BSDFFlags::GlossyTransmission | +mi::BSDFFlags::NonSymmetric};
  m_flags = m_components[0] | m_components[1];
  check_parameters();
}

void rough_dielectric::check_parameters() const {
  check(plugin_, "eta", eta_, relative_indices);
  if (number(eta_) == 1.F)
    throw std::runtime_error(plugin_ + ": \"eta\" is 1: such an interface deflects nothing");
  check_spectrum(plugin_, "specular_reflectance", specular_reflectance_.get(), factors);
  check_spectrum(plugin_, "specular_transmittance", specular_transmittance_.get(), factors);
}

void rough_dielectric::parameters_changed(const std::vector<std::string>& keys) {
  rough_bsdf::parameters_changed(keys);
  check_parameters();
}

void rough_dielectric::traverse(mi::TraversalCallback* callback) {
  rough_bsdf::traverse(callback);
  callback->put("eta", eta_, mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous);
  if (specular_reflectance_)
    callback->put("specular_reflectance", specular_reflectance_, mi::ParamFlags::Differentiable);
  if (specular_transmittance_)
    callback->put("specular_transmittance", specular_transmittance_, mi::ParamFlags::Differentiable);
}

Float rough_dielectric::density(const local_pair& at, const half_vector<Float>& m,
                                const facet_statistics<Float>& facets, const components& wanted) {
  const auto reflected = at.wo().z > Float(0);
  if (wanted.both()) return at.phase(m, facets);
  // One alone is drawn for every facet.
  if (wanted.reflection) return select(reflected, pdf_of_mirrors(facets.D, facets.inverse_sigma), Float(0));
  const Float share = at.material().reflectance(m.cosine);
  const Float refracted = at.material().refracted(at.wi(), at.wo(), m, facets.D, facets.inverse_sigma);
  return select(reflected | (share >= Float(1)), Float(0),
                Float(refracted / maximum(Float(1) - share, Float(1e-6F))));
}

facet_event dielectric_facets::scatter(const vec3<Float>& back, const vec3<Float>& m, const Mask& below,
                                       const Float& xi) const {
  const scattered<Float> s = material_.flipped(below).scatter(back, m, xi, xi);
  return {s.w, s.passed, tint(s.passed) * s.weight};
}
Unpolarized dielectric_facets::phase(const vec3<Float>& back, const vec3<Float>& side, const Mask& below,
                                     const Float& sigma) const {
  const dielectric<Float> material = material_.flipped(below);
  const half_vector<Float> m = material.half_vector(back, side);
  const Float sent =
      material.phase(back, side, m, normals_at(normals_, roughness_, back).D(m.m), Float(Float(1) / sigma));
  return tint(side.z <= Float(0)) * sent;
}

dielectric_facets rough_dielectric::facets_at(const Interaction& si, const roughness& r, const local_pair& at,
                                              const Mask& active) const {
  dielectric_facets facets(*distribution_, r, at.material());
  if (specular_reflectance_)
    facets.mirrored_tint = bounded(Unpolarized(specular_reflectance_->eval(si, active)), 0.F, 1.F);
  if (specular_transmittance_)
    facets.passed_tint = bounded(Unpolarized(specular_transmittance_->eval(si, active)), 0.F, 1.F);
  return facets;
}

Float rough_dielectric::proposal_pdf(const Float& wo_z, const Float& first_order) {
  constexpr float diffuse = 0.2F;  // half of it on each side
  return (first_order + Float(0.5F * diffuse / pi) * abs(wo_z)) * Float(1 / (1 + diffuse));
}

Spectrum rough_dielectric::polarised(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                                     const local_pair& at, const vec3<Float>& m,
                                     const Unpolarized& value) const {
  return [&]<class Result>(Result) -> Result {
    if constexpr (mi::is_polarized_v<Result>) {
      // Turning over leaves m as it is: from wi's side of the facet, now above, to the true upper side.
      return polarised_by_dielectric<Result>({context, si, wo}, local(m), eta_, at.wo().z > Float(0)) * value;
    } else {
      return value;
    }
  }(Spectrum(0.F));
}

std::pair<Spectrum, Float> rough_dielectric::eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                                      const Vector3& wo_, Mask active) const {
  const components wanted(context);
  const local_pair at(dielectric<Float>(eta_), local(si.wi), local(wo_));
  const vec3<Float> wi = at.wi(), wo = at.wo();
  active &= (wi.z > Float(0)) & (wo.z != Float(0));
  if (!wanted.both()) active &= (wo.z > Float(0)) == Mask(wanted.reflection);
  if (!(wanted.reflection || wanted.transmission) || dr::none_or<false>(active))
    return {Spectrum(0.F), Float(0)};
  const bool radiance = context.mode == mi::TransportMode::Radiance;
  const roughness r = roughness_at(si, active);
  const half_vector<Float> m = at.half_vector();
  const facet_statistics<Float> facets = at.statistics(normals_at(*distribution_, r, wi), m.m);
  const Float drawn = at.phase(m, facets), value = drawn * at.leaving(facets, correlated_, radiance);
  active &= drawn < Float(inf);  // close to index 1 a density may be no number
  Float pdf = wanted.both() ? drawn : density(at, m, facets, wanted);
  const dielectric_facets walls = facets_at(si, r, at, active);
  Spectrum result = polarised(context, si, wo_, at, normalize(m.m),
                              walls.tint(wo.z < Float(0)) * select(active, value, Float(0)));
  if (multiple_) {
    reject_gradients(r, eta_, walls.mirrored_tint, walls.passed_tint);
    const walk_seed seed = walk_seed::of(wi.x, wi.y, si.wi.z(), wo.x, wo.y, wo.z, si.p.x(), si.p.y());
    const Unpolarized rest = facet_walk(*distribution_, r, walls, seed).rest(wi, wo, active);
    result += depolarised(rest * at.radiance_scale(radiance));
    pdf = proposal_pdf(wo.z, drawn);
  }
  return {result & active, select(active, pdf, Float(0))};
}

std::pair<Sample, Spectrum> rough_dielectric::sample(const mi::BSDFContext& context, const Interaction& si,
                                                     Float sample1, const Point2& sample2,
                                                     Mask active) const {
  Sample result = dr::zeros<Sample>();
  const components wanted(context);
  const vec3<Float> wi = local(si.wi);
  active &= wi.z != Float(0);
  if (!(wanted.reflection || wanted.transmission) || dr::none_or<false>(active))
    return {result, Spectrum(0.F)};
  if (multiple_) return walk(context, si, sample1, sample2, active);
  const roughness r = roughness_at(si, active);
  const local_pair before(dielectric<Float>(eta_), wi, wi);
  const vec3<Float> m = visible(r, before.wi(), sample2);
  // At 2 light always passes where it can, below 0 never.
  const Float choice = wanted.both() ? sample1 : Float(wanted.reflection ? -1.F : 2.F);
  const local_pair drawn = before.drawn(m, choice);
  const vec3<Float> w = before.turned(drawn.wo());
  const vec3<Float> wo{dr::detach(w.x), dr::detach(w.y), dr::detach(w.z)};
  const local_pair at(dielectric<Float>(eta_), wi, wo);
  const auto passed = drawn.passed() > Float(0);
  active &= select(passed, Float(-at.wo().z), at.wo().z) > Float(0);
  if (!wanted.reflection) active &= passed;
  const half_vector<Float> half{m, dot(at.wi(), m)};
  const facet_statistics<Float> facets = at.statistics(normals_at(*distribution_, r, at.wi()), m);
  const Float pdf = density(at, half, facets, wanted);
  Float weight = at.leaving(facets, correlated_, context.mode == mi::TransportMode::Radiance);
  if (!wanted.both()) weight = weight * at.phase(half, facets) / pdf;
  // The direction stands still: what changes of its value is that of the density, too.
  if (differentiated(r) || dr::grad_enabled(eta_)) weight = weight * pdf / dr::detach(pdf);
  active &= (pdf > Float(0)) & (pdf < Float(inf));
  weight = maximum(weight, Float(0x1p-100F));  // 0 would say that it was not drawn

  result.wo = dr::select(active, local(wo), dr::zeros<Vector3>());
  result.pdf = select(active, dr::detach(pdf), Float(0));
  result.eta = select(passed, at.material().eta(), Float(1));
  result.sampled_component = dr::select(passed, UInt32(1), UInt32(0));
  result.sampled_type = dr::select(passed, UInt32(+mi::BSDFFlags::GlossyTransmission),
                                   UInt32(+mi::BSDFFlags::GlossyReflection));
  const Unpolarized left = facets_at(si, r, at, active).tint(passed) * select(active, weight, Float(0));
  return {result, polarised(context, si, result.wo, at, m, left) & active};
}

std::pair<Sample, Spectrum> rough_dielectric::walk(const mi::BSDFContext& context, const Interaction& si,
                                                   const Float& sample1, const Point2& sample2,
                                                   const Mask& active_) const {
  const components wanted(context);
  const roughness r = roughness_at(si, active_);
  const local_pair before(dielectric<Float>(eta_), local(si.wi), local(si.wi));
  const dielectric_facets walls = facets_at(si, r, before, active_);
  reject_gradients(r, eta_, walls.mirrored_tint, walls.passed_tint);
  const walk_seed seed = walk_seed::of(sample1, sample2.x(), sample2.y());
  const auto [wo, left, once] = facet_walk(*distribution_, r, walls, seed).sample(before.wi(), active_);
  const local_pair at(dielectric<Float>(eta_), local(si.wi), before.turned(wo));
  const auto crossed = wo.z < Float(0);
  Mask active = active_ & (wo.z != Float(0));
  if (!wanted.both()) active &= crossed == Mask(wanted.transmission);
  Sample result = dr::zeros<Sample>();
  result.wo = dr::select(active, local(at.turned(wo)), dr::zeros<Vector3>());
  const half_vector<Float> m = at.half_vector();
  const Float drawn = at.phase(m, at.statistics(normals_at(*distribution_, r, at.wi()), m.m));
  result.pdf = select(active, proposal_pdf(wo.z, drawn), Float(0));
  active &= result.pdf > Float(0);
  result.eta = select(crossed, at.material().eta(), Float(1));
  result.sampled_component = dr::select(crossed, UInt32(1), UInt32(0));
  result.sampled_type = dr::select(crossed, UInt32(+mi::BSDFFlags::GlossyTransmission),
                                   UInt32(+mi::BSDFFlags::GlossyReflection));
  // Only the first order keeps its polarisation, as in eval.
  const Unpolarized weight = left * at.radiance_scale(context.mode == mi::TransportMode::Radiance);
  const Spectrum first = polarised(context, si, result.wo, at, normalize(m.m), weight);
  return {result, dr::select(once, first, depolarised(weight)) & active};
}

Spectrum rough_dielectric::eval_diffuse_reflectance(const Interaction& si, Mask active) const {
  const dr::suspend_grad<Float> no_gradients;
  active &= si.wi.z() != Float(0);
  const roughness r = roughness_at(si, active);
  const local_pair at(dielectric<Float>(eta_), local(si.wi), local(si.wi));
  const dielectric_facets walls = facets_at(si, r, at, active);
  const normals_at normals(*distribution_, r, at.wi());
  const Float inverse = inverse_sigma(normals, at.wi());
  return depolarised(mean_of_draws(si, active, [&](const draw& xi) {
    if (multiple_) return facet_walk(*distribution_, r, walls, xi.seed()).sample(at.wi(), active).left;
    const vec3<Float> m = distribution_->sample_visible(r, at.wi(), xi.facet);
    const Float share = at.material().reflectance(dot(at.wi(), m));
    // Below 0 light is always reflected, at 2 it passes where it can.
    const auto leaving = [&](float choice) {
      return leaving_share(normals, at.drawn(m, Float(choice)), inverse);
    };
    return Unpolarized(walls.mirrored_tint * (share * leaving(-1)) +
                       walls.passed_tint * ((Float(1) - share) * leaving(2)));
  }));
}

}  // namespace microfacet::plugin
