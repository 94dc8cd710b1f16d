// A distribution of normals as a BSDF asks for it, whatever its family; roughness comes with each question,
// since it may be a texture.
#pragma once

#include <mitsuba/core/object.h>
#include <mitsuba/core/properties.h>

#include <array>
#include <string>

#include "drjit_scalar.hpp"
#include "microfacet/core/vec.hpp"
#include "variant.hpp"

namespace microfacet::plugin {

// Along the tangent and across it, in slope units; both turned counter-clockwise by an angle.
struct roughness {
  Float u, v;
  bool isotropic;
  Float cosine = Float(1), sine = Float(0);  // of that angle
};

class distribution : public mitsuba::Object {
 public:
  using vector = vec3<Float>;

  // Density per steradian, projected area on the whole sphere, and a normal that w sees.
  // A normal is known to `resolution`: densities with an infinite peak are cut off there.
  virtual Float D(const roughness& r, const vector& m, const Float& resolution) const = 0;
  virtual Float sigma(const roughness& r, const vector& w) const = 0;
  virtual vector sample_visible(const roughness& r, const vector& w,
                                const std::array<Float, 4>& xi) const = 0;

  // Whether roughness is a stretch of the slopes; otherwise it belongs to the density, which is told of it.
  virtual bool stretches() const { return true; }
  virtual void set_roughness(const Float& /*mean*/, bool /*varies*/) {}
  // Whether a parameter has a gradient.
  virtual bool differentiated() const { return false; }
};

// By `distribution` and the shape parameter of that family; throws in the name of the plugin.
mitsuba::ref<distribution> make_distribution(const mitsuba::Properties& properties);

}  // namespace microfacet::plugin
