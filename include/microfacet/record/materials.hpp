// Materials of one event as graphs: f |cos wo|, the density of directions drawn by visible normals, and these directions.
#pragma once

#include <array>
#include <string>
#include <type_traits>

#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/dielectric.hpp"
#include "microfacet/bsdf/scattering_pair.hpp"
#include "microfacet/bsdf/schlick.hpp"
#include "microfacet/record/request.hpp"
#include "microfacet/smith/visible/sample_visible.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"

namespace microfacet::record::detail {

// A normal that w sees, and how many uniforms it takes: xi.x to xi.w.
template <class Real, class Distribution>
vec3<number<Real>> visible_normal(const recorder<Real>& r, const Distribution& ndf,
                                  const vec3<number<Real>>& w, bool mixture) {
  using T = number<Real>;
  using family = std::remove_cvref_t<decltype(ndf.family())>;
  const int count = mixture ? family::mixture_dimensions : family::visible_dimensions;
  std::array<T, 4> xi;
  for (int i = 0; i < count; ++i) xi[static_cast<std::size_t>(i)] = r.input(std::string("xi.") + "xyzw"[i]);
  return mixture ? sample_visible_mixture(ndf, w, xi[0], xi[1], xi[2], xi[3])
                 : sample_visible(ndf, w, xi[0], xi[1], xi[2]);
}

// A material of one event. Each channel asks the same pair of directions; what it shares is recorded once.
template <class Real, class Distribution, class Make>
bool record_of_material(const recorder<Real>& r, const Distribution& ndf, const std::string& event,
                        const Make& material) {
  using T = number<Real>;
  using Material = decltype(material(0));
  using pairs = scattering_pair<Material, T>;
  const request& asked = r.asked();
  const vec3<T> given = r.direction("wi"), turned{-given.x, -given.y, given.z};
  const vec3<T> wi = asked.retroreflective ? turned : given;
  const auto channel = [&](const std::string& name, int c) {
    return asked.channels == 1 ? name : name + "." + "xyz"[c];
  };
  // All events take the same parameters, whether they look at them or not.
  for (int c = 1; c < asked.channels; ++c) (void)material(c);
  if (event == "pdf") return r.give("value", pairs(material(0), wi, r.direction("wo")).pdf(ndf)), true;
  if (event == "eval") {
    const vec3<T> wo = r.direction("wo");
    for (int c = 0; c < asked.channels; ++c)
      r.give(channel("value", c), pairs(material(c), wi, wo).eval(ndf, true, true));
    return true;
  }
  if (event != "sample") return false;
  const T choice = Material::uniforms > 0 ? r.input("choice") : T(0);
  const vec3<T> m = visible_normal(r, ndf, pairs(material(0), wi, wi).wi(), asked.mixture);
  const pairs drawn = pairs(material(0), wi, wi).drawn(m, choice);
  const vec3<T> wo = drawn.turned(drawn.wo());
  for (int c = 0; c < asked.channels; ++c) {
    const auto found = pairs(material(c), wi, wo).result(ndf, drawn.passed(), true, true);
    if (c == 0) r.give("wo", found.wo);
    r.give(channel("weight", c), found.weight);
    if (c == asked.channels - 1) r.give("pdf", found.pdf);
  }
  return true;
}

template <class Real, class Distribution>
bool record_of_materials(const recorder<Real>& r, const Distribution& ndf) {
  using T = number<Real>;
  const std::string& q = r.asked().quantity;
  const std::size_t bar = q.rfind('_');
  if (bar == std::string::npos) return false;
  const std::string material = q.substr(0, bar), event = q.substr(bar + 1);
  const auto of_channel = [&](const std::string& name, int c) {
    return r.parameter(r.asked().channels == 1 ? name : name + "." + "xyz"[c]);
  };
  if (material == "conductor")
    return record_of_material(r, ndf, event,
                              [&](int c) { return conductor<T>(of_channel("eta", c), of_channel("k", c)); });
  if (material == "schlick")
    return record_of_material(r, ndf, event,
                              [&](int c) { return schlick_conductor<T>(of_channel("f0", c)); });
  if (material == "dielectric")
    return record_of_material(r, ndf, event, [&](int) { return dielectric<T>(r.parameter("eta")); });
  return false;
}

}  // namespace microfacet::record::detail
