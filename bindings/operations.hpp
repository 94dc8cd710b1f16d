// The quantities that Python sees, as operations on a distribution: name, shapes of values and result,
// meaning.
#pragma once

#include <array>
#include <cmath>

#include "ufunc.hpp"

namespace microfacet::bindings {

inline constexpr layout<1> scalar{{0}, 0};
inline constexpr layout<2> two_scalars{{0, 0}, 0};
inline constexpr layout<1> direction{{3}, 0};
inline constexpr layout<2> two_directions{{3, 3}, 0};

// A direction of cosine u in [-1, 1] in the plane y = 0; (1 - u)(1 + u) keeps the sine of grazing normals.
inline vec3<double> at_cosine(double u) {
  const double valid = std::abs(u) <= 1.0 ? u : nan<double>();
  return {std::sqrt((1.0 - valid) * (1.0 + valid)), 0.0, valid};
}
inline vec3<double> vector(const double* x) { return {x[0], x[1], x[2]}; }

#define MICROFACET_OPERATION(TYPE, NAME, ATTRIBUTE, LAYOUT, EXPRESSION)        \
  struct TYPE {                                                                \
    static constexpr const char* name = NAME;                                  \
    static constexpr const char* attribute = ATTRIBUTE;                        \
    static constexpr auto shape = LAYOUT;                                      \
    template <class Distribution>                                              \
    static void apply(const Distribution& ndf, const double* x, double* out) { \
      out[0] = EXPRESSION;                                                     \
    }                                                                          \
  };

// Elementwise, isotropic.
MICROFACET_OPERATION(D_of_cosine, "D", "D", scalar, ndf.D(at_cosine(x[0])))
MICROFACET_OPERATION(P22_of_slopes, "P22", "P22", two_scalars, ndf.P22(x[0], x[1]))
MICROFACET_OPERATION(P2_of_slope, "P2", "P2", scalar, ndf.P2(x[0]))
MICROFACET_OPERATION(cdf_of_slope, "slope_cdf", "slope_cdf", scalar, ndf.slope_cdf(x[0]))
MICROFACET_OPERATION(sigma_of_cosine, "sigma", "sigma", scalar, ndf.sigma(at_cosine(x[0])))
MICROFACET_OPERATION(Lambda_of_cosine, "Lambda", "Lambda", scalar, ndf.Lambda(at_cosine(x[0])))
MICROFACET_OPERATION(G1_of_cosine, "G1", "G1", scalar, ndf.G1(at_cosine(x[0])))
MICROFACET_OPERATION(survival_of_slope, "survival", "survival", scalar,
                     x[0] < 0.0 ? nan<double>() : ndf.family().survival(ndf.shape().slope2(x[0], 0.0)))
MICROFACET_OPERATION(slope_sample, "sample_slope", "sample_slope", scalar,
                     sample_slope(ndf.family(), ndf.shape(), x[0]))
MICROFACET_OPERATION(cosine_sample, "sample_u", "sample_u", scalar,
                     cosine_of_slope(sample_slope(ndf.family(), ndf.shape(), x[0])))

// Of directions and slopes, anisotropic where the family allows it.
MICROFACET_OPERATION(D_of_normal, "D", "direction_D", direction, ndf.D(vector(x)))
MICROFACET_OPERATION(pdf_of_normal, "pdf", "direction_pdf", direction, ndf.pdf(vector(x)))
MICROFACET_OPERATION(sigma_of_direction, "sigma", "direction_sigma", direction, ndf.sigma(vector(x)))
MICROFACET_OPERATION(Lambda_of_direction, "Lambda", "direction_Lambda", direction, ndf.Lambda(vector(x)))
MICROFACET_OPERATION(G1_of_direction, "G1", "direction_G1", direction, ndf.G1(vector(x)))
MICROFACET_OPERATION(G2_of_directions, "G2", "direction_G2", two_directions, ndf.G2(vector(x), vector(x + 3)))
MICROFACET_OPERATION(G2_uncorrelated_of_directions, "G2_uncorrelated", "direction_G2_uncorrelated",
                     two_directions, ndf.G2_uncorrelated(vector(x), vector(x + 3)))
MICROFACET_OPERATION(D_visible_of_directions, "D_visible", "direction_D_visible", two_directions,
                     ndf.D_visible(vector(x), vector(x + 3)))
MICROFACET_OPERATION(P22_of_stretched_slopes, "P22", "direction_P22", two_scalars, ndf.P22(x[0], x[1]))
MICROFACET_OPERATION(P2_of_stretched_slope, "P2", "direction_P2", scalar, ndf.P2(x[0]))
MICROFACET_OPERATION(cdf_of_stretched_slope, "slope_cdf", "direction_slope_cdf", scalar, ndf.slope_cdf(x[0]))

#undef MICROFACET_OPERATION

struct normal_sample {
  static constexpr const char* name = "sample";
  static constexpr const char* attribute = "direction_sample";
  static constexpr layout<1> shape{{2}, 3};
  template <class Distribution>
  static void apply(const Distribution& ndf, const double* x, double* out) {
    const vec3<double> m = sample_normal(ndf, x[0], x[1]);
    out[0] = m.x, out[1] = m.y, out[2] = m.z;
  }
};

template <class Family>
bool add_operations(PyObject* space) {
  return add_all<isotropic_model<Family>, false, D_of_cosine, P22_of_slopes, P2_of_slope, cdf_of_slope,
                 sigma_of_cosine, Lambda_of_cosine, G1_of_cosine, survival_of_slope, slope_sample,
                 cosine_sample>(space) &&
         add_all<direction_model<Family>, true, D_of_normal, pdf_of_normal, sigma_of_direction,
                 Lambda_of_direction, G1_of_direction, G2_of_directions, G2_uncorrelated_of_directions,
                 D_visible_of_directions, P22_of_stretched_slopes, P2_of_stretched_slope,
                 cdf_of_stretched_slope, normal_sample>(space);
}

}  // namespace microfacet::bindings
