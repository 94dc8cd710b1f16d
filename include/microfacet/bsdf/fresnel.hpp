// Fresnel's equations for unpolarised light, at a smooth interface. eta is the index of refraction below the
// surface over the one above it; a conductor has eta - i k.
#pragma once

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// What is reflected and what passes, each to full relative accuracy, and the cosine of the transmitted
// direction to the other side of the normal; 0 beyond the critical angle, where all is reflected.
template <class T>
struct fresnel_split {
  T reflected, passed, cosine;
};

// Scales an index of refraction down so that powers of it stay numbers: 1 but for huge ones.
template <class T>
T scale_of_index(const T& index) {
  const T most(0x1p9);
  return select_lazy(
      index > most, [&] { return select(index > most, T(most / index), T(1)); }, [] { return T(1); });
}

// At cosine >= 0 to the normal, on the side where light comes from. nan unless eta > 0.
//
// Close to the critical angle and close to eta = 1 the equations take differences of what is almost equal:
// eta^2 - 1 is kept in two numbers, and c - root written as its square over the sum. All but the cosines is
// homogeneous in (eta, 1): both are scaled down where eta is huge.
template <class T>
fresnel_split<T> fresnel_dielectric(const T& cosine, const T& eta) {
  const T c = minimum(abs(cosine), T(1)), given = nan_unless((eta > T(0)) & (eta <= largest<T>()), eta);
  const T one = scale_of_index(given), index = given * one, near_c = c * one;
  const auto eta2_minus_1 = sum_of_products<T>(index, index).plus(-one, one);
  const T inside = eta2_minus_1.plus(near_c, near_c).value(), root = sqrt(maximum(inside, T(0)));  // eta cos behind the interface
  const T e = eta2_minus_1.value(), square_eta = index * index, floor = smallest<T>();
  const T per_s = T(1) / (square(T(near_c + root)) + floor), per_p = T(1) / (square_eta * c + one * root + floor);
  const T s = e * per_s, near_1 = e * (square_eta * c * c - (T(1) - c) * (T(1) + c)) * per_p;
  const T difference = select((index > T(0.5)) & (index < T(2)), near_1, T(square_eta * c - one * root));
  const T p = difference * per_p;
  // Along the surface nothing passes.
  const auto passes = (inside > T(0)) & (c > T(0));
  const T reflected = select(passes, T(T(0.5) * (s * s + p * p)), T(T(1) + T(0) * index));
  const T both = T(2) * near_c * root;  // 1 - s^2 and 1 - p^2, by the products of what s and p are sums of
  const T passed = both * per_s + square_eta * both * per_p * per_p;
  return {minimum(reflected, T(1)), select(passes, minimum(passed, T(1)), T(T(0) * index)),
          select(inside > T(0), T(root / index), T(0))};
}

// Gives nan unless eta > 0 and k >= 0. Born and Wolf, Principles of Optics, section 14.4.1, with
// n^2 - sin^2 = (a - i b)^2, n = eta - i k; the reflectance of s is |n^2 - 1|^2/|c + a - i b|^4. Scaled as in
// fresnel_dielectric. All is one fraction, of which a = an/ad, so that there is one division.
template <class T>
T fresnel_conductor(const T& cosine, const T& eta_argument, const T& k_argument) {
  const T given_eta = nan_unless((eta_argument > T(0)) & (eta_argument <= largest<T>()), eta_argument);
  const T given_k = nan_unless((k_argument >= T(0)) & (k_argument <= largest<T>()), k_argument);
  const T one = scale_of_index(maximum(given_eta, given_k)), k = given_k * one;
  constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;
  const T eta = maximum(given_eta, T(single ? 0x1p-30 : 0x1p-60)) * one;  // less makes no difference
  const T cosine_1 = minimum(abs(cosine), T(1)), c = cosine_1 * one;
  const auto eta2_minus_1 = sum_of_products<T>(eta, eta).plus(-k, k).plus(-one, one);
  const T difference = eta2_minus_1.plus(c, c).value(), e = eta2_minus_1.value(), twice = T(2) * eta * k;
  const T sum = sqrt(difference * difference + twice * twice);  // a^2 + b^2
  const T larger = sqrt(T(0.5) * (sum + abs(difference)) + smallest<T>());
  // The smaller of a and b by their product, which does not cancel.
  const auto a_is_larger = difference >= T(0);
  const T an = select(a_is_larger, larger, T(T(0.5) * twice)), ad = select(a_is_larger, T(1), larger);
  const T lift(0x1p20);  // what is small at grazing incidence is squared
  const T to_s = ((sum + c * c) * ad + T(2) * an * c) * lift;
  const T across = (T(1) - cosine_1) * (T(1) + cosine_1) * one;
  const T even = (sum * square(cosine_1) + square(across)) * ad,
          odd = T(2) * an * cosine_1 * across;  // of p over that of s: (even - odd)/(even + odd)
  const T above = (e * e + twice * twice) * (square(T(ad * lift)) * even);
  return minimum(T(above / (square(to_s) * (even + odd) + smallest<T>())), T(1));
}

}  // namespace microfacet
