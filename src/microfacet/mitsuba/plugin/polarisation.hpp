// Mueller matrices of a facet, where a variant traces polarised light; templates, so that the others do not
// compile them.
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
  const auto across = [&](const Vector3& forward) {
    const Vector3 normal = dr::cross(facet, forward), basis = mi::mueller::stokes_basis(forward);
    const Float length2 = dr::squared_norm(normal);
    return Vector3(dr::select(length2 > 1e-12F, Vector3(normal * dr::rsqrt(length2)), basis));
  };
  const Vector3 in = -path.from;
  return mi::mueller::rotate_mueller_basis(matrix, in, across(in), mi::mueller::stokes_basis(in), path.to,
                                           across(path.to), mi::mueller::stokes_basis(path.to));
}

template <class Matrix>
Matrix polarised_by_conductor(const light_path& path, const Vector3& facet, const Unpolarized& eta,
                              const Unpolarized& k) {
  const Matrix matrix = mi::mueller::specular_reflection(Unpolarized(dr::dot(path.from, facet)),
                                                         dr::Complex<Unpolarized>(eta, k));
  return in_common_axes(matrix, path, facet);
}

// Over the share of light that is reflected, or that passes.
template <class Matrix>
Matrix polarised_by_dielectric(const light_path& path, const Vector3& facet, const Float& eta,
                               const Float& reflected_share, const Mask& reflected) {
  const Unpolarized cosine(dr::dot(path.from, facet)), index(eta);
  const Float rest = maximum(Float(Float(1) - reflected_share), Float(1e-6F));
  const Matrix mirrored = mi::mueller::specular_reflection(cosine, index),
               passed = mi::mueller::specular_transmission(cosine, index);
  const Matrix matrix = dr::select(reflected, mirrored * Unpolarized(Float(1) / reflected_share),
                                   passed * Unpolarized(Float(1) / rest));
  return in_common_axes(matrix, path, facet);
}

}  // namespace microfacet::plugin
