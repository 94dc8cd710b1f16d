// What facets send on their way and how much of that leaves the surface, from projected areas: free of
// Lambda, which is infinite along the horizon.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/smith/masking.hpp"

namespace microfacet {

// What the distribution says of a pair of directions on the side of wi: its density at the facet that takes
// one to the other, sigma(wi), and the area sigma(-wo) that is in the way of wo (sigma(wo) for wo below).
template <class T>
struct facet_statistics {
  T D, area, blocking;
};

// A part of a density; nothing of it is nothing, even if it is infinite.
template <class T>
T share(const T& part, const T& density) {
  return select(part == T(0), T(0), T(part * density));
}

// Density per steradian of the directions into which the facets that wi sees mirror it: D_visible/(4 wi . m).
template <class T>
T pdf_of_mirrors(const facet_statistics<T>& at) {
  return T(0.25) * at.D / at.area;
}

// G2(wi, wo)/G1(wi), wi above: 1/(1 + G1(wi) Lambda(wo)) for reflection, wo above; the Beta form for
// transmission, wo below (Heitz 2014). Uncorrelated, G1(wo).
template <bool Transmits, class T>
T shadowing(const T& wi_z, const T& wo_z, const facet_statistics<T>& at, bool correlated) {
  const T up = abs(wo_z);
  const T seen = correlated ? T(wi_z / at.area) : T(1);  // G1(wi)
  const auto reflected = [&] { return T(up / (up + at.blocking * seen + smallest<T>())); };
  if (!Transmits || !correlated) return reflected();
  const auto transmitted = [&] {
    const T most = T(1e30), whole = minimum(T(at.area / wi_z), most);  // 1 + Lambda(wi)
    const T lambda_i = maximum(T(whole - T(1)), T(0));
    return T(whole * G2_correlated(lambda_i, minimum(T(at.blocking / up), most), wo_z == wo_z));
  };
  return select_lazy(wo_z < T(0), transmitted, reflected);
}

}  // namespace microfacet
