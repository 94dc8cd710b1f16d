// Tails of Student's t-density A(t)^(-k - 1/2), A(t) = 1 + t^2/k, relative to the density itself.
//
// Both are ratios of incomplete Beta functions. For large t they are Gauss' continued fraction of
// 2F1(a, 1; k + 1; -k/t^2), whose partial numerators are positive (DLMF 15.7.5); for small t the series of
// the central part has only positive terms (DLMF 8.17.8). Neither ever subtracts two large numbers.
#pragma once

#include "microfacet/core/math.hpp"

namespace microfacet::student {

// 1/(1 + e1/(1 + e2/(1 + ...))) with e_{2n+1} = (a + n)(k + n) y/((k + 2n)(k + 2n + 1)) and
// e_{2n} = n (k - a + n) y/((k + 2n - 1)(k + 2n)), y = k/t^2: 2F1(a, 1; k + 1; -y).
template <class T>
T tail_fraction(double a, const T& k, const T& t2) {
  constexpr int most = 107;
  const T y = k / t2, pairs = T(17) + T(90) / maximum(t2, T(1));  // as k -> inf, where most are needed
  T rest(1);
  for (int n = most; n >= 0; --n) {
    const auto counts = T(n) <= pairs;
    if (!any(counts)) continue;
    const T k2 = k + T(2 * n);
    T next = T(1) + T(a + n) * (k + T(n)) * y / (k2 * (k2 + T(1))) / rest;
    if (n > 0) next = T(1) + T(n) * (k + T(n - a)) * y / ((k2 - T(1)) * k2) / next;
    rest = select(counts, next, rest);
  }
  return T(1) / rest;
}

// Where the tail's fraction takes over from the central series.
template <class T>
auto in_tail(const T& k, const T& t2) {
  return t2 >= minimum(T(1), T(T(0.5) * k));
}

// int_t^inf A^(-k-1/2) dt / A(t)^(-k-1/2) for t in the tail.
template <class T>
T tail_over_density(const T& k, const T& t) {
  return (k + t * t) / (T(2) * k * t) * tail_fraction(0.5, k, T(t * t));
}

// int_0^t A^(-k-1/2) dt / A(t)^(-k-1/2) = t 2F1(k + 1/2, 1; 3/2; t^2/(k + t^2)) for t in the centre.
template <class T>
T centre_over_density(const T& k, const T& t) {
  const T w = t * t / (k + t * t);
  T term = t, sum = t;
  for (int n = 0; n < 90; ++n) {
    term = term * (w * ((k + T(n + 0.5)) / T(n + 1.5)));
    const T next = sum + term;
    if (!any(next != sum)) break;
    sum = next;
  }
  return sum;
}

// int_t^inf (y - t) A(y)^(-k-1/2) dy / A(t)^(-k-1/2) for t in the tail; k > 1/2.
template <class T>
T excess_over_density(const T& k, const T& t) {
  const T t2 = t * t;
  return square(T((k + t2) / t)) / (T(4) * k * (k - T(0.5))) * tail_fraction(1.5, k, t2);
}

}  // namespace microfacet::student
