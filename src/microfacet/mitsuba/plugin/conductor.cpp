#include "conductor.hpp"

#include <mitsuba/render/ior.h>

#include "microfacet/bsdf/fresnel.hpp"
#include "polarisation.hpp"

namespace microfacet::plugin {

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
    std::tie(eta_, k_) = mi::complex_ior_from_file<Spectrum, Texture>(material);
  }
  if (properties.has_property("specular_reflectance"))
    specular_reflectance_ = properties.get_texture<Texture>("specular_reflectance", 1.F);
  m_flags = mi::BSDFFlags::GlossyReflection | mi::BSDFFlags::FrontSide;
  if (alpha_u_ != alpha_v_) m_flags = m_flags | mi::BSDFFlags::Anisotropic;
  m_components.assign(1, m_flags);
}

void rough_conductor::traverse(mi::TraversalCallback* callback) {
  rough_bsdf::traverse(callback);
  const auto flags = mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous;
  if (eta_) callback->put("eta", eta_, flags), callback->put("k", k_, flags);
  if (specular_reflectance_)
    callback->put("specular_reflectance", specular_reflectance_, mi::ParamFlags::Differentiable);
}

Spectrum rough_conductor::reflectance(const mi::BSDFContext& context, const Interaction& si,
                                      const Vector3& wo, const vec3<Float>& m, const Mask& active) const {
  Spectrum result(1.F);
  if (eta_) {
    const Unpolarized eta = maximum(Unpolarized(eta_->eval(si, active)), Unpolarized(1e-6F)),
                      k = k_->eval(si, active);
    result = [&]<class Result>(const Result&) -> Result {
      if constexpr (mi::is_polarized_v<Result>) {
        return polarised_by_conductor<Result>({context, si, wo}, local(m), eta, k);
      } else {
        return fresnel_conductor(Unpolarized(dr::dot(si.wi, local(m))), eta, k);
      }
    }(result);
  }
  if (specular_reflectance_) result *= mi::depolarizer<Spectrum>(specular_reflectance_->eval(si, active));
  return result;
}

std::pair<Spectrum, Float> rough_conductor::eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                                     const Vector3& wo_, Mask active) const {
  const vec3<Float> wi = local(si.wi), wo = local(wo_);
  active &= (wi.z > Float(0)) & (wo.z > Float(0));
  if (!context.is_enabled(mi::BSDFFlags::GlossyReflection) || dr::none_or<false>(active))
    return {Spectrum(0.F), Float(0)};
  const roughness r = roughness_at(si, active);
  const vec3<Float> m = reflecting_facet(wi, wo);
  const facet_statistics<Float> at = statistics(r, wi, wo, m);
  const Float pdf = pdf_of_mirrors(at), leaving = pdf * shadowing<false>(wi.z, wo.z, at, correlated_);
  return {reflectance(context, si, wo_, m, active) * select(active, leaving, Float(0)) & active,
          select(active, pdf, Float(0))};
}

Spectrum rough_conductor::eval(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                               Mask active) const {
  return eval_pdf(context, si, wo, active).first;
}
Float rough_conductor::pdf(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                           Mask active) const {
  return eval_pdf(context, si, wo, active).second;
}

std::pair<Sample, Spectrum> rough_conductor::sample(const mi::BSDFContext& context, const Interaction& si,
                                                    Float, const Point2& sample2, Mask active) const {
  Sample result = dr::zeros<Sample>();
  const vec3<Float> wi = local(si.wi);
  active &= wi.z > Float(0);
  if (!context.is_enabled(mi::BSDFFlags::GlossyReflection) || dr::none_or<false>(active))
    return {result, Spectrum(0.F)};
  const roughness r = roughness_at(si, active);
  const vec3<Float> m = visible(r, wi, sample2), wo = reflect(wi, m);
  const facet_statistics<Float> at = statistics(r, wi, wo, m);
  result.wo = local(wo), result.eta = 1.F, result.sampled_component = 0;
  result.sampled_type = UInt32(+mi::BSDFFlags::GlossyReflection);
  const Float pdf = pdf_of_mirrors(at);
  Float weight = shadowing<false>(wi.z, wo.z, at, correlated_);
  // The direction stands still: what changes of its value is that of the density, too.
  if (differentiated(r)) weight = weight * pdf / dr::detach(pdf);
  active &= (wo.z > Float(0)) & (pdf > Float(0)) & (pdf < Float(inf));
  result.pdf = select(active, dr::detach(pdf), Float(0));
  return {result, reflectance(context, si, result.wo, m, active) * select(active, weight, Float(0)) & active};
}

}  // namespace microfacet::plugin
