// The BSDF microfacet_dielectric.
#pragma once

#include "albedo.hpp"
#include "microfacet/bsdf/scattering_pair.hpp"
#include "rough_bsdf.hpp"
#include "walk.hpp"

namespace microfacet::plugin {

// Facets at a place of the surface, seen from the side where light comes from.
class dielectric_facets {
 public:
  dielectric_facets(const distribution& normals, const roughness& r, const dielectric<Float>& material)
      : normals_(normals), roughness_(r), material_(material) {}

  facet_event scatter(const vec3<Float>& back, const vec3<Float>& m, const Mask& below,
                      const Float& xi) const;
  Unpolarized phase(const vec3<Float>& back, const vec3<Float>& side, const Mask& below,
                    const Float& sigma) const;
  Unpolarized tint(const Mask& passed) const { return dr::select(passed, passed_tint, mirrored_tint); }

  Unpolarized mirrored_tint = Unpolarized(1.F), passed_tint = Unpolarized(1.F);

 private:
  const distribution& normals_;
  roughness roughness_;
  dielectric<Float> material_;
};

class rough_dielectric final : public rough_bsdf {
 public:
  static constexpr const char* name = "microfacet_dielectric";
  std::string_view class_name() const override { return name; }

  explicit rough_dielectric(const mi::Properties& properties);
  void traverse(mi::TraversalCallback* callback) override;
  void parameters_changed(const std::vector<std::string>& keys = {}) override;

  std::pair<Sample, Spectrum> sample(const mi::BSDFContext& context, const Interaction& si, Float sample1,
                                     const Point2& sample2, Mask active) const override;
  std::pair<Spectrum, Float> eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                      const Vector3& wo, Mask active) const override;
  Spectrum eval_diffuse_reflectance(const Interaction& si, Mask active) const override;

 private:
  void check_parameters() const;
  // Which of its two components a context wants.
  struct components {
    bool reflection, transmission;
    explicit components(const mi::BSDFContext& context)
        : reflection(context.is_enabled(mi::BSDFFlags::GlossyReflection, 0)),
          transmission(context.is_enabled(mi::BSDFFlags::GlossyTransmission, 1)) {}
    bool both() const { return reflection && transmission; }
  };
  using local_pair = scattering_pair<dielectric<Float>, Float>;

  // The density of directions drawn, where perhaps one component alone is wanted.
  static Float density(const local_pair& at, const half_vector<Float>& m,
                       const facet_statistics<Float>& facets, const components& wanted);
  dielectric_facets facets_at(const Interaction& si, const roughness& r, const local_pair& at,
                              const Mask& active) const;
  // As rough_conductor's.
  static Float proposal_pdf(const Float& wo_z, const Float& first_order);
  std::pair<Sample, Spectrum> walk(const mi::BSDFContext& context, const Interaction& si,
                                   const Float& sample1, const Point2& sample2, const Mask& active) const;
  // Light that a facet sends to wo, as a Mueller matrix where light is polarised.
  Spectrum polarised(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                     const local_pair& at, const vec3<Float>& m, const Unpolarized& value) const;

  Float eta_ = Float(1);  // below the surface over above
  mi::ref<Texture> specular_reflectance_, specular_transmittance_;

  MI_TRAVERSE_CB(rough_bsdf, eta_, specular_reflectance_, specular_transmittance_)
};

}  // namespace microfacet::plugin
