// What both BSDFs have in common: a distribution of normals, its roughness as textures, and how light is
// scattered between facets.
#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/core/random.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/texture.h>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "distribution.hpp"
#include "domain.hpp"
#include "microfacet/bsdf/geometry.hpp"
#include "microfacet/bsdf/masking.hpp"
#include "variant.hpp"

namespace microfacet::plugin {

namespace dr = drjit;
namespace mi = mitsuba;

using Base = mi::BSDF<Float, Spectrum>;
using Interaction = mi::SurfaceInteraction<Float, Spectrum>;
using Sample = mi::BSDFSample3<Float, Spectrum>;
using Mask = dr::mask_t<Float>;
using UInt32 = dr::uint32_array_t<Float>;
using Vector3 = mi::Vector<Float, 3>;
using Point2 = mi::Point<Float, 2>;
using Unpolarized = mi::unpolarized_spectrum_t<Spectrum>;

// Never 0, at which slopes are infinite.
inline Float uniform_of_word(const UInt32& word) {
  return (Float(word >> 9) + Float(0.5F)) * Float(0x1p-23F);
}
inline Float off_zero(const Float& xi) { return maximum(xi, Float(0x1p-26F)); }
inline UInt32 bits_of(const Float& x) { return dr::reinterpret_array<UInt32>(dr::detach(x)); }
inline vec3<Float> local(const Vector3& w) { return {w.x(), w.y(), w.z()}; }
inline Vector3 local(const vec3<Float>& w) { return {w.x, w.y, w.z}; }

// What rounding of wi and wo leaves uncertain of the facet between them.
inline Float resolution_of(const vec3<Float>& wi, const vec3<Float>& m) {
  return dr::detach(Float(1e-7F) / maximum(Float(abs(dot(wi, m))), Float(1e-3F)));
}

// The distribution at a place of the surface, as the assembly of bsdf/scattering_pair.hpp asks for it of
// light from wi.
class normals_at {
 public:
  normals_at(const distribution& normals, const roughness& r, const vec3<Float>& wi)
      : normals_(normals), roughness_(r), wi_(wi) {}
  Float D(const vec3<Float>& m) const {
    const vec3<Float> unit = scaled(m, Float(Float(1) / sqrt(maximum(dot(m, m), smallest<Float>()))));
    return normals_.D(roughness_, unit, resolution_of(wi_, unit));
  }
  Float sigma(const vec3<Float>& w) const { return normals_.sigma(roughness_, w); }

 private:
  const distribution& normals_;
  roughness roughness_;
  vec3<Float> wi_;
};

class rough_bsdf : public Base {
 public:
  void traverse(mi::TraversalCallback* callback) override;
  void parameters_changed(const std::vector<std::string>& keys = {}) override;
  std::string to_string() const override;

  Spectrum eval(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
                Mask active) const override {
    return eval_pdf(context, si, wo, active).first;
  }
  Float pdf(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo,
            Mask active) const override {
    return eval_pdf(context, si, wo, active).second;
  }

 protected:
  explicit rough_bsdf(const mi::Properties& properties);

  template <class... Arguments>
  [[noreturn]] static void fail(const mi::Properties& properties, const char* format,
                                const Arguments&... arguments) {
    throw std::runtime_error(std::string(properties.plugin_name()) + ": " +
                             tfm::format(format, arguments...));
  }

  roughness roughness_at(const Interaction& si, const Mask& active) const;
  // Of light that a facet sends on, the part that leaves, for a pair that was drawn and inverse =
  // 1/sigma(wi).
  template <class Pair>
  Float leaving_share(const normals_at& normals, const Pair& drawn, const Float& inverse) const {
    const Float share = drawn.leaving_side({Float(0), inverse, sigma_out(normals, drawn.wo())}, correlated_);
    return select(share > Float(0), share, Float(0));
  }
  // A normal that wi sees, from the two uniform numbers of a sample and more that are made of their bits.
  vec3<Float> visible(const roughness& r, const vec3<Float>& wi, const Point2& sample) const;
  // Walks cannot be differentiated: throws an error that says so, rather than leaving their part out.
  template <class... Values>
  void reject_gradients(const roughness& r, const Values&... values) const {
    if (differentiated(r) || (dr::grad_enabled(values) || ...))
      throw std::runtime_error(
          plugin_ + ": scattering = multiple cannot be differentiated; use single, or detach the parameters");
  }
  static Spectrum depolarised(const Unpolarized& value) { return mi::depolarizer<Spectrum>(Spectrum(value)); }
  // Whether the value of a sample has to be differentiated.
  bool differentiated(const roughness& r) const;

  std::string plugin_;
  mi::ref<distribution> distribution_;
  mi::ref<Texture> alpha_u_, alpha_v_, rotation_;  // no rotation is none
  bool correlated_ = true, multiple_ = false;

 private:
  void take_roughness();

  MI_TRAVERSE_CB(Base, distribution_, alpha_u_, alpha_v_, rotation_)
};

}  // namespace microfacet::plugin
