// The pack: lane by lane its operators are those of its numbers, and masks choose and combine lanes.

#include "microfacet/core/pack.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "check.hpp"
#include "microfacet/core/elementary.hpp"
#include "microfacet/core/lookup.hpp"
#include "packs.hpp"

namespace {

namespace mf = microfacet;

template <class T>
const std::array<T, 9> numbers{T(0),    T(-0.0),    T(1),        T(-2.75),       T(3e-5),
                               T(1e30), T(mf::inf), T(-mf::inf), T(mf::nan<T>())};

// Lane i of two packs holds a pair of numbers of its own.
template <class Pack>
Pack deal(int step, int first) {
  using T = typename Pack::lane;
  Pack x(T(0));
  for (int i = 0; i < Pack::size; ++i)
    x.set(i, numbers<T>[static_cast<std::size_t>(first + i * step) % numbers<T>.size()]);
  return x;
}

template <class T>
bool same(T a, T b) {
  return std::isnan(a) ? std::isnan(b) : mf::elementary::bits(a) == mf::elementary::bits(b);
}

template <class Visitor>
void each_pack(const Visitor& visit) {
  packs::each<float>(visit), packs::each<double>(visit);
}

}  // namespace

TEST(arithmetic_and_comparisons) {
  each_pack([]<class Pack> {
    using T = typename Pack::lane;
    for (int first = 0; first < 9; ++first) {
      const Pack a = deal<Pack>(1, 0), b = deal<Pack>(2, first), c = deal<Pack>(4, first);
      const Pack sum = a + b, difference = a - b, product = a * b, quotient = a / b, minus = -a,
                 root = sqrt(a);
      const Pack fused = multiply_add(a, b, c);
      const auto less = a<b, greater = a> b, at_most = a <= b, at_least = a >= b, equal = a == b,
                 other = a != b;
      for (int i = 0; i < Pack::size; ++i) {
        const T x = a[i], y = b[i], z = c[i];
        CHECK(same(sum[i], x + y) && same(difference[i], x - y) && same(product[i], x * y));
        CHECK(same(quotient[i], x / y) && same(minus[i], -x) && same(root[i], std::sqrt(x)));
        CHECK(same(fused[i], mf::multiply_add(x, y, z)));
        CHECK((less[i] != 0) == (x < y) && (greater[i] != 0) == (x > y) && (equal[i] != 0) == (x == y));
        CHECK((at_most[i] != 0) == (x <= y) && (at_least[i] != 0) == (x >= y) && (other[i] != 0) == (x != y));
      }
    }
  });
}

TEST(larger_and_smaller) {
  each_pack([]<class Pack> {
    using T = typename Pack::lane;
    for (int first = 0; first < 9; ++first) {
      const Pack a = deal<Pack>(1, 0), b = deal<Pack>(2, first), larger = maximum(a, b),
                 smaller = minimum(a, b);
      for (int i = 0; i < Pack::size; ++i) {
        const T x = a[i], y = b[i];
        CHECK(same(larger[i], mf::maximum(x, y)) && same(smaller[i], mf::minimum(x, y)));
      }
    }
  });
}

// Each size takes instructions of its own; an index counts mod the size.
template <std::size_t N, class Pack>
void look_up() {
  using T = typename Pack::lane;
  using integer = mf::integer_of<T>;
  std::array<T, 2 * N> table{};
  std::array<integer, 2 * N> whole{};
  for (std::size_t i = 0; i < 2 * N; ++i)
    table[i] = T(1.5) * static_cast<T>(i), whole[i] = static_cast<integer>(3 * i);
  for (int first = 0; first < static_cast<int>(2 * N); ++first) {
    typename Pack::integers index(0);
    for (int i = 0; i < Pack::size; ++i) index.set(i, static_cast<integer>(first + 5 * i));
    const Pack found = mf::lookup<N>(table, index);
    const auto found_whole = mf::lookup<N>(whole, index);
    for (int i = 0; i < Pack::size; ++i) {
      const std::size_t at = static_cast<std::size_t>(first + 5 * i) % N;
      CHECK(found[i] == table[at] && found_whole[i] == whole[at]);
    }
  }
}
TEST(lookups) {
  each_pack([]<class Pack> { look_up<16, Pack>(), look_up<32, Pack>(), look_up<128, Pack>(); });
}

TEST(masks) {
  each_pack([]<class Pack> {
    const Pack a = deal<Pack>(1, 0), b = deal<Pack>(2, 3);
    const auto less = a<b, above_one = a> Pack(1);
    const Pack chosen = select((less & above_one) | !(a == a), a, b);
    for (int i = 0; i < Pack::size; ++i) {
      const bool take = (a[i] < b[i] && a[i] > 1) || std::isnan(a[i]);
      CHECK(same(chosen[i], take ? a[i] : b[i]));
      CHECK(less[i] == 0 || less[i] == -1);
    }
    CHECK(!any_lane(a < Pack(-mf::inf)));
    for (int i = 0; i < Pack::size; ++i) {
      Pack one(0);
      one.set(i, 1);
      CHECK(any_lane(one == Pack(1)) && any_lane(one != Pack(1)) && !any_lane(one > Pack(1)));
    }
  });
}

TEST(bits_go_there_and_back) {
  each_pack([]<class Pack> {
    const Pack a = deal<Pack>(1, 0), back = from_bits(bits(a), a);
    const auto up = bits(a) << 1, down = bits(a) >> 3;
    for (int i = 0; i < Pack::size; ++i) {
      CHECK(same(back[i], a[i]));
      CHECK(up[i] == mf::elementary::bits(a[i]) << 1 && down[i] == mf::elementary::bits(a[i]) >> 3);
    }
  });
}

TEST(integers_wrap_round) {
  each_pack([]<class Pack> {
    using Integers = typename Pack::integers;
    using I = typename Integers::lane;
    using limits = std::numeric_limits<I>;
    const Integers most(limits::max()), least(limits::min()), one(1), two(2);
    const Integers above = most + one, below = least - one, twice = most * two;
    for (int i = 0; i < Pack::size; ++i)
      CHECK(above[i] == limits::min() && below[i] == limits::max() && twice[i] == -2);
  });
}

TEST(converts_explicitly) {
  each_pack([]<class Pack> {
    using T = typename Pack::lane;
    static_assert(std::is_constructible_v<Pack, int> && !std::is_convertible_v<double, Pack>);
    static_assert(!std::is_convertible_v<Pack, bool> &&
                  std::is_same_v<typename mf::scalar_traits<Pack>::real, T>);
    CHECK(same(Pack(-0.0)[0], T(-0.0)) && same(Pack(0.1)[Pack::size - 1], T(0.1)));
    CHECK(same(Pack(mf::inf)[0], T(mf::inf)) && std::isnan(Pack(mf::nan<T>())[0]));
  });
}
