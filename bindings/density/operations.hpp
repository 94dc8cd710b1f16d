// The quantities that Python sees, as operations on a distribution, and the ufuncs of a model that are made of them.
#pragma once

#include <string>

#include "bindings/density/kernels.hpp"
#include "bindings/loop/numpy.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"

namespace microfacet::bindings {

// Of a cosine, isotropic.
template <name_of_operation Name, unsigned Functions>
struct cosine_operation : operation<Name, 1, Functions> {
  static constexpr bool of_cosine = true;
};
struct D_of_cosine : cosine_operation<"D", of_P22> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.D(cosine(x[0])); }
};
struct sigma_of_cosine : cosine_operation<"sigma", of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.sigma(cosine(x[0])); }
};
struct Lambda_of_cosine : cosine_operation<"Lambda", of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.Lambda(cosine(x[0])); }
};
struct G1_of_cosine : cosine_operation<"G1", of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.G1(cosine(x[0])); }
};

// Of slopes or uniform numbers, isotropic.
struct survival_of_slope : operation<"survival", 1, of_survival> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return survival(ndf, x[0]); }
};
struct slope_sample : operation<"sample_slope", 1, of_radius> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return sample_slope(ndf.family(), ndf.shape(), x[0]);
  }
};
struct cosine_sample : operation<"sample_u", 1, of_radius> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return cosine_of_slope(slope_sample::apply(ndf, x));
  }
};

// Of slopes, under any shape.
struct P22_of_slopes : operation<"P22", 2, of_P22> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.P22(x[0], x[1]); }
};
struct P2_of_slope : operation<"P2", 1, of_P2> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.P2(x[0]); }
};
struct cdf_of_slope : operation<"slope_cdf", 1, of_slope_sf> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.slope_cdf(x[0]); }
};

// Of directions, under any shape.
template <class T>
MICROFACET_INLINE vec3<T> direction(const T* x) {
  return {x[0], x[1], x[2]};
}
struct D_of_normal : operation<"D", 3, of_P22> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.D(direction(x)); }
};
struct pdf_of_normal : operation<"pdf", 3, of_P22> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.pdf(direction(x)); }
};
struct sigma_of_direction : operation<"sigma", 3, of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.sigma(direction(x)); }
};
struct Lambda_of_direction : operation<"Lambda", 3, of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.Lambda(direction(x)); }
};
struct G1_of_direction : operation<"G1", 3, of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) { return ndf.G1(direction(x)); }
};
struct G2_of_directions : operation<"G2", 6, of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return ndf.G2(direction(x), direction(x + 3));
  }
};
struct G2_uncorrelated_of_directions : operation<"G2_uncorrelated", 6, of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return ndf.G2_uncorrelated(direction(x), direction(x + 3));
  }
};
struct D_visible_of_directions : operation<"D_visible", 6, of_P22 | of_mean_excess> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return ndf.D_visible(direction(x), direction(x + 3));
  }
};

// Normals, drawn from uniform numbers: all, and those that a direction sees.
struct normal_sample : operation<"sample", 2, of_radius, 3> {
  static constexpr std::size_t uniforms = 2;
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return sample_normal(ndf, x[0], x[1]);
  }
};
template <name_of_operation Name, std::size_t Uniforms>
struct visible_operation : operation<Name, 3 + Uniforms, (of_all & ~of_survival) | of_visible, 3> {
  static constexpr std::size_t uniforms = Uniforms;
  static constexpr bool samples_visible = true;
};
struct visible_sample : visible_operation<"sample_visible", 3> {
  static constexpr bool solves = true, samples_from_tables = true;
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return microfacet::sample_visible(ndf, direction(x), x[3], x[4], x[5]);
  }
};
struct visible_sample_of_mixture : visible_operation<"sample_visible_mixture", 4> {
  static constexpr bool samples_from_tables = true;
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return sample_visible_mixture(ndf, direction(x), x[3], x[4], x[5], x[6]);
  }
};
struct bounded_sample : visible_operation<"sample_visible_bounded", 3> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return sample_visible_bounded(ndf, direction(x), x[3], x[4], x[5]);
  }
};
struct bounded_pdf : operation<"pdf_visible_bounded", 6, of_all> {
  MICROFACET_INLINE static auto apply(const auto& ndf, const auto* x) {
    return pdf_visible_bounded(ndf, direction(x), direction(x + 3));
  }
};

template <class... Operation>
struct operation_list {};
using isotropic_operations =
    operation_list<D_of_cosine, P22_of_slopes, P2_of_slope, cdf_of_slope, sigma_of_cosine, Lambda_of_cosine,
                   G1_of_cosine, survival_of_slope, slope_sample, cosine_sample>;
using direction_operations =
    operation_list<D_of_normal, pdf_of_normal, sigma_of_direction, Lambda_of_direction, G1_of_direction,
                   G2_of_directions, G2_uncorrelated_of_directions, D_visible_of_directions, P22_of_slopes,
                   P2_of_slope, cdf_of_slope, normal_sample>;

// The product of a model and an operation is a ufunc with float32 and float64 loops.
template <class Model, bool WideParameters, class... Operation>
bool add_all(PyObject* space, const std::string& prefix, operation_list<Operation...>) {
  return (add_ufunc(space, prefix + Operation::name, Operation::name,
                    kernels_of_operation<Model, Operation, WideParameters>.plan,
                    &kernels_of_operation<Model, Operation, WideParameters>,
                    {&guarded<&density_loop<float>>, &guarded<&density_loop<double>>}) &&
          ...);
}

// Whether Family tells how it draws visible normals, in how many ways.
template <class Family>
concept samples_visible = requires { Family::visible_dimensions; };

// Under one shape for each family: these are long.
template <class Model>
bool add_visible_operations(PyObject* space, const char* prefix) {
  using family = typename Model::family;
  if constexpr (samples_visible<family> && family::shape_invariant == (Model::scales == 2)) {
    if (!add_all<Model, true>(space, prefix, operation_list<visible_sample>())) return false;
    if constexpr (!closed_visible_sampling<family>) {
      if (!add_all<Model, true>(space, prefix, operation_list<visible_sample_of_mixture>())) return false;
    }
    if constexpr (bounded_facet_sampling<family>) {
      return add_all<Model, true>(space, prefix, operation_list<bounded_sample, bounded_pdf>());
    }
  }
  return true;
}

template <class Model>
bool add_direction_operations(PyObject* space, const char* prefix) {
  return add_all<Model, true>(space, prefix, direction_operations()) &&
         add_visible_operations<Model>(space, prefix);
}

template <class Tag>
bool add_operations(PyObject* space) {
  using family = typename isotropic_model<Tag>::family;
  if (!add_all<isotropic_model<Tag>, false>(space, "", isotropic_operations())) return false;
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
