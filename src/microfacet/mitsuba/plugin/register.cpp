// The one function that the shared library exports.
#include <mitsuba/core/plugin.h>

#include <exception>
#include <string>

#include "conductor.hpp"
#include "dielectric.hpp"
#include "variant.hpp"

namespace microfacet::plugin {

namespace {

template <class Plugin>
void add() {
  const auto make = [](void*, const mi::Properties& properties) -> mitsuba::ref<mitsuba::Object> {
    return new Plugin(properties);
  };
  mi::PluginManager::instance()->register_plugin(Plugin::name, Base::Variant, mi::ObjectType::BSDF, make,
                                                 nullptr, nullptr);
}

}  // namespace

}  // namespace microfacet::plugin

extern "C" [[gnu::visibility("default")]] const char* microfacet_register() {
  static std::string error;
  try {
    microfacet::plugin::add<microfacet::plugin::rough_conductor>();
    microfacet::plugin::add<microfacet::plugin::rough_dielectric>();
    return nullptr;
  } catch (const std::exception& e) {
    error = e.what();
    return error.c_str();
  }
}
