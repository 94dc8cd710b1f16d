// Mueller matrices of a facet, where a variant traces polarised light; templates, so that the others do not
// compile them.
//
// Their first entry is 1: the intensity is that of variants without polarisation, from the same lines.
#pragma once

#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/mueller.h>

#include "rough_bsdf.hpp"

namespace microfacet::plugin {

// Light comes from `from` and goes to `to`, both pointing away from the facet.
struct light_path {
  Vector3 from, to;
  light_path(const mi::BSDFContext& context, const Interaction& si, const Vector3& wo)
      : from(context.mode == mi::TransportMode::Radiance ? wo : si.wi),
        to(context.mode == mi::TransportMode::Radiance ? si.wi : wo) {}
};

// From the axes of the plane of incidence to those of the two directions.
template <class Matrix>
Matrix in_common_axes(const Matrix& matrix, const light_path& path, const Vector3& facet) {
  const Vector3 in = -path.from, out_axis = mi::mueller::stokes_basis(path.to);
  // Across that plane. Light along the normal has none, and any axis will do, if it is the same for both.
  const Vector3 normal = dr::cross(facet, Vector3(path.to - path.from));
  const Float length2 = dr::squared_norm(normal);
  const Vector3 across(dr::select(length2 > 1e-12F, Vector3(normal * dr::rsqrt(length2)), out_axis));
  return mi::mueller::rotate_mueller_basis(matrix, in, across, mi::mueller::stokes_basis(in), path.to, across,
                                           out_axis);
}

// A perfect mirror: the limit of all metals whose k goes to infinity.
template <class Matrix>
Matrix perfect_mirror() {
  Matrix result = dr::zeros<Matrix>();
  for (std::size_t i = 0; i < 4; ++i) result(i, i) = Unpolarized(i < 2 ? 1.F : -1.F);
  return result;
}

// Over the intensity; a perfect mirror where that is no number, or nothing.
template <class Matrix>
Matrix of_unit_intensity(const Matrix& matrix) {
  const Unpolarized intensity = matrix(0, 0);
  const auto usable = (intensity > 0.F) & (intensity < float(inf)) & dr::isfinite(matrix(2, 2));
  const Unpolarized inverse = dr::rcp(Unpolarized(dr::select(usable, intensity, Unpolarized(1.F))));
  Matrix result = perfect_mirror<Matrix>();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      result(i, j) = dr::select(usable, Unpolarized(matrix(i, j) * inverse), result(i, j));
  return result;
}

template <class Matrix>
Matrix polarised_by_conductor(const light_path& path, const Vector3& facet, const Unpolarized& eta,
                              const Unpolarized& k) {
  const Matrix matrix = mi::mueller::specular_reflection(Unpolarized(dr::dot(path.from, facet)),
                                                         dr::Complex<Unpolarized>(eta, k));
  return in_common_axes(of_unit_intensity(matrix), path, facet);
}

template <class Matrix>
Matrix polarised_by_mirror(const light_path& path, const Vector3& facet) {
  return in_common_axes(perfect_mirror<Matrix>(), path, facet);
}

// eta is the index on the side that the facet looks away from over the one on the side that it looks to.
template <class Matrix>
Matrix polarised_by_dielectric(const light_path& path, const Vector3& facet, const Float& eta,
                               const Mask& reflected) {
  const Unpolarized cosine(dr::dot(path.from, facet)), index(eta);
  const Matrix mirrored = mi::mueller::specular_reflection(cosine, index),
               passed = mi::mueller::specular_transmission(cosine, index);
  return in_common_axes(of_unit_intensity(Matrix(dr::select(reflected, mirrored, passed))), path, facet);
}

}  // namespace microfacet::plugin
