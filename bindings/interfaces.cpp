// Functions without a family: smooth interfaces, and exp.
#include "bindings/density/operations.hpp"
#include "bindings/parts.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/fresnel.hpp"

namespace microfacet::bindings {
namespace {

// exp itself through the same loops: what the kernels are measured against.
struct exponential : operation<"exp", 1, 0> {
  MICROFACET_INLINE static auto apply(const auto&, const auto* x) { return elementary::exp(x[0]); }
};
struct no_model {
  struct family {
    static constexpr bool float32_arithmetic = true, shape_invariant = false, tables_alone = false;
    static constexpr unsigned tabulate = 0;
    static constexpr std::array<parameter, 0> parameters{};
  };
  struct tag {
    template <class Lanes>
    struct type {};
  };
  static constexpr std::size_t count = 0, scales = 0, first = 0;
  template <class Lanes>
  static int shape(const double_double<Lanes>*, const double* = nullptr) {
    return 0;
  }
};

// Smooth interfaces.
struct reflectance_of_dielectric : operation<"fresnel_dielectric", 2, 0> {
  template <class T>
  MICROFACET_INLINE static T apply(const auto&, const T* x) {
    const T c = cosine<T>(x[0]).z;
    return nan_unless(c == c, fresnel_dielectric(c, x[1]).reflected);
  }
};
struct reflectance_of_conductor : operation<"fresnel_conductor", 3, 0> {
  template <class T>
  MICROFACET_INLINE static T apply(const auto&, const T* x) {
    const T c = cosine<T>(x[0]).z;
    return nan_unless((c == c) & (x[2] < T(inf)), conductor<T>(x[1], x[2]).reflectance(c));
  }
};

}  // namespace

bool add_interfaces(PyObject* module) {
  return add_all<no_model, false>(
      module, "", operation_list<exponential, reflectance_of_dielectric, reflectance_of_conductor>());
}

}  // namespace microfacet::bindings
