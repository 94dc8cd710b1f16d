// Tails of Student's t-density N A^(-k - 1/2), A = 1 + y, y = t^2/k, in units of A^-k, without any branch.
//
// Both are Gauss' series in z = 1/A, all of whose terms are positive (DLMF 8.17.8):
//
//   A^k Pr(slope > t)      = Gamma(k + 1/2)/(2 sqrt(pi) Gamma(k + 1)) sqrt(1 - z) 2F1(1, k + 1/2; k + 1; z)
//   A^k E[(slope - t)_+]   = Gamma(k + 1/2)/(4 sqrt(pi) Gamma(k + 1)) sqrt(k + t^2) 2F1(1, k - 1/2; k + 1;
//   z)/
//                            (k - 1/2)
//
// Ten terms lead from k to K = k + 10, where the rest is its limit for large K, a complementary error
// function (uniformly in t: N. M. Temme, SIAM J. Math. Anal. 13, 1982), and a smooth correction in q = log(A)
// and 1/K (tools/derive_student.py). The quotients of Gamma functions cancel against the denominators of the
// series.
#pragma once

#include "microfacet/core/math.hpp"
#include "microfacet/special/bivariate.hpp"
#include "microfacet/special/coefficients/student.hpp"
#include "microfacet/special/erf.hpp"
#include "microfacet/special/gamma.hpp"

namespace microfacet::student {

// What the two tails share.
template <class T>
struct arguments {
  T k, z, w, q;          // w = 1 - z; beyond the bound of q only the ten terms count
  T kappa, slope, root;  // 1/K, sqrt(q K), sqrt(q/K)

  arguments(const T& k_, const T& y_argument, const T& q_argument) : k(k_) {
    const T least = T(4) * smallest<T>();  // below, halves on the way to q are flushed to zero
    const T y = maximum(y_argument, least);
    z = T(1) / (T(1) + y), w = y * z;
    q = minimum(maximum(q_argument, least), T(q_end));
    kappa = T(1) / (k + T(half_step_shift)), slope = sqrt(q * (k + T(half_step_shift))), root = slope * kappa;
  }
  template <class Table>
  T smooth(const Table& table) const {
    return polynomial(table, T(q - T(0.5 * q_end)), kappa);
  }

 private:
  static constexpr double q_end = by_precision<T>(2.0, 3.75);
};

// From `rest` at K down the ten terms, b_j = (k + order + j)/K; `unit` stands for 1, `product` times the b_j
// for the Gamma functions.
template <class T>
T series(const arguments<T>& a, double order, T unit, T rest, T product) {
  for (int j = half_step_shift - 1; j >= 0; --j) {
    const T b = (a.k + T(order + j)) * a.kappa;
    unit = unit * ((a.k + T(j + 1)) * a.kappa);
    rest = multiply_add(T(a.z * b), rest, unit);
    product = product * b;
  }
  return rest / product;
}

// Pr(slope > t) A^k for k > 0, given y and q = log(1 + y).
template <class T>
T tail(const T& k, const T& y, const T& q) {
  using namespace coefficients;
  const arguments<T> a(k, y, q);
  const T unit = sqrt(a.w * a.kappa) * half_step_of_large(a.kappa) * T(0.5 / sqrt_pi);
  const T correction = a.root * a.smooth(by_precision<T>(student_tail_32, student_tail_64));
  return series(a, 0.5, unit, T(T(0.5) * erfc_scaled(a.slope) + correction), T(1));
}

// E[(slope - t)_+] A^k for k > 1/2.
template <class T>
T excess(const T& k, const T& y, const T& q) {
  using namespace coefficients;
  const arguments<T> a(k, y, q);
  const T unit = a.kappa * half_step_of_large(a.kappa) * T(0.25 / sqrt_pi);
  const T correction = a.kappa * a.smooth(by_precision<T>(student_excess_32, student_excess_64));
  const T last = T(1) - T(0.5) * a.kappa, leading = last * sqrt(a.w / a.q) * ierfc_scaled(a.slope);
  return sqrt(k * (T(1) + y) * a.kappa) * series(a, -0.5, unit, T(T(0.5) * leading + correction), last);
}

}  // namespace microfacet::student
