// Double GGX: GGX whose inverse squared roughness s is exponentially distributed, as that of Beckmann is in GGX itself.
//
//   P22(r2)         = mean s/(1 + s r2)^2/pi                      mean f = int_0^inf exp(-s) f(s) ds
//   survival(r2)    = mean 1/(1 + s r2)
//   P2(t)           = mean sqrt(s)/(1 + s t^2)^(3/2)/2
//   slope_sf(t)     = mean 1/(q (q + t sqrt(s)))/2,  q^2 = 1 + s t^2
//   mean_excess(x) = mean 1/(sqrt(s) (q + x sqrt(s)))/2
//
// Beyond 4 they are, with w = 1/r2 and e^w E_1(w), or z = 1/(2 t^2) and e^z K_0(z), e^z K_1(z):
//
//   P22 = w^2 ((1 + w) e^w E_1 - 1)/pi           P2       = z/t e^z ((1 + 2z) K_0 - 2z K_1)
//   survival = w e^w E_1                         slope_sf = (1 - z e^z (K_1 - K_0))/2
//                                                mean_excess = t (z e^z (K_0 + K_1) - 1)/2
//
// The mean square slope is infinite. d'Eon's notebook "Double GGX NDF".
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <string_view>

#include "microfacet/approx/exponential_mean.hpp"
#include "microfacet/approx/iterate.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/polynomial.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/special/exponential_integral.hpp"

namespace microfacet {

namespace detail {

// Series of K_0(z) and 1 - z K_1(z) in q = z^2/4 (DLMF 10.31), for z at most 1/32: each is a part times
// -log(z/2) - gamma, and a rest.
struct double_ggx_series {
  std::array<double, 5> k0_log{}, k0_rest{}, k1_log{}, k1_rest{};

  constexpr double_ggx_series() {
    double factorial = 1, harmonic = 0;
    for (std::size_t k = 0; k < k0_log.size(); ++k) {
      const double n = static_cast<double>(k);
      if (k > 0) factorial *= n, harmonic += 1 / n;
      const double square = 1 / (factorial * factorial), next = square / (n + 1);
      k0_log[k] = square, k0_rest[k] = harmonic * square;
      k1_log[k] = 2 * next, k1_rest[k] = (2 * harmonic + 1 / (n + 1)) * next;
    }
  }
};

// e^z K_0(z) and e^z (1 - z K_1(z))/z of a slope t above 4, z = 1/(2 t^2), and expm1(z)/z: all are positive.
template <class T>
struct double_ggx_tail {
  T inverse, z, e, k0, less_k1, rise;

  explicit double_ggx_tail(const T& t) : inverse(T(1) / t), z(T(0.5) * inverse * inverse), e(exp(z)) {
    static constexpr double_ggx_series c;
    const T q = T(0.25) * z * z,
            L = T(2 * std::numbers::ln2 - std::numbers::egamma) + T(2) * log(minimum(t, largest<T>()));
    k0 = e * multiply_add(L, polynomial(c.k0_log, q), polynomial(c.k0_rest, q));
    less_k1 = e * T(0.25) * z * multiply_add(L, polynomial(c.k1_log, q), polynomial(c.k1_rest, q));
    rise = expm1_over(z);
  }
};

}  // namespace detail

template <class T>
class double_ggx : public radial_defaults<T, 0, of_all> {
 public:
  static constexpr std::string_view name = "double_ggx";
  static constexpr std::array<std::string_view, 1> sources{"deon2020hitchhiker"};
  static constexpr bool tables_alone = true, slow_tails = true;

  T P22(const double_double<T>& r2) const { return D(T(1), r2); }
  // With w = z^2/h2, in the logarithms of which z = 0 is the smallest number.
  T D(const T& z, const double_double<T>& h2_argument) const {
    const T h2 = minimum(h2_argument.high, largest<T>());
    return select_lazy(
        h2 <= T(16) * z * z,
        [&] {
          return T(T(1 / pi) * exponential_mean<T>([&](const T& s) {
                     return T(s / square(T(multiply_add(z, z, T(s * h2)))));
                   }));
        },
        [&] {
          const T height = maximum(h2, smallest<T>()), w = minimum(T(z * (z / height)), T(1.0 / 16));
          const T log_w = T(2) * log(maximum(z, smallest<T>())) - log(height);
          const T above = (T(1) + w) * exp(w) * exponential_integral::e1_near(log_w, w) - T(1);
          return T(rounded(T(above * T(1 / pi) / height)) / height);
        });
  }
  T survival(const double_double<T>& r2) const {
    const T y = r2.high;
    return select_lazy(
        y <= T(16),
        [&] {
          return minimum(exponential_mean<T>([&](const T& s) { return T(T(1) / (T(1) + s * y)); }), T(1));
        },
        [&] { return beyond(T(maximum(y, T(16)))); });
  }
  // Newton's method for L = log r2 on log((1 - survival)/survival) against L, which is nearly a line.
  T radius2(const T& xi) const {
    const T rest = T(1) - xi, odds = maximum(T(xi / rest), smallest<T>()),
            target = log(minimum(odds, largest<T>()));
    const T L = iterate(40, target, target == target, [&](const T& now) {
      const T y = exp(now), above = survival(y), below = within(y, above);
      const T slope = T(pi) * y * P22(y);
      const T next = now + (target - log(below / above)) * below * above / slope;
      return iteration{next, abs(next - now) > T(single ? 1e-4 : 1e-9)};
    });
    // The digits are those of the odds.
    const T y = exp(L), above = survival(y);
    const T found =
        odds * select(y < T(1), T(above / (within(y, above) / y)), T(above * y / within(y, above)));
    return select(xi == T(0), T(0), select(xi == T(1), infinite<T>(), found));
  }
  T P2(const slope<T>& t_argument) const {
    const T t = abs(t_argument.value.high);
    return select_lazy(
        t <= T(4),
        [&] {
          return T(T(0.5) * exponential_mean<T>([&](const T& s) {
                     const T q2 = T(1) + s * t * t;
                     return T(sqrt(s / q2) / q2);
                   }));
        },
        [&] {
          const tail at(maximum(t, T(4)));
          const T sum = (T(1) + T(2) * at.z) * at.k0 + T(2) * at.z * at.less_k1 - T(2) * at.e;
          return T((T(0.5) * at.inverse * sum) * at.inverse * at.inverse);
        });
  }
  T slope_sf(const slope<T>& t_argument) const {
    return symmetric_sf(t_argument, [](const slope<T>& x) {
      const T t = x.value.high;
      return select_lazy(
          t <= T(4),
          [&] {
            const T twice = exponential_mean<T>([&](const T& s) {
              const T q2 = T(1) + s * t * t, q = sqrt(q2);
              return T(T(1) / (q2 + q * t * sqrt(s)));
            });
            return T(T(0.5) * minimum(twice, T(1)));
          },
          [&] {
            const tail at(maximum(t, T(4)));
            return T(T(0.25) * at.inverse * (at.k0 + at.less_k1 - at.rise) * at.inverse);
          });
    });
  }
  T mean_excess(const slope<T>& x) const {
    const T t = x.value.high;
    return select_lazy(
        t <= T(4),
        [&] {
          return T(T(0.5) * exponential_mean<T>(
                                [&](const T& s) { return T(T(1) / (sqrt(s + square(T(s * t))) + s * t)); }));
        },
        [&] {
          const tail at(maximum(t, T(4)));
          return T(T(0.25) * at.inverse * (at.k0 - at.less_k1 + at.rise));
        });
  }

 private:
  using tail = detail::double_ggx_tail<T>;
  static constexpr bool single = sizeof(typename scalar_traits<T>::real) == 4;

  // survival for y of 16 and more
  static T beyond(const T& y) {
    const T w = T(1) / y;
    return w * exp(w) * exponential_integral::e1_near(T(-log(minimum(y, largest<T>()))), w);
  }
  // 1 - survival
  static T within(const T& y_argument, const T& above) {
    const T y = minimum(y_argument, largest<T>());
    return select_lazy(
        y <= T(16),
        [&] { return T(y * exponential_mean<T>([&](const T& s) { return T(s / (T(1) + s * y)); })); },
        [&] { return T(T(1) - above); });
  }
};

static_assert(radial_family<double_ggx<float>> && radial_family<double_ggx<double>>);

}  // namespace microfacet
