// The variable of the tables: how far log x lies from a centre, with digits that log x itself has not.
#pragma once

#include <cstddef>
#include <type_traits>

#include "microfacet/core/elementary.hpp"
#include "microfacet/core/math.hpp"

namespace microfacet {

// sum_k c(k) x^k in two chains, for up to 10 terms, or four: what is wanted soon is no long chain.
template <std::size_t N, class Coefficients, class R>
MICROFACET_INLINE R interleaved(const Coefficients& c, const R& x) {
  constexpr std::size_t chains = N > 10 ? 4 : 2;
  const R x2 = x * x, step = chains == 4 ? R(x2 * x2) : x2;
  const auto chain = [&](std::size_t first) {
    std::size_t k = first + (N - 1 - first) / chains * chains;
    R sum = c(k);
    while (k >= chains) k -= chains, sum = multiply_add(sum, step, c(k));
    return sum;
  };
  const R low = multiply_add(chain(1), x, chain(0));
  if constexpr (chains == 2) return low;
  return multiply_add(R(multiply_add(chain(chains - 1), x, chain(chains - 2))), x2, low);
}

// Times log(x + low) - centre, for x = 2^n (1 + e) positive and normal, and a centre with so few digits that
// n ln2_high - centre is exact.
template <int Times, class R, class Low>
MICROFACET_INLINE R log_ratio(const R& x, const Low& low, const R& centre) {
  using f = elementary::format<R>;
  using integers = elementary::integers<R>;
  using real = typename scalar_traits<R>::real;
  using elementary::bits;
  using elementary::from_bits;
  if constexpr (!elementary::has_lanes<R>) {
    // Of the quotient, since a difference of logarithms would lose digits; of its root, which stays within the format.
    return R(2 * Times) * log(sqrt(x) * exp(R(R(-0.5 / Times) * centre)));
  } else if constexpr (sizeof(real) == 4) {
    // log(1 + e) = e + e^2 (e Q(e) - 1/2), without the division, for which a float32 is too short.
    using elementary::wrapping_difference;
    using elementary::wrapping_sum;
    const integers shifted = wrapping_difference(integers(bits(x)), integers(f::sqrt_half));
    const integers exponent = shifted & integers(~((integer_of<real>(1) << f::mantissa) - 1));
    const R power = from_bits(wrapping_difference(integers(elementary::bits(real(1))), exponent), x);
    const R shifted_n = from_bits(
        wrapping_sum(integers(shifted >> f::mantissa), integers(elementary::bits(real(f::round)))), x);
    const R n = rounded(R(shifted_n - R(f::round)));
    R e = rounded(R(from_bits(wrapping_difference(integers(bits(x)), exponent), x) - R(1)));
    if constexpr (!std::is_same_v<Low, absent>) e = multiply_add(low, power, e);
    const auto q = [](std::size_t k) { return R(coefficients::log_polynomial_32[k]); };
    const R bend = multiply_add(interleaved<coefficients::log_polynomial_32.size()>(q, e), e, R(-0.5));
    const R rest = multiply_add(R(e * e), bend, R(R(f::ln2_low) * n));
    const R sum = multiply_add(R(R(Times) * n), R(f::ln2_high), R(-centre)) + R(Times) * e;
    return rounded(sum) + R(Times) * rest;
  } else {
    const elementary::reduced_logarithm<R> l = elementary::reduce_log(x, low);
    const R rest = multiply_add(l.n, R(-f::ln2_low), l.less), n = R(Times) * l.n;
    return rounded(R(multiply_add(n, R(f::ln2_high), R(-centre)) + R(Times) * l.e)) - R(Times) * rest;
  }
}

}  // namespace microfacet
