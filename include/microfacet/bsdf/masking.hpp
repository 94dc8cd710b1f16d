// What facets send on their way and how much of that leaves the surface, from projected areas rather than
// Lambda, which is infinite along the horizon.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/core/vec.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/smith/masking.hpp"

namespace microfacet {

// What the distribution says of a pair of directions on the side of wi: its density at the facet that takes
// one to the other, 1/sigma(wi), and the area sigma(-wo) in the way of wo (sigma(wo) for wo below).
template <class T>
struct facet_statistics {
  T D, inverse_sigma;
  fraction<T> sigma_out;
};

// sigma(w) as a fraction, so that what is made of it divides once.
template <class Distribution, class T>
fraction<T> sigma_fraction(const Distribution& ndf, const vec3<T>& w) {
  if constexpr (requires { ndf.family(); }) {
    const fraction<T> below = sigma_below(ndf.family(), w.z, ndf.shape().stretch2(w));
    return {multiply_add(maximum(w.z, T(0)), below.denominator, lowered(below.numerator)), below.denominator};
  } else {
    return {ndf.sigma(w), T(1)};
  }
}
template <class Distribution, class T>
T inverse_sigma(const Distribution& ndf, const vec3<T>& wi) {
  const fraction<T> sigma = sigma_fraction(ndf, wi);
  return sigma.denominator / sigma.numerator;
}
template <class Distribution, class T>
fraction<T> sigma_out(const Distribution& ndf, const vec3<T>& wo) {
  const T away = select(wo.z > T(0), T(-1), T(1));
  return sigma_fraction(ndf, vec3<T>{wo.x * away, wo.y * away, wo.z * away});
}

template <class Distribution, class T>
facet_statistics<T> statistics_of(const Distribution& ndf, const vec3<T>& wi, const vec3<T>& wo,
                                  const vec3<T>& m) {
  return {ndf.D(m), inverse_sigma(ndf, wi), sigma_out(ndf, wo)};
}

// A part of a density; nothing of it is nothing, even if it is infinite.
template <class T>
T share(const T& part, const T& density) {
  return select(part == T(0), T(0), T(part * density));
}

// Density per steradian of the directions into which the facets that wi sees mirror it: D_visible/(4 wi . m).
template <class T>
T pdf_of_mirrors(const T& D, const T& inverse_sigma) {
  return T(0.25) * D * inverse_sigma;
}

// G2(wi, wo)/G1(wi), wi above: 1/(1 + G1(wi) Lambda(wo)) for reflection, wo above; the Beta form for
// transmission, wo below (Heitz 2014). Uncorrelated, G1(wo).
template <bool Transmits, class T>
T shadowing(const T& wi_z, const T& wo_z, const facet_statistics<T>& at, bool correlated) {
  const T up = abs(wo_z), G1 = wi_z * at.inverse_sigma, seen = correlated ? G1 : T(1);
  const auto reflected = [&] {
    const T free = up * at.sigma_out.denominator;
    return T(free / (multiply_add(at.sigma_out.numerator, seen, free) + smallest<T>()));
  };
  if (!Transmits || !correlated) return reflected();
  const auto transmitted = [&] {
    const T most = T(1e30), whole = minimum(T(T(1) / G1), most);  // 1 + Lambda(wi)
    const T lambda_i = maximum(T(whole - T(1)), T(0));
    const T lambda_o = minimum(T(at.sigma_out.numerator / (up * at.sigma_out.denominator)), most);
    return T(whole * G2_correlated(lambda_i, lambda_o, wo_z == wo_z));
  };
  return select_lazy(wo_z < T(0), transmitted, reflected);
}

}  // namespace microfacet
