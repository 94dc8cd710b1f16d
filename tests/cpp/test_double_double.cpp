// Numbers with the digits that an exponent needs: the error-free transforms are exact, the rest keeps twice the
// digits in float and those of one number in double, with and without an instruction that rounds a * b + c once.

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/logarithms.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "check.hpp"
#include "packs.hpp"

namespace {

namespace mf = microfacet;
using mf::double_double;

// Random numbers of either sign whose exponents are spread over `octaves`.
template <class T>
class numbers {
 public:
  T next(int octaves) {
    const double mantissa = 1 + static_cast<double>(bits_() >> 11) * 0x1p-53;
    const T size =
        static_cast<T>(std::ldexp(mantissa, static_cast<int>(bits_() % static_cast<unsigned>(octaves))));
    return bits_() % 2 == 0 ? size : -size;
  }

 private:
  std::mt19937_64 bits_{11};
};

// A number of up to 113 bits as an integer in units of 2^-54.
__extension__ typedef __int128 wide;
template <class T>
wide exactly(T x) {
  return static_cast<wide>(std::ldexp(x, 54));
}
template <class T>
long double value(const double_double<T>& x) {
  return static_cast<long double>(x.high) + static_cast<long double>(low_of(x));
}

// Four roundings of a sum of two floats, one of a double.
template <class T>
constexpr double tight = mf::one_number<T> ? 0x1p-53 : 4 * 0x1p-46;
template <class T>
double error(const double_double<T>& got, long double want) {
  return static_cast<double>(std::abs((value(got) - want) / want));
}

template <class T>
void transforms_are_exact() {
  numbers<T> random;
  for (int i = 0; i < 20000; ++i) {
    const T a = random.next(40), b = random.next(40);
    const check::note at("a = ", a, ", b = ", b);
    const double_double<T> sum = mf::two_sum(a, b), product = mf::two_prod(a, b);
    const T lost_of_sum = mf::two_sum_error(a, b, sum.high), lost = mf::two_prod_error(a, b, product.high);
    CHECK(sum.high == a + b && exactly(sum.high) + exactly(lost_of_sum) == exactly(a) + exactly(b));
    CHECK(product.high == a * b && lost == std::fma(a, b, -(a * b)));
    const T larger = std::abs(a) < std::abs(b) ? b : a, smaller = std::abs(a) < std::abs(b) ? a : b;
    const double_double<T> ordered = mf::fast_two_sum(larger, smaller);
    CHECK(ordered.high == sum.high);
    if constexpr (!mf::one_number<T>)
      CHECK(sum.low == lost_of_sum && product.low == lost && ordered.low == lost_of_sum);
  }
}

// a b - a d is a (b - d), though b and d differ in the last place.
template <class T>
void sums_of_products_may_cancel() {
  numbers<T> random;
  for (int i = 0; i < 20000; ++i) {
    const T a = random.next(20), b = random.next(20), d = std::nextafter(b, T(0));
    const check::note at("a = ", a, ", b = ", b);
    const auto difference = mf::sum_of_products<T>(a, b).plus(-a, d);
    CHECK(difference.value() == a * (b - d));
  }
}

template <class T>
void arithmetic_keeps_the_digits() {
  numbers<T> random;
  for (int i = 0; i < 20000; ++i) {
    const double_double<T> a = mf::two_prod(random.next(8), random.next(8));
    const double_double<T> b = mf::two_prod(random.next(8), random.next(8));
    const long double x = value(a), y = value(b);
    const check::note at("a = ", x, ", b = ", y);
    CHECK(error(a * b, x * y) < tight<T>);
    CHECK(error(quotient(a, b), x / y) < 2 * tight<T>);
    CHECK(error(square(a), x * x) < tight<T>);
    CHECK(error(sqrt(abs(a)), std::sqrt(std::abs(x))) < tight<T>);
    // The sum keeps its digits relative to the larger term.
    CHECK(std::abs(value(a + b) - (x + y)) <= tight<T> * (std::abs(x) + std::abs(y)));
    CHECK(value(-a) == -x && value(abs(a)) == std::abs(x));
  }
}

// exp keeps the digits of T at exponents far from 0, scaled or not; logarithms keep more than float has.
template <class T>
void exponents() {
  constexpr double rounding = std::numeric_limits<T>::epsilon();
  numbers<T> random;
  for (int i = 0; i < 20000; ++i) {
    const T a = random.next(3), b = random.next(3);
    const double_double<T> x = mf::two_prod(a, b);
    const check::note at("x = ", value(x));
    CHECK_NEAR(exp(x) / std::exp(value(x)), 1, 1.5 * rounding);
    const double_double<T> size = abs(x);
    for (const double factor : {1.0, 1e30})
      CHECK_NEAR(
          times_exp_minus(static_cast<T>(factor), size) / (static_cast<T>(factor) * std::exp(-value(size))),
          1, 2 * rounding);
    const double_double<T> positive = mf::two_prod(a, a);
    const long double logarithm = std::log(value(positive));
    const long double unit = mf::one_number<T>            ? 4 * std::abs(logarithm) + 1e-3L
                             : std::abs(logarithm) < 0.5L ? std::abs(logarithm) * 2 + 1e-3L
                                                          : 1.0L;
    CHECK(std::abs(value(log_double_double(positive)) - logarithm) < 0.5 * rounding * unit);
    const long double logarithm1 = std::log1p(value(positive));
    CHECK(std::abs(value(log1p_double_double(positive)) - logarithm1) <
          0.5 * rounding * (mf::one_number<T> ? 4 * logarithm1 : 1.0L));
    CHECK(std::abs(mf::log_of_sum(positive.high, T(1)) - logarithm1) < 2 * rounding * logarithm1);
  }
}

// log(1 + a/b) and 1/(a + b) from quotients that are nothing to such that 1 is nothing beside them.
template <class T>
void quotients() {
  constexpr double rounding = std::numeric_limits<T>::epsilon();
  const double reach = mf::one_number<T> ? 300 : 30;
  numbers<T> random;
  for (int i = 0; i < 20000; ++i) {
    const double exponent = -reach + 2 * reach * i / 20000;
    const T factor = static_cast<T>(std::pow(10.0, exponent)), root = random.next(3);
    const double_double<T> b = mf::two_prod(root, root), a = mf::two_prod(factor, random.next(1)) * abs(b);
    if (!(a.high > 0)) continue;
    const check::note at("a = ", value(a), ", b = ", value(b));
    const mf::log_of_quotient<T> got = log1p_of_quotient(a, b);
    const long double logarithm = std::log1p(value(a) / value(b));
    CHECK(std::abs(value(got.log) / logarithm - 1) < (mf::one_number<T> ? 2.5 : 0.1) * rounding);
    CHECK_NEAR(got.reciprocal * (value(a) + value(b)), 1, 2.5 * rounding);
  }
}

template <class T>
void limits() {
  const T inf = std::numeric_limits<T>::infinity();
  for (const T x : {T(0), T(1), inf}) {
    const double_double<T> t(x);
    CHECK(exp(-t) == std::exp(-x) && exp(-(t * t)) == std::exp(-x * x));
    CHECK(times_exp_minus(T(1), t) == std::exp(-x) && times_exp_minus(T(0), t) == 0);
    CHECK(log_double_double(t).high == std::log(x) && log1p_double_double(t).high == std::log1p(x));
    CHECK(square(t).high == x * x);
  }
  CHECK(std::isnan(times_exp_minus(mf::nan<T>(), double_double<T>(1))) &&
        std::isnan(times_exp_minus(T(1), double_double<T>(mf::nan<T>()))));
  CHECK(std::isnan(exp(double_double<T>(mf::nan<T>()))) &&
        std::isnan(log_double_double(double_double<T>(mf::nan<T>())).high));
}

// A lane of a pack has the bits of the number alone.
template <class T>
void packs_agree() {
  numbers<T> random;
  std::vector<T> values, results;
  const auto through_all = []<class R>(const R& x) {
    const double_double<R> x2 = mf::two_prod(x, R(x + R(1)));
    const auto l = log1p_of_quotient(square(x2), double_double<R>(R(3)));
    return R(times_exp_minus(l.reciprocal, l.log) +
             exp(-(log1p_double_double(square(x2)) + sqrt(abs(quotient(x2, double_double<R>(R(3))))))));
  };
  for (int i = 0; i < 300; ++i) {
    values.push_back(random.next(3));
    results.push_back(through_all(values.back()));
  }
  packs::each<T>(
      [&]<class Pack> { CHECK(packs::apply<Pack>(values, through_all) == packs::bits_of(results)); });
}

}  // namespace

TEST(transforms_are_exact) { transforms_are_exact<float>(), transforms_are_exact<double>(); }
TEST(sums_of_products_may_cancel) {
  sums_of_products_may_cancel<float>(), sums_of_products_may_cancel<double>();
}
TEST(arithmetic_keeps_the_digits) {
  arithmetic_keeps_the_digits<float>(), arithmetic_keeps_the_digits<double>();
}
TEST(exponents) { exponents<float>(), exponents<double>(); }
TEST(quotients) { quotients<float>(), quotients<double>(); }
TEST(limits) { limits<float>(), limits<double>(); }
TEST(packs_agree) { packs_agree<float>(), packs_agree<double>(); }
