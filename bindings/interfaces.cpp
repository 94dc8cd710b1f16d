// Functions without a family: smooth interfaces, and exp.
#include "bindings/loop/ufunc.hpp"
#include "bindings/parts.hpp"
#include "microfacet/bsdf/conductor.hpp"
#include "microfacet/bsdf/fresnel.hpp"

namespace microfacet::bindings {
namespace {

// exp itself through the same loops: what the kernels are measured against.
struct exponential {
  static constexpr const char* name = "exp";
  static constexpr unsigned functions = 0;
  static constexpr layout<1> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    out[0] = elementary::exp(x[0]);
  }
};
struct no_model {
  struct family {
    static constexpr bool float32_arithmetic = true, shape_invariant = false;
    static constexpr unsigned tabulate = 0;
    static constexpr std::array<parameter, 0> parameters{};
  };
  struct tag {
    template <class Lanes>
    struct type {};
  };
  static constexpr std::size_t count = 0, scales = 0, first = 0;
  template <class Lanes>
  static int shape(const double_double<Lanes>*) {
    return 0;
  }
};

// Smooth interfaces.
struct reflectance_of_dielectric {
  static constexpr const char* name = "fresnel_dielectric";
  static constexpr unsigned functions = 0;
  static constexpr layout<2> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    const T c = cosine<T>(x[0]).z;
    out[0] = nan_unless(c == c, fresnel_dielectric(c, x[1]).reflected);
  }
};
struct reflectance_of_conductor {
  static constexpr const char* name = "fresnel_conductor";
  static constexpr unsigned functions = 0;
  static constexpr layout<3> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution&, const T* x, T* out) {
    const T c = cosine<T>(x[0]).z;
    out[0] = nan_unless((c == c) & (x[2] < T(inf)), conductor<T>(x[1], x[2]).reflectance(c));
  }
};

}  // namespace

bool add_interfaces(PyObject* module) {
  return add_all<no_model, false, exponential, reflectance_of_dielectric, reflectance_of_conductor>(module,
                                                                                                    "");
}

}  // namespace microfacet::bindings
