// The one function that the shared library exports.
#include <mitsuba/core/plugin.h>

#include <exception>
#include <stdexcept>
#include <string>

#include "conductor.hpp"
#include "dielectric.hpp"
#include "variant.hpp"

namespace microfacet::plugin {

namespace {

// Mitsuba asks this variant, whichever is set, of what kind the plugin of a name is, and takes it for an
// unknown one where the variant has none of that name.
constexpr const char* variant_of_kinds = "scalar_rgb";

template <class Plugin>
mitsuba::ref<mitsuba::Object> absent(void*, const mi::Properties&) {
  throw std::runtime_error(std::string(Plugin::name) + " is not registered for " + variant_of_kinds);
}

template <class Plugin>
void add() {
  const auto make = [](void*, const mi::Properties& properties) -> mitsuba::ref<mitsuba::Object> {
    return new Plugin(properties);
  };
  mi::PluginManager* const manager = mi::PluginManager::instance();
  manager->register_plugin(Plugin::name, Base::Variant, mi::ObjectType::BSDF, make, nullptr, nullptr);
  if (manager->plugin_type(Plugin::name) == mi::ObjectType::Unknown)
    manager->register_plugin(Plugin::name, variant_of_kinds, mi::ObjectType::BSDF, absent<Plugin>, nullptr,
                             nullptr);
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
