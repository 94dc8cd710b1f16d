#include "conductor.hpp"

#include <mitsuba/render/ior.h>

#include "microfacet/bsdf/fresnel.hpp"
#include "polarisation.hpp"

namespace microfacet::plugin {

namespace {

// Directions, facets and masking; what facets reflect, in several colours, is a factor of its own.
using mirror_pair = scattering_pair<conductor<Float>, Float>;
mirror_pair mirrors(const vec3<Float>& wi, const vec3<Float>& wo) {
  return {conductor<Float>(Float(inf), Float(0)), wi, wo};
}

}  // namespace

rough_conductor::rough_conductor(const mi::Properties& properties) : rough_bsdf(properties) {
  const auto material = properties.get<std::string>("material", std::string("none"));
  const bool eta = properties.has_property("eta"), k = properties.has_property("k");
  if (eta != k) fail(properties, "\"%s\" is missing: eta and k go together", eta ? "k" : "eta");
  if (eta && properties.has_property("material"))
    fail(properties, "\"material\" is given beside eta and k: it is one or the other");
  if (eta) {
    eta_ = properties.get_unbounded_texture<Texture>("eta"),
    k_ = properties.get_unbounded_texture<Texture>("k");
  } else if (material != "none") {
    try {
      tabulated_ = true;
      std::tie(eta_, k_) = mi::complex_ior_from_file<Spectrum, Texture>(material);
    } catch (const std::exception&) {
      fail(properties, "\"material\" is \"%s\", which is none of Mitsuba's conductors", material);
    }
  }
  if (properties.has_property("specular_reflectance"))
    specular_reflectance_ = properties.get_texture<Texture>("specular_reflectance", 1.F);
  m_flags = mi::BSDFFlags::GlossyReflection | mi::BSDFFlags::FrontSide;
  if (alpha_u_ != alpha_v_) m_flags = m_flags | mi::BSDFFlags::Anisotropic;
  m_components.assign(1, m_flags);
  check_parameters();
}

void rough_conductor::check_parameters() const {
  check_spectrum(plugin_, "eta", eta_.get(), tabulated_ ? indices_of_tables : indices);
  check_spectrum(plugin_, "k", k_.get(), extinctions);
  check_spectrum(plugin_, "specular_reflectance", specular_reflectance_.get(), factors);
}

void rough_conductor::parameters_changed(const std::vector<std::string>& keys) {
  rough_bsdf::parameters_changed(keys);
  check_parameters();
}

void rough_conductor::traverse(mi::TraversalCallback* callback) {
  rough_bsdf::traverse(callback);
  const auto flags = mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous;
  if (eta_) callback->put("eta", eta_, flags), callback->put("k", k_, flags);
  if (specular_reflectance_)
    callback->put("specular_reflectance", specular_reflectance_, mi::ParamFlags::Differentiable);
}

Unpolarized conductor_facets::reflectance(const Float& cosine) const {
  return mirror ? tint : Unpolarized(tint * fresnel_conductor(Unpolarized(cosine), eta, k));
}
facet_event conductor_facets::scatter(const vec3<Float>& back, const vec3<Float>& m, const Mask&,
                                      const Float&) const {
  return {reflect(back, m), Mask(false), reflectance(dot(back, m))};
}
Unpolarized conductor_facets::phase(const vec3<Float>& back, const vec3<Float>& side, const Mask&,
                                    const Float& sigma) const {
  const half_vector<Float> m = half_vector_reflection(back, side);
  return reflectance(m.cosine) *
         pdf_of_mirrors(normals_at(normals_, roughness_, back).D(m.m), Float(Float(1) / sigma));
}

conductor_facets rough_conductor::facets_at(const Interaction& si, const roughness& r,
                                            const Mask& active) const {
  conductor_facets facets(*distribution_, r);
  facets.mirror = !eta_;
  if (eta_) {
    facets.eta = bounded(Unpolarized(eta_->eval(si, active)), 1e-6F, indices.upper);
    facets.k = bounded(Unpolarized(k_->eval(si, active)), extinctions.lower, extinctions.upper);
  }
  if (specular_reflectance_)
    facets.tint = bounded(Unpolarized(specular_reflectance_->eval(si, active)), 0.F, 1.F);
  return facets;
}

Spectrum rough_conductor::polarised(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                                    const vec3<Float>& m, const conductor_facets& facets,
                                    const Unpolarized& value) {
  return [&]<class Result>(Result) -> Result {
    if constexpr (mi::is_polarized_v<Result>) {
      const light_path path(context, si, wo);
      return (facets.mirror ? polarised_by_mirror<Result>(path, local(m))
                            : polarised_by_conductor<Result>(path, local(m), facets.eta, facets.k)) *
             value;
    } else {
      return value;
    }
  }(Spectrum(0.F));
}

Float rough_conductor::proposal_pdf(const Float& wo_z, const Float& first_order) {
  constexpr float diffuse = 0.2F;
  return (first_order + Float(diffuse / pi) * maximum(wo_z, Float(0))) * Float(1 / (1 + diffuse));
}

std::pair<Spectrum, Float> rough_conductor::eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                                     const Vector3& wo_, Mask active) const {
  const vec3<Float> wi = local(si.wi), wo = local(wo_);
  active &= (wi.z > Float(0)) & (wo.z > Float(0));
  if (!context.is_enabled(mi::BSDFFlags::GlossyReflection) || dr::none_or<false>(active))
    return {Spectrum(0.F), Float(0)};
  const roughness r = roughness_at(si, active);
  const conductor_facets facets = facets_at(si, r, active);
  const mirror_pair pair = mirrors(wi, wo);
  const half_vector<Float> m = pair.half_vector();
  const facet_statistics<Float> at = pair.statistics(normals_at(*distribution_, r, wi), m.m);
  Float pdf = pdf_of_mirrors(at.D, at.inverse_sigma);
  const Float leaving = pdf * pair.leaving(at, correlated_, true);
  const Unpolarized first = facets.reflectance(m.cosine) * select(active, leaving, Float(0));
  Spectrum value = polarised(context, si, wo_, normalize(m.m), facets, first);
  if (multiple_) {
    reject_gradients(r, facets.eta, facets.k, facets.tint);
    const walk_seed seed = walk_seed::of(wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, si.p.x(), si.p.y());
    value += depolarised(facet_walk(*distribution_, r, facets, seed).rest(wi, wo, active));
    pdf = proposal_pdf(wo.z, pdf);
  }
  return {value & active, select(active, pdf, Float(0))};
}

std::pair<Sample, Spectrum> rough_conductor::sample(const mi::BSDFContext& context, const Interaction& si,
                                                    Float sample1, const Point2& sample2, Mask active) const {
  Sample result = dr::zeros<Sample>();
  const vec3<Float> wi = local(si.wi);
  active &= wi.z > Float(0);
  if (!context.is_enabled(mi::BSDFFlags::GlossyReflection) || dr::none_or<false>(active))
    return {result, Spectrum(0.F)};
  const roughness r = roughness_at(si, active);
  const conductor_facets facets = facets_at(si, r, active);
  result.eta = 1.F, result.sampled_component = 0;
  result.sampled_type = UInt32(+mi::BSDFFlags::GlossyReflection);
  if (multiple_) {
    reject_gradients(r, facets.eta, facets.k, facets.tint);
    const walk_seed seed = walk_seed::of(sample1, sample2.x(), sample2.y());
    const auto [wo, left, once] = facet_walk(*distribution_, r, facets, seed).sample(wi, active);
    active &= wo.z > Float(0);
    result.wo = dr::select(active, local(wo), dr::zeros<Vector3>());
    const vec3<Float> m = half_vector_reflection(wi, wo).m;
    const normals_at normals(*distribution_, r, wi);
    const Float first_order = pdf_of_mirrors(normals.D(m), inverse_sigma(normals, wi));
    result.pdf = select(active, proposal_pdf(wo.z, first_order), Float(0));
    // Only the first order keeps its polarisation, as in eval.
    const Spectrum first = polarised(context, si, result.wo, normalize(m), facets, left);
    return {result, dr::select(once, first, depolarised(left)) & active & (result.pdf > Float(0))};
  }
  const vec3<Float> m = visible(r, wi, sample2), wo = reflect(wi, m);
  const mirror_pair pair = mirrors(wi, wo);
  const facet_statistics<Float> at = pair.statistics(normals_at(*distribution_, r, wi), m);
  const Float pdf = pdf_of_mirrors(at.D, at.inverse_sigma);
  Float weight = pair.leaving(at, correlated_, true);
  // The direction stands still: what changes of its value is that of the density, too.
  if (differentiated(r)) weight = weight * pdf / dr::detach(pdf);
  active &= (wo.z > Float(0)) & (pdf > Float(0)) & (pdf < Float(inf));
  // What has no weight has no direction either, where one may be no number.
  result.wo = dr::select(active, local(wo), dr::zeros<Vector3>());
  result.pdf = select(active, dr::detach(pdf), Float(0));
  const Unpolarized left = facets.reflectance(dot(wi, m)) * select(active, weight, Float(0));
  return {result, polarised(context, si, result.wo, m, facets, left) & active};
}

Spectrum rough_conductor::eval_diffuse_reflectance(const Interaction& si, Mask active) const {
  const dr::suspend_grad<Float> no_gradients;
  const vec3<Float> wi = local(si.wi);
  active &= wi.z > Float(0);
  const roughness r = roughness_at(si, active);
  const conductor_facets facets = facets_at(si, r, active);
  const mirror_pair pair = mirrors(wi, wi);
  const normals_at normals(*distribution_, r, wi);
  const Float inverse = inverse_sigma(normals, wi);
  return depolarised(mean_of_draws(si, active, [&](const draw& xi) {
    if (multiple_) return facet_walk(*distribution_, r, facets, xi.seed()).sample(wi, active).left;
    const vec3<Float> m = distribution_->sample_visible(r, wi, xi.facet);
    return facets.reflectance(dot(wi, m)) * leaving_share(normals, pair.drawn(m, xi.facet[0]), inverse);
  }));
}

}  // namespace microfacet::plugin
