// The BSDF microfacet_dielectric.
#pragma once

#include "microfacet/bsdf/dielectric.hpp"
#include "rough_bsdf.hpp"

namespace microfacet::plugin {

class rough_dielectric final : public rough_bsdf {
 public:
  MI_DECLARE_CLASS(rough_dielectric)

  explicit rough_dielectric(const mi::Properties& properties);
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
  // Which of its two components a context wants.
  struct components {
    bool reflection, transmission;
    explicit components(const mi::BSDFContext& context)
        : reflection(context.is_enabled(mi::BSDFFlags::GlossyReflection, 0)),
          transmission(context.is_enabled(mi::BSDFFlags::GlossyTransmission, 1)) {}
    bool both() const { return reflection && transmission; }
  };
  // A pair of directions in coordinates in which wi is above; the facet between them is asked.
  struct meeting {
    vec3<Float> wi, wo;
    dielectric<Float> material;
    Float turned;
    meeting(const rough_dielectric& of, const vec3<Float>& wi, const vec3<Float>& wo);
  };

  // The density of directions drawn, and what a direction keeps of it on its way out.
  Float density(const meeting& at, const vec3<Float>& m, const facet_statistics<Float>& facets,
                const components& wanted) const;
  Float leaving(const mi::BSDFContext& context, const meeting& at,
                const facet_statistics<Float>& facets) const;
  // What depends on wavelength, as a Mueller matrix where light is polarised, over Fresnel's share.
  Spectrum tint(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo, const meeting& at,
                const vec3<Float>& m, const Mask& active) const;

  Float eta_ = Float(1);  // below the surface over above
  mi::ref<Texture> specular_reflectance_, specular_transmittance_;
};

}  // namespace microfacet::plugin
