// The BSDF microfacet_conductor.
#pragma once

#include "albedo.hpp"
#include "microfacet/bsdf/scattering_pair.hpp"
#include "rough_bsdf.hpp"
#include "walk.hpp"

namespace microfacet::plugin {

// Facets at a place of the surface.
class conductor_facets {
 public:
  conductor_facets(const distribution& normals, const roughness& r) : normals_(normals), roughness_(r) {}

  Unpolarized reflectance(const Float& cosine) const;
  facet_event scatter(const vec3<Float>& back, const vec3<Float>& m, const Mask& below,
                      const Float& xi) const;
  Unpolarized phase(const vec3<Float>& back, const vec3<Float>& side, const Mask& below,
                    const Float& sigma) const;

  Unpolarized eta, k, tint = Unpolarized(1.F);
  bool mirror = true;

 private:
  const distribution& normals_;
  roughness roughness_;
};

class rough_conductor final : public rough_bsdf {
 public:
  static constexpr const char* name = "microfacet_conductor";
  std::string_view class_name() const override { return name; }

  explicit rough_conductor(const mi::Properties& properties);
  void traverse(mi::TraversalCallback* callback) override;
  void parameters_changed(const std::vector<std::string>& keys = {}) override;

  std::pair<Sample, Spectrum> sample(const mi::BSDFContext& context, const Interaction& si, Float sample1,
                                     const Point2& sample2, Mask active) const override;
  std::pair<Spectrum, Float> eval_pdf(const mi::BSDFContext& context, const Interaction& si,
                                      const Vector3& wo, Mask active) const override;
  Spectrum eval_diffuse_reflectance(const Interaction& si, Mask active) const override;

 private:
  void check_parameters() const;
  conductor_facets facets_at(const Interaction& si, const roughness& r, const Mask& active) const;
  // The density by which directions are weighed beside other strategies: not that of the walk, which has no
  // closed form, but one of like shape.
  static Float proposal_pdf(const Float& wo_z, const Float& first_order);
  // Light that a facet reflects, as a Mueller matrix where light is polarised.
  static Spectrum polarised(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                            const vec3<Float>& m, const conductor_facets& facets, const Unpolarized& value);

  mi::ref<Texture> eta_, k_, specular_reflectance_;  // a perfect mirror has no eta
  bool tabulated_ = false;                           // by Mitsuba, where some tables have zeros

  MI_TRAVERSE_CB(rough_bsdf, eta_, k_, specular_reflectance_)
};

}  // namespace microfacet::plugin
