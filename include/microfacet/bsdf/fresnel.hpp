// Fresnel's equations for unpolarised light, at a smooth interface. eta is the index of refraction below the
// surface over the one above it; a conductor has eta - i k. What depends on these alone is computed once for
// many angles.
#pragma once

#include "microfacet/core/exact_sums.hpp"
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

// Takes the cosine to the normal, >= 0, on the side where light comes from. Gives nan unless eta > 0.
//
// Close to the critical angle and close to eta = 1 the equations take differences of what is almost equal:
// eta^2 - 1 is kept in two numbers, and c - root written as its square over the sum. All but the cosines is
// homogeneous in (eta, 1): both are scaled down where eta is huge.
template <class T>
class dielectric_interface {
 public:
  explicit dielectric_interface(const T& eta)
      : given_(nan_unless((eta > T(0)) & (eta <= largest<T>()), eta)),
        one_(scale_of_index(given_)),
        index_(given_ * one_),
        eta2_minus_1_(sum_of_products<T>(index_, index_).plus(-one_, one_)) {}

  fresnel_split<T> operator()(const T& cosine) const {
    const T c = minimum(abs(cosine), T(1)), near_c = c * one_;
    const T inside = eta2_minus_1_.plus(near_c, near_c).value();
    const T root = sqrt(maximum(inside, T(0)));  // eta cos behind the interface
    const T e = eta2_minus_1_.value(), square_eta = index_ * index_, floor = smallest<T>();
    const T per_s = T(1) / (square(T(near_c + root)) + floor),
            per_p = T(1) / (square_eta * c + one_ * root + floor);
    const T s = e * per_s, near_1 = e * (square_eta * c * c - (T(1) - c) * (T(1) + c)) * per_p;
    const T difference = select((index_ > T(0.5)) & (index_ < T(2)), near_1, T(square_eta * c - one_ * root));
    const T p = difference * per_p;
    // Along the surface nothing passes.
    const auto passes = (inside > T(0)) & (c > T(0));
    const T reflected = select(passes, T(T(0.5) * (s * s + p * p)), T(T(1) + T(0) * index_));
    const T both = T(2) * near_c * root;  // 1 - s^2 and 1 - p^2, by the products of what s and p are sums of
    const T passed = both * per_s + square_eta * both * per_p * per_p;
    return {minimum(reflected, T(1)), select(passes, minimum(passed, T(1)), T(T(0) * index_)),
            select(inside > T(0), T(root / index_), T(0))};
  }

 private:
  T given_, one_, index_;
  sum_of_products<T> eta2_minus_1_;
};

template <class T>
fresnel_split<T> fresnel_dielectric(const T& cosine, const T& eta) {
  return dielectric_interface<T>(eta)(cosine);
}

// The reflectance; nan unless eta > 0 and k >= 0. Born and Wolf, Principles of Optics, section 14.4.1, with
// n^2 - sin^2 = (a - i b)^2, n = eta - i k; the reflectance of s is |n^2 - 1|^2/|c + a - i b|^4. Scaled as
// above. All is one fraction, of which a = an/ad, so that there is one division.
template <class T>
class metal_interface {
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

 public:
  metal_interface(const T& eta, const T& k)
      : one_(scale_of_index(maximum(valid(eta, eta > T(0)), valid(k, k >= T(0))))) {
    // A smaller eta makes no difference.
    const T n = maximum(valid(eta, eta > T(0)), T(single ? 0x1p-30 : 0x1p-60)) * one_,
            absorbed = valid(k, k >= T(0)) * one_;
    n2_minus_1_ = sum_of_products<T>(n, n).plus(-absorbed, absorbed).plus(-one_, one_);
    twice_ = T(2) * n * absorbed, twice2_ = twice_ * twice_;
    numerator_ = square(n2_minus_1_.value()) + twice2_;
  }

  T operator()(const T& cosine) const {
    const T cosine_1 = minimum(abs(cosine), T(1)), c = cosine_1 * one_, c2 = c * c;
    const T difference = n2_minus_1_.plus(c, c).value();
    const T sum = sqrt(multiply_add(difference, difference, twice2_));  // a^2 + b^2
    const T larger = sqrt(multiply_add(T(0.5), T(sum + abs(difference)), smallest<T>()));
    // The smaller of a and b by their product, which does not cancel.
    const auto a_is_larger = difference >= T(0);
    const T an = select(a_is_larger, T(larger + larger), twice_), ad = select(a_is_larger, T(1), larger);
    const T lift(0x1p20);  // what is small at grazing incidence is squared
    const T anc = an * cosine_1, ad_lift = ad * lift;
    const T to_s = multiply_add(T(sum + c2), ad_lift, T(anc * one_ * lift));
    const T across = multiply_add(T(-cosine_1), cosine_1, T(1)) * one_;
    const T even = multiply_add(T(sum * cosine_1), cosine_1, T(across * across)) * ad,
            all = multiply_add(anc, across, even);  // of p over that of s: (2 even - all)/all
    const T above = numerator_ * (square(ad_lift) * even);
    return minimum(T(above / multiply_add(T(to_s * to_s), all, smallest<T>())), T(1));
  }

 private:
  template <class Mask>
  static T valid(const T& index, const Mask& lower) {
    return nan_unless(lower & (index <= largest<T>()), index);
  }

  T one_, twice_ = T(0), twice2_ = T(0), numerator_ = T(0);
  sum_of_products<T> n2_minus_1_{T(0), T(0)};
};

template <class T>
T fresnel_conductor(const T& cosine, const T& eta, const T& k) {
  return metal_interface<T>(eta, k)(cosine);
}

}  // namespace microfacet
