#include "domain.hpp"

#include <mitsuba/render/interaction.h>

#include <algorithm>
#include <stdexcept>

namespace microfacet::plugin {

namespace dr = drjit;
namespace mi = mitsuba;

namespace {

using Interaction = mi::SurfaceInteraction<Float, Spectrum>;

bool inside(float x, const domain& d) {
  return (d.with_lower ? x >= d.lower : x > d.lower) && (d.with_upper ? x <= d.upper : x < d.upper);
}

constexpr int packets = 8;  // of four wavelengths each, among those that a spectrum covers

}  // namespace

void check(const std::string& plugin, const char* name, const Float& values, const domain& allowed) {
  if constexpr (dr::is_jit_v<Float>) {
    if (jit_flag(JitFlag::FreezingScope)) return;  // a function that is being frozen may read no values
  }
  for (std::size_t lane = 0; lane < dr::width(values); ++lane) {
    const float x = number(values, lane);
    if (!inside(x, allowed))
      throw std::runtime_error(
          tfm::format("%s: \"%s\" is %g, %s lies in %s", plugin, name, x, allowed.what, allowed.interval));
  }
}

void check_number(const std::string& plugin, const char* name, const Texture* texture,
                  const domain& allowed) {
  if (texture && !texture->is_spatially_varying())
    check(plugin, name, texture->eval_1(dr::zeros<Interaction>(), true), allowed);
}

void check_spectrum(const std::string& plugin, const char* name, const Texture* texture,
                    const domain& allowed) {
  if (!texture || texture->is_spatially_varying()) return;
  Interaction si = dr::zeros<Interaction>();
  const auto check_at = [&] {
    const auto values = texture->eval(si, true);
    for (std::size_t k = 0; k < values.size(); ++k) check(plugin, name, values[k], allowed);
  };
  if constexpr (mi::is_spectral_v<mi::unpolarized_spectrum_t<Spectrum>>) {
    const auto range = texture->wavelength_range();
    const float first = std::max(float(range.x()), float(MI_CIE_MIN)),
                step = (std::min(float(range.y()), float(MI_CIE_MAX)) - first) / (4 * packets);
    const auto check_of = [&](const Float& packet) {
      for (std::size_t k = 0; k < 4; ++k)
        si.wavelengths[k] = Float(first) + (packet * Float(4) + Float(float(k) + 0.5F)) * Float(step);
      check_at();
    };
    if constexpr (dr::is_jit_v<Float>) {
      check_of(dr::arange<Float>(packets));
    } else {
      for (int packet = 0; packet < packets; ++packet) check_of(Float(packet));
    }
  } else {
    check_at();
  }
}

}  // namespace microfacet::plugin
