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

// By how much an index of refraction is scaled down so that its fourth power is a number: 1 but for huge
// ones.
template <class T>
T scale_of_index(const T& largest) {
  const T most(0x1p24);
  return select(largest > most, T(most / largest), T(1));
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
  const double_double<T> excess = two_prod(index, index) + -two_prod(one, one),
                         sum = excess + two_prod(near_c, near_c);
  const T inside = sum.high + sum.low, root = sqrt(maximum(inside, T(0)));  // eta cos behind the interface
  const T e = excess.high + excess.low, square_eta = index * index, floor = smallest<T>();
  const T sum_s = near_c + root, sum_p = square_eta * c + one * root + floor;
  const T s = e / (square(sum_s) + floor);
  const T near_1 = e * (square_eta * c * c - (T(1) - c) * (T(1) + c)) / sum_p;
  const T difference = select((index > T(0.5)) & (index < T(2)), near_1, T(square_eta * c - one * root));
  const T p = difference / sum_p;
  // Along the surface nothing passes.
  const auto passes = (inside > T(0)) & (c > T(0));
  const T reflected = select(passes, T(T(0.5) * (s * s + p * p)), T(T(1) + T(0) * index));
  const T both = T(2) * near_c * root;  // 1 - s^2 and 1 - p^2, by the products of what s and p are sums of
  const T passed = both / (square(sum_s) + floor) + square_eta * both / (square(sum_p) + floor);
  return {minimum(reflected, T(1)), select(passes, minimum(passed, T(1)), T(T(0) * index)),
          select(inside > T(0), T(root / index), T(0))};
}

// nan unless eta > 0 and k >= 0. Born and Wolf, Principles of Optics, section 14.4.1, with
// n^2 - sin^2 = (a - i b)^2, n = eta - i k; the reflectance of s is |n^2 - 1|^2/|c + a - i b|^4. Scaled as in
// fresnel_dielectric.
template <class T>
T fresnel_conductor(const T& cosine, const T& eta_argument, const T& k_argument) {
  const T given_eta = nan_unless((eta_argument > T(0)) & (eta_argument <= largest<T>()), eta_argument);
  const T given_k = nan_unless((k_argument >= T(0)) & (k_argument <= largest<T>()), k_argument);
  const T one = scale_of_index(maximum(given_eta, given_k)), eta = given_eta * one, k = given_k * one;
  const T cosine_1 = minimum(abs(cosine), T(1)), c = cosine_1 * one, c2 = c * c;
  const T s2 = (T(1) - cosine_1) * (T(1) + cosine_1);
  const double_double<T> excess = two_prod(eta, eta) + -two_prod(k, k) + -two_prod(one, one);
  const double_double<T> inside = excess + two_prod(c, c);
  const T difference = inside.high + inside.low, e = excess.high + excess.low, twice = T(2) * eta * k;
  const T sum = sqrt(difference * difference + twice * twice);  // a^2 + b^2
  const T larger = T(0.5) * (sum + abs(difference)) + smallest<T>();
  // The smaller of a^2 and b^2 by their product, which does not cancel.
  const T a = sqrt(select(difference > T(0), larger, T(T(0.25) * twice * twice / larger)));
  const T to_s = sum + c2 + T(2) * a * c;
  const T across = s2 * one, even = sum * square(cosine_1) + square(across),
          odd = T(2) * a * cosine_1 * across;  // of p over that of s: (even - odd)/(even + odd)
  // At normal incidence both are one.
  const T floor = smallest<T>(), mean = (even + floor) / (even + odd + floor);
  const T reflected = (e * e + twice * twice) / (to_s * to_s + floor) * mean;
  return minimum(reflected, T(1));
}

}  // namespace microfacet
