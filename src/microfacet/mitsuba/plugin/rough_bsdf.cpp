#include "rough_bsdf.hpp"

#include <sstream>

namespace microfacet::plugin {

namespace {

constexpr float least_roughness = 1e-4F;  // smaller ones are no longer rough to single precision

}  // namespace

rough_bsdf::rough_bsdf(const mi::Properties& properties)
    : Base(properties), plugin_(properties.plugin_name()) {
  distribution_ = make_distribution(properties);
  const bool u = properties.has_property("alpha_u"), v = properties.has_property("alpha_v");
  if (u != v)
    fail(properties, "\"%s\" is missing: alpha_u and alpha_v go together", u ? "alpha_v" : "alpha_u");
  if (u && properties.has_property("alpha"))
    fail(properties, "\"alpha\" is given beside alpha_u and alpha_v: it is one or the other");
  if (u && !distribution_->stretches())
    fail(properties, "\"alpha_u\" is given, but this distribution is isotropic: it takes alpha");
  alpha_u_ = properties.get_texture<Texture>(u ? "alpha_u" : "alpha", 0.1F);
  alpha_v_ = u ? properties.get_texture<Texture>("alpha_v") : alpha_u_;
  if (properties.has_property("rotation")) {
    if (!distribution_->stretches())
      fail(properties, "\"rotation\" is given, but this distribution is isotropic");
    rotation_ = properties.get_unbounded_texture<Texture>("rotation");
  }
  correlated_ = properties.get<bool>("correlated", true);
  const auto scattering = properties.get<std::string>("scattering", std::string("single"));
  if (scattering != "single" && scattering != "multiple")
    fail(properties, "\"scattering\" is \"%s\", which is neither single nor multiple", scattering);
  multiple_ = scattering == "multiple";
  if (multiple_ && !correlated_)
    fail(properties, "\"correlated\" is false, but walks of scattering = multiple correlate heights");
  take_roughness();
}

void rough_bsdf::take_roughness() {
  if (alpha_u_ == alpha_v_) {
    check_number(plugin_, "alpha", alpha_u_.get(), roughnesses);
  } else {
    check_number(plugin_, "alpha_u", alpha_u_.get(), roughnesses);
    check_number(plugin_, "alpha_v", alpha_v_.get(), roughnesses);
  }
  check_number(plugin_, "rotation", rotation_.get(), angles);
  if (!distribution_->stretches())
    distribution_->set_roughness(alpha_u_->mean(), alpha_u_->is_spatially_varying());
}

void rough_bsdf::traverse(mi::TraversalCallback* callback) {
  if (alpha_u_ == alpha_v_) {
    callback->put("alpha", alpha_u_, mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous);
  } else {
    callback->put("alpha_u", alpha_u_, mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous);
    callback->put("alpha_v", alpha_v_, mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous);
  }
  if (rotation_)
    callback->put("rotation", rotation_, mi::ParamFlags::Differentiable | mi::ParamFlags::Discontinuous);
  distribution_->traverse(callback);
}

void rough_bsdf::parameters_changed(const std::vector<std::string>& keys) {
  take_roughness();
  if (distribution_->stretches()) distribution_->parameters_changed(keys);
}

std::string rough_bsdf::to_string() const {
  std::ostringstream text;
  text << class_name() << "[\n  distribution = " << distribution_->to_string()
       << ",\n  alpha_u = " << mi::string::indent(alpha_u_)
       << ",\n  alpha_v = " << mi::string::indent(alpha_v_);
  if (rotation_) text << ",\n  rotation = " << mi::string::indent(rotation_);
  text << ",\n  correlated = " << correlated_ << ",\n  scattering = " << (multiple_ ? "multiple" : "single")
       << "\n]";
  return text.str();
}

roughness rough_bsdf::roughness_at(const Interaction& si, const Mask& active) const {
  const auto at = [&](const mi::ref<Texture>& alpha) {
    return bounded(Float(alpha->eval_1(si, active)), least_roughness, roughnesses.upper);
  };
  const Float u = at(alpha_u_);
  if (alpha_u_ == alpha_v_) return {u, u, true};
  if (!rotation_) return {u, at(alpha_v_), false};
  const auto [sine, cosine] =
      dr::sincos(bounded(Float(rotation_->eval_1(si, active)), angles.lower, angles.upper));
  return {u, at(alpha_v_), false, cosine, sine};
}

vec3<Float> rough_bsdf::visible(const roughness& r, const vec3<Float>& wi, const Point2& sample) const {
  const auto [a, b] = mi::sample_tea_32<UInt32>(bits_of(sample.x()), bits_of(sample.y()), 6);
  const std::array<Float, 4> xi{off_zero(sample.x()), off_zero(sample.y()), uniform_of_word(a),
                                uniform_of_word(b)};
  const roughness fixed{dr::detach(r.u), dr::detach(r.v), r.isotropic, dr::detach(r.cosine),
                        dr::detach(r.sine)};
  const vec3<Float> m = distribution_->sample_visible(fixed, wi, xi);
  return {dr::detach(m.x), dr::detach(m.y), dr::detach(m.z)};
}

bool rough_bsdf::differentiated(const roughness& r) const {
  return dr::grad_enabled(r.u, r.v, r.cosine) || distribution_->differentiated();
}

}  // namespace microfacet::plugin
