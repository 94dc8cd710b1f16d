// The BSDF microfacet_conductor.
#pragma once

#include "rough_bsdf.hpp"

namespace microfacet::plugin {

class rough_conductor final : public rough_bsdf {
 public:
  MI_DECLARE_CLASS(rough_conductor)

  explicit rough_conductor(const mi::Properties& properties);
  void traverse(mi::TraversalCallback* callback) override;

  std::pair<Sample, Spectrum> sample(const mi::BSDFContext& context, const Interaction& si, Float sample1,
                                     const Point2& sample2, Mask active) const override;
  Spectrum eval(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                Mask active) const override;
  Float pdf(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
            Mask active) const override;
  std::pair<Spectrum, Float> eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                      const Vector3& wo, Mask active) const override;

 private:
  // Fresnel's reflection of a facet, as a Mueller matrix where light is polarised.
  Spectrum reflectance(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                       const vec3<Float>& m, const Mask& active) const;

  mi::ref<Texture> eta_, k_, specular_reflectance_;  // a perfect mirror has no eta
};

}  // namespace microfacet::plugin
