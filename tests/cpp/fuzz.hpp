// Fuzzing: a test body that takes any bytes, whose results must be what they may be, while sanitizers watch
// how they come about. With -fsanitize=fuzzer libFuzzer chooses the bytes; elsewhere a generator of random
// numbers does, the same ones each time. Both take -runs=N and -max_total_time=SECONDS.
//
//   FUZZ { ...; fuzz::require(in.number<T>() ...); }      with `in` the source of arguments
#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

namespace fuzz {

// The numbers that an input has given, for the message of a failure.
inline std::vector<double> given;
// Whether results are judged: arithmetic in float of a family that needs double must only be defined.
inline bool judged = true;

// Takes numbers from bytes, and zeros where they end.
class input {
 public:
  input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  template <class Bits>
  Bits bits() {
    Bits b{};
    const std::size_t n = left_ < sizeof b ? left_ : sizeof b;
    if (n > 0) std::memcpy(&b, data_, n);
    data_ += n, left_ -= n;
    return b;
  }
  unsigned choice(unsigned of) { return bits<std::uint8_t>() % of; }

  // Any bit pattern at all; a number at which something happens; or one of everyday size.
  template <class T>
  T number() {
    const T x = any<T>();
    given.push_back(static_cast<double>(x));
    return x;
  }
  // exp(x), x uniform between two logarithms.
  template <class T>
  T between(double least, double most) {
    const T x = static_cast<T>(std::exp(least + (most - least) * uniform<double>()));
    given.push_back(static_cast<double>(x));
    return x;
  }
  // In [0, 1).
  template <class T>
  T uniform() {
    return static_cast<T>(bits<std::uint32_t>() >> 8) * T(0x1p-24);
  }

 private:
  template <class T>
  T any() {
    using limits = std::numeric_limits<T>;
    constexpr std::array<T, 18> special{T(0),
                                        T(-0.0),
                                        T(1),
                                        T(-1),
                                        T(0.5),
                                        T(2),
                                        T(3),
                                        limits::min(),
                                        limits::denorm_min(),
                                        -limits::denorm_min(),
                                        limits::max(),
                                        -limits::max(),
                                        limits::infinity(),
                                        -limits::infinity(),
                                        limits::quiet_NaN(),
                                        limits::epsilon(),
                                        T(1) - limits::epsilon() / 2,
                                        T(1) + limits::epsilon()};
    switch (choice(4)) {
      case 0:
        return std::bit_cast<T>(bits<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>());
      case 1:
        return special[choice(special.size())];
      case 2:
        return static_cast<T>(std::exp(0.1 * (bits<std::uint8_t>() - 128)));
      default:
        return uniform<T>();
    }
  }

  const std::uint8_t* data_;
  std::size_t left_;
};

[[noreturn]] inline void fail(std::string_view what, double value) {
  std::fprintf(stderr, "fuzz: %.*s, got %.17g\n", static_cast<int>(what.size()), what.data(), value);
  std::fprintf(stderr, "from the numbers");
  for (const double x : given) std::fprintf(stderr, " %.17g", x);
  std::fprintf(stderr, "\n");
  std::abort();
}
// What came out need not mean anything, but it has to be computed.
template <class T>
void compute(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}
// A number from least to most, or nan.
inline void require_within(std::string_view what, double value, double least, double most) {
  if (judged && (value < least || value > most)) fail(what, value);
}
inline void require_positive(std::string_view what, double value) {
  require_within(what, value, 0, std::numeric_limits<double>::infinity());
}
// Of unit length, or nan.
template <class T>
void require_unit(std::string_view what, const T& x, const T& y, const T& z) {
  const double X = static_cast<double>(x), Y = static_cast<double>(y), Z = static_cast<double>(z);
  const double rounding = 8 * static_cast<double>(std::numeric_limits<T>::epsilon());
  require_within(what, std::sqrt(X * X + Y * Y + Z * Z), 1 - rounding, 1 + rounding);
}

// visit.operator()<0>() ... <Count - 1>(): the one that is chosen.
template <unsigned Count, class Visitor>
void one_of(unsigned chosen, const Visitor& visit) {
  [&]<unsigned... I>(std::integer_sequence<unsigned, I...>) {
    ((I == chosen ? visit.template operator()<I>() : void()), ...);
  }(std::make_integer_sequence<unsigned, Count>());
}

}  // namespace fuzz

static void body(fuzz::input in);
#define FUZZ static void body(fuzz::input in)

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::given.clear();
  body(fuzz::input(data, size));
  return 0;
}

#if !defined(FUZZ_BY_ENGINE)
int main(int count, char** arguments) {
  long runs = 2000;
  double seconds = std::numeric_limits<double>::infinity();
  for (int i = 1; i < count; ++i) {
    const std::string_view a = arguments[i], value = a.substr(a.find('=') + 1);
    if (a.starts_with("-runs=")) runs = std::atol(value.data());
    if (a.starts_with("-max_total_time=")) seconds = std::atof(value.data());
  }
  std::mt19937_64 random(1);
  std::vector<std::uint8_t> bytes(512);
  const auto start = std::chrono::steady_clock::now();
  long done = 0;
  for (; runs < 0 || done < runs; ++done) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds) break;
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%ld runs\n", done);
}
#endif
