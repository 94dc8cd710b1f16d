// The quantities that Python sees, as operations on a distribution: name, numbers of inputs and outputs, the
// functions of the density that they need, meaning.
#pragma once

#include "bindings/loop/ufunc.hpp"

namespace microfacet::bindings {

#define MICROFACET_OPERATION(TYPE, NAME, INPUTS, NEEDS, EXPRESSION)                    \
  struct TYPE {                                                                        \
    static constexpr const char* name = NAME;                                          \
    static constexpr unsigned functions = NEEDS;                                       \
    static constexpr layout<INPUTS> shape{};                                           \
    template <class Distribution, class T>                                             \
    MICROFACET_INLINE static void apply(const Distribution& ndf, const T* x, T* out) { \
      out[0] = EXPRESSION;                                                             \
    }                                                                                  \
  };
#define MICROFACET_VECTOR(I) (vec3<T>{x[I], x[I + 1], x[I + 2]})

// Of a cosine, isotropic.
#define MICROFACET_OF_COSINE(NAME, NEEDS)                                              \
  struct NAME##_of_cosine {                                                            \
    static constexpr const char* name = #NAME;                                         \
    static constexpr unsigned functions = NEEDS;                                       \
    static constexpr bool of_cosine = true;                                            \
    static constexpr layout<1> shape{};                                                \
    template <class Distribution, class T>                                             \
    MICROFACET_INLINE static void apply(const Distribution& ndf, const T* x, T* out) { \
      out[0] = ndf.NAME(cosine<T>(x[0]));                                              \
    }                                                                                  \
  };
MICROFACET_OF_COSINE(D, of_P22)
MICROFACET_OF_COSINE(sigma, of_slope_excess)
MICROFACET_OF_COSINE(Lambda, of_slope_excess)
MICROFACET_OF_COSINE(G1, of_slope_excess)
#undef MICROFACET_OF_COSINE

// Of slopes or uniform numbers, isotropic.
MICROFACET_OPERATION(survival_of_slope, "survival", 1, of_survival, survival(ndf, x[0]))
MICROFACET_OPERATION(slope_sample, "sample_slope", 1, of_radius,
                     sample_slope(ndf.family(), ndf.shape(), x[0]))
MICROFACET_OPERATION(cosine_sample, "sample_u", 1, of_radius,
                     cosine_of_slope(sample_slope(ndf.family(), ndf.shape(), x[0])))

// Of slopes, under any shape.
MICROFACET_OPERATION(P22_of_slopes, "P22", 2, of_P22, ndf.P22(x[0], x[1]))
MICROFACET_OPERATION(P2_of_slope, "P2", 1, of_P2, ndf.P2(x[0]))
MICROFACET_OPERATION(cdf_of_slope, "slope_cdf", 1, of_slope_sf, ndf.slope_cdf(x[0]))

// Of directions, under any shape.
MICROFACET_OPERATION(D_of_normal, "D", 3, of_P22, ndf.D(MICROFACET_VECTOR(0)))
MICROFACET_OPERATION(pdf_of_normal, "pdf", 3, of_P22, ndf.pdf(MICROFACET_VECTOR(0)))
MICROFACET_OPERATION(sigma_of_direction, "sigma", 3, of_slope_excess, ndf.sigma(MICROFACET_VECTOR(0)))
MICROFACET_OPERATION(Lambda_of_direction, "Lambda", 3, of_slope_excess, ndf.Lambda(MICROFACET_VECTOR(0)))
MICROFACET_OPERATION(G1_of_direction, "G1", 3, of_slope_excess, ndf.G1(MICROFACET_VECTOR(0)))
MICROFACET_OPERATION(G2_of_directions, "G2", 6, of_slope_excess,
                     ndf.G2(MICROFACET_VECTOR(0), MICROFACET_VECTOR(3)))
MICROFACET_OPERATION(G2_uncorrelated_of_directions, "G2_uncorrelated", 6, of_slope_excess,
                     ndf.G2_uncorrelated(MICROFACET_VECTOR(0), MICROFACET_VECTOR(3)))
MICROFACET_OPERATION(D_visible_of_directions, "D_visible", 6, of_P22 | of_slope_excess,
                     ndf.D_visible(MICROFACET_VECTOR(0), MICROFACET_VECTOR(3)))

#undef MICROFACET_VECTOR
#undef MICROFACET_OPERATION

struct normal_sample {
  static constexpr const char* name = "sample";
  static constexpr unsigned functions = of_radius;
  static constexpr std::size_t uniforms = 2;
  static constexpr layout<2, 3> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution& ndf, const T* x, T* out) {
    const vec3<T> m = sample_normal(ndf, x[0], x[1]);
    out[0] = m.x, out[1] = m.y, out[2] = m.z;
  }
};

// Normals that a direction sees.
#define MICROFACET_VISIBLE(TYPE, NAME, FUNCTION, UNIFORMS, ...)                        \
  struct TYPE {                                                                        \
    static constexpr const char* name = NAME;                                          \
    static constexpr unsigned functions = (of_all & ~of_survival) | of_visible;        \
    static constexpr bool samples_visible = true;                                      \
    static constexpr std::size_t uniforms = UNIFORMS;                                  \
    static constexpr layout<3 + UNIFORMS, 3> shape{};                                  \
    template <class Distribution, class T>                                             \
    MICROFACET_INLINE static void apply(const Distribution& ndf, const T* x, T* out) { \
      const vec3<T> m = FUNCTION(ndf, vec3<T>{x[0], x[1], x[2]}, __VA_ARGS__);         \
      out[0] = m.x, out[1] = m.y, out[2] = m.z;                                        \
    }                                                                                  \
  };
MICROFACET_VISIBLE(direct_visible_sample, "sample_visible", sample_visible, 3, x[3], x[4], x[5])
MICROFACET_VISIBLE(direct_visible_sample_of_mixture, "sample_visible_mixture", sample_visible_mixture, 4,
                   x[3], x[4], x[5], x[6])
MICROFACET_VISIBLE(bounded_sample, "sample_visible_bounded", sample_visible_bounded, 3, x[3], x[4], x[5])
#undef MICROFACET_VISIBLE
struct visible_sample : direct_visible_sample {
  static constexpr bool solves = true;               // unless in closed form
  static constexpr bool samples_from_tables = true;  // in float32
};
struct visible_sample_of_mixture : direct_visible_sample_of_mixture {
  static constexpr bool samples_from_tables = true;
};
struct bounded_pdf {
  static constexpr const char* name = "pdf_visible_bounded";
  static constexpr unsigned functions = of_all;
  static constexpr layout<6> shape{};
  template <class Distribution, class T>
  MICROFACET_INLINE static void apply(const Distribution& ndf, const T* x, T* out) {
    out[0] = pdf_visible_bounded(ndf, vec3<T>{x[0], x[1], x[2]}, vec3<T>{x[3], x[4], x[5]});
  }
};

// Whether Family tells how it draws visible normals, in how many ways.
template <class Family>
concept samples_visible = requires { Family::visible_dimensions; };

// Under one shape for each family: these are long.
template <class Model>
bool add_visible_operations(PyObject* space, const char* prefix) {
  using family = typename Model::family;
  if constexpr (samples_visible<family> && family::shape_invariant == (Model::scales == 2)) {
    if (!add_all<Model, true, visible_sample>(space, prefix)) return false;
    if constexpr (!closed_visible_sampling<family>) {
      if (!add_all<Model, true, visible_sample_of_mixture>(space, prefix)) return false;
    }
    if constexpr (bounded_facet_sampling<family>) {
      if (!add_all<Model, true, bounded_sample, bounded_pdf>(space, prefix)) return false;
    }
  }
  return true;
}

template <class Model>
bool add_direction_operations(PyObject* space, const char* prefix) {
  return add_all<Model, true, D_of_normal, pdf_of_normal, sigma_of_direction, Lambda_of_direction,
                 G1_of_direction, G2_of_directions, G2_uncorrelated_of_directions, D_visible_of_directions,
                 P22_of_slopes, P2_of_slope, cdf_of_slope, normal_sample>(space, prefix) &&
         add_visible_operations<Model>(space, prefix);
}

template <class Tag>
bool add_operations(PyObject* space) {
  using family = typename isotropic_model<Tag>::family;
  if (!add_all<isotropic_model<Tag>, false, D_of_cosine, P22_of_slopes, P2_of_slope, cdf_of_slope,
               sigma_of_cosine, Lambda_of_cosine, G1_of_cosine, survival_of_slope, slope_sample,
               cosine_sample>(space, ""))
    return false;
  // Where a value is costly, what a stretch costs besides is not worth kernels without it.
  if constexpr (!family::shape_invariant) {
    return add_direction_operations<unstretched_model<Tag>>(space, "isotropic_");
  } else {
    if constexpr (family::tabulate == 0) {
      if (!add_direction_operations<isotropic_model<Tag>>(space, "isotropic_")) return false;
    }
    return add_direction_operations<stretched_model<Tag>>(space, "stretched_");
  }
}

}  // namespace microfacet::bindings
