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

rough_dielectric::meeting::meeting(const rough_dielectric& of, const vec3<Float>& wi_, const vec3<Float>& wo_)
    : material(dielectric<Float>(of.eta_).flipped(wi_.z < Float(0))),
      turned(select(wi_.z < Float(0), Float(-1), Float(1))) {
  wi = scaled(wi_, turned), wo = scaled(wo_, turned);
}

Float rough_dielectric::density(const meeting& at, const vec3<Float>& m,
                                const facet_statistics<Float>& facets, const components& wanted) const {
  const auto reflected = at.wo.z > Float(0);
  if (wanted.both()) return at.material.phase(at.wi, at.wo, m, facets);
  // One alone is drawn for every facet.
  const Float share = at.material.reflectance(dot(at.wi, m));
  if (wanted.reflection) return select(reflected, pdf_of_mirrors(facets), Float(0));
  return select(
      reflected | (share >= Float(1)), Float(0),
      Float(at.material.refracted(at.wi, at.wo, m, facets) / maximum(Float(1) - share, Float(1e-6F))));
}

Float rough_dielectric::radiance_scale(const mi::BSDFContext& context, const meeting& at) {
  if (context.mode != mi::TransportMode::Radiance) return Float(1);
  const Float eta = at.material.eta();
  return select(at.wo.z < Float(0), Float(Float(1) / (eta * eta)), Float(1));
}
Float rough_dielectric::leaving(const mi::BSDFContext& context, const meeting& at,
                                const facet_statistics<Float>& facets) const {
  return shadowing<true>(at.wi.z, at.wo.z, facets, correlated_) * radiance_scale(context, at);
}

facet_event dielectric_facets::scatter(const vec3<Float>& back, const vec3<Float>& m, const Mask& below,
                                       const Float& xi) const {
  const scattered<Float> s = material_.flipped(below).scatter(back, m, xi, xi);
  return {s.w, s.passed, tint(s.passed) * s.weight};
}
Unpolarized dielectric_facets::phase(const vec3<Float>& back, const vec3<Float>& side, const Mask& below,
                                     const Float& area) const {
  const dielectric<Float> material = material_.flipped(below);
  const vec3<Float> m = material.facet(back, side);
  const Float sent =
      material.phase(back, side, m, {normals_.D(roughness_, m, resolution_of(back, m)), area, Float(0)});
  return tint(side.z <= Float(0)) * sent;
}

dielectric_facets rough_dielectric::facets_at(const Interaction& si, const roughness& r, const meeting& at,
                                              const Mask& active) const {
  dielectric_facets facets(*distribution_, r, at.material);
  if (specular_reflectance_)
    facets.mirrored_tint = bounded(Unpolarized(specular_reflectance_->eval(si, active)), 0.F, 1.F);
  if (specular_transmittance_)
    facets.passed_tint = bounded(Unpolarized(specular_transmittance_->eval(si, active)), 0.F, 1.F);
  return facets;
}

Float rough_dielectric::guide(const Float& wo_z, const Float& first_order) {
  constexpr float diffuse = 0.2F;  // half of it on each side
  return (first_order + Float(0.5F * diffuse / pi) * abs(wo_z)) * Float(1 / (1 + diffuse));
}

Spectrum rough_dielectric::polarised(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                                     const meeting& at, const vec3<Float>& m,
                                     const Unpolarized& value) const {
  return [&]<class Result>(Result) -> Result {
    if constexpr (mi::is_polarized_v<Result>) {
      // Turning over leaves m as it is: from wi's side of the facet, now above, to the true upper side.
      return polarised_by_dielectric<Result>({context, si, wo}, local(m), eta_, at.wo.z > Float(0)) * value;
    } else {
      return value;
    }
  }(Spectrum(0.F));
}

std::pair<Spectrum, Float> rough_dielectric::eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                                      const Vector3& wo_, Mask active) const {
  const components wanted(context);
  const meeting at(*this, local(si.wi), local(wo_));
  active &= (at.wi.z > Float(0)) & (at.wo.z != Float(0));
  if (!wanted.both()) active &= (at.wo.z > Float(0)) == Mask(wanted.reflection);
  if (!(wanted.reflection || wanted.transmission) || dr::none_or<false>(active))
    return {Spectrum(0.F), Float(0)};
  const roughness r = roughness_at(si, active);
  const vec3<Float> m = at.material.facet(at.wi, at.wo);
  const facet_statistics<Float> facets = statistics(r, at.wi, at.wo, m);
  const Float drawn = at.material.phase(at.wi, at.wo, m, facets),
              value = drawn * leaving(context, at, facets);
  active &= drawn < Float(inf);  // close to index 1 a density may be no number
  Float pdf = wanted.both() ? drawn : density(at, m, facets, wanted);
  const dielectric_facets walls = facets_at(si, r, at, active);
  Spectrum result =
      polarised(context, si, wo_, at, m, walls.tint(at.wo.z < Float(0)) * select(active, value, Float(0)));
  if (multiple_) {
    refuse_gradients(r, eta_, walls.mirrored_tint, walls.passed_tint);
    const walk_seed seed =
        walk_seed::of(at.wi.x, at.wi.y, si.wi.z(), at.wo.x, at.wo.y, at.wo.z, si.p.x(), si.p.y());
    const Unpolarized rest = facet_walk(*distribution_, r, walls, seed).rest(at.wi, at.wo, active);
    result += depolarised(rest * radiance_scale(context, at));
    pdf = guide(at.wo.z, drawn);
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
  meeting at(*this, wi, wi);
  const vec3<Float> m = visible(r, at.wi, sample2);
  // At 2 light always passes where it can, below 0 never.
  const Float choice = wanted.both() ? sample1 : Float(wanted.reflection ? -1.F : 2.F);
  const scattered<Float> s = at.material.scatter(at.wi, m, choice, choice);
  const vec3<Float> w{dr::detach(s.w.x), dr::detach(s.w.y), dr::detach(s.w.z)};
  at.wo = w;
  const auto passed = s.passed;
  active &= select(passed, Float(-w.z), w.z) > Float(0);
  if (!wanted.reflection) active &= passed;
  const facet_statistics<Float> facets = statistics(r, at.wi, at.wo, m);
  const Float pdf = density(at, m, facets, wanted);
  Float weight = leaving(context, at, facets);
  if (!wanted.both()) weight = weight * at.material.phase(at.wi, at.wo, m, facets) / pdf;
  // The direction stands still: what changes of its value is that of the density, too.
  if (differentiated(r) || dr::grad_enabled(eta_)) weight = weight * pdf / dr::detach(pdf);
  active &= (pdf > Float(0)) & (pdf < Float(inf));
  weight = maximum(weight, Float(0x1p-100F));  // 0 would say that it was not drawn

  result.wo = dr::select(active, local(scaled(w, at.turned)), dr::zeros<Vector3>());
  result.pdf = select(active, dr::detach(pdf), Float(0));
  result.eta = select(passed, at.material.eta(), Float(1));
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
  meeting at(*this, local(si.wi), local(si.wi));
  const dielectric_facets walls = facets_at(si, r, at, active_);
  refuse_gradients(r, eta_, walls.mirrored_tint, walls.passed_tint);
  const walk_seed seed = walk_seed::of(sample1, sample2.x(), sample2.y());
  const auto [wo, left, once] = facet_walk(*distribution_, r, walls, seed).sample(at.wi, active_);
  at.wo = wo;
  const auto crossed = wo.z < Float(0);
  Mask active = active_ & (wo.z != Float(0));
  if (!wanted.both()) active &= crossed == Mask(wanted.transmission);
  Sample result = dr::zeros<Sample>();
  result.wo = dr::select(active, local(scaled(wo, at.turned)), dr::zeros<Vector3>());
  const vec3<Float> m = at.material.facet(at.wi, wo);
  const Float drawn = at.material.phase(at.wi, wo, m, statistics(r, at.wi, wo, m));
  result.pdf = select(active, guide(wo.z, drawn), Float(0));
  active &= result.pdf > Float(0);
  result.eta = select(crossed, at.material.eta(), Float(1));
  result.sampled_component = dr::select(crossed, UInt32(1), UInt32(0));
  result.sampled_type = dr::select(crossed, UInt32(+mi::BSDFFlags::GlossyTransmission),
                                   UInt32(+mi::BSDFFlags::GlossyReflection));
  // Only the first order keeps its polarisation, as in eval.
  const Unpolarized weight = left * radiance_scale(context, at);
  const Spectrum first = polarised(context, si, result.wo, at, m, weight);
  return {result, dr::select(once, first, depolarised(weight)) & active};
}

Spectrum rough_dielectric::eval_diffuse_reflectance(const Interaction& si, Mask active) const {
  const dr::suspend_grad<Float> no_gradients;
  active &= si.wi.z() != Float(0);
  const roughness r = roughness_at(si, active);
  const meeting at(*this, local(si.wi), local(si.wi));
  const dielectric_facets walls = facets_at(si, r, at, active);
  const Float area = distribution_->sigma(r, at.wi);
  return depolarised(mean_of_draws(si, active, [&](const draw& xi) {
    if (multiple_) return facet_walk(*distribution_, r, walls, xi.seed()).sample(at.wi, active).left;
    const vec3<Float> m = distribution_->sample_visible(r, at.wi, xi.facet);
    const Float share = at.material.reflectance(dot(at.wi, m));
    const scattered<Float> passed = at.material.scatter(at.wi, m, Float(2), Float(2));
    return Unpolarized(
        walls.mirrored_tint * (share * leaving_share<true>(r, at.wi, reflect(at.wi, m), area)) +
        walls.passed_tint *
            ((Float(1) - share) * leaving_share<true>(r, at.wi, passed.w, area, passed.passed)));
  }));
}

}  // namespace microfacet::plugin
