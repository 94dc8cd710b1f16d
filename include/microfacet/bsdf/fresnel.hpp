// Fresnel's equations for unpolarised light, at a smooth interface. eta is the index of refraction below the
// surface over the one above it; a conductor has eta - i k.
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet {

// What is reflected, and the cosine of the transmitted direction to the other side of the normal; 0 beyond
// the critical angle, where all is reflected.
template <class T>
struct fresnel_split {
  T reflected, cosine;
};

// At cosine >= 0 to the normal, on the side where light comes from. nan unless eta > 0.
template <class T>
fresnel_split<T> fresnel_dielectric(const T& cosine, const T& eta) {
  const T c = minimum(abs(cosine), T(1)), index = where((eta > T(0)) & (eta < T(inf)), eta);
  // eta^2 - sin^2, without a difference of numbers close to 1: exactly c^2 for eta = 1.
  const T inside = (index - T(1)) * (index + T(1)) + c * c;
  const T root = sqrt(maximum(inside, T(0)));  // eta cos of the transmitted direction
  const T s = (c - root) / (c + root + smallest<T>());
  const T square_eta = index * index;
  const T p = (square_eta * c - root) / (square_eta * c + root + smallest<T>());
  const auto passes = inside > T(0);
  // Along the surface nothing passes.
  const T reflected = select(passes & (c > T(0)), T(T(0.5) * (s * s + p * p)), T(T(1) + T(0) * index));
  return {reflected, select(passes, T(root / index), T(0))};
}

// nan unless eta > 0 and k >= 0. Born and Wolf, Principles of Optics, section 14.4.1, with
// (eta - i k)^2 - sin^2 = (a - i b)^2.
template <class T>
T fresnel_conductor(const T& cosine, const T& eta_argument, const T& k_argument) {
  const T c = minimum(abs(cosine), T(1)), c2 = c * c, s2 = (T(1) - c) * (T(1) + c);
  const T eta = where((eta_argument > T(0)) & (eta_argument < T(inf)), eta_argument);
  const T k = where((k_argument >= T(0)) & (k_argument < T(inf)), k_argument);
  const T difference = (eta - k) * (eta + k) - s2, twice = T(2) * eta * k;
  const T sum = sqrt(difference * difference + twice * twice);  // a^2 + b^2
  const T larger = T(0.5) * (sum + abs(difference)) + smallest<T>();
  // The smaller of a^2 and b^2 by their product, which does not cancel.
  const T a = sqrt(select(difference > T(0), larger, T(T(0.25) * twice * twice / larger)));
  const T twice_a_c = T(2) * a * c;
  const T of_s = maximum(T((sum + c2) - twice_a_c), T(0)), to_s = (sum + c2) + twice_a_c;
  const T even = sum * c2 + s2 * s2, odd = twice_a_c * s2;  // of p over that of s: (even - odd)/(even + odd)
  return of_s * even / (to_s * (even + odd) + smallest<T>());
}

}  // namespace microfacet
