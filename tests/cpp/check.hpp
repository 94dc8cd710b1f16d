// A small check library, so that the tests need nothing but a compiler.
//
//   TEST(name) { CHECK(a < b); CHECK_NEAR(got, want, 1e-13); }   and main() comes with the header.
//
// CHECK_NEAR is relative to `want` (absolute where want is 0) and takes equal infinities as equal; nan fails.
// `check::note at("gamma = ", 2.5);` is printed with every failure inside its scope.
#pragma once

#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace check {

struct test {
  const char* name;
  void (*run)();
};

struct state {
  std::vector<test> tests;
  std::vector<std::string> notes;
  long checks = 0, failures = 0;
};

inline state& global() {
  static state instance;
  return instance;
}

struct add {
  add(const char* name, void (*run)()) { global().tests.push_back({name, run}); }
};

struct note {
  template <class... Parts>
  explicit note(const Parts&... parts) {
    std::ostringstream text;
    text.precision(17);
    (text << ... << parts);
    global().notes.push_back(text.str());
  }
  ~note() { global().notes.pop_back(); }
  note(const note&) = delete;
  note& operator=(const note&) = delete;
};

inline void report(bool ok, const char* file, int line, const std::string& what) {
  state& s = global();
  ++s.checks;
  if (ok) return;
  ++s.failures;
  std::printf("%s:%d: %s\n", file, line, what.c_str());
  for (const std::string& n : s.notes) std::printf("    at %s\n", n.c_str());
}

inline double relative_error(double got, double want) {
  if (got == want) return 0;
  const double error = std::abs(got - want) / (want == 0 ? 1 : std::abs(want));
  return error == error ? error : std::numeric_limits<double>::infinity();
}

inline void near(double got, double want, double tolerance, const char* file, int line,
                 const char* expression) {
  const double error = relative_error(got, want);
  std::ostringstream text;
  text.precision(17);
  text << expression << ": got " << got << ", want " << want << ", relative error " << error << " > "
       << tolerance;
  report(error <= tolerance, file, line, text.str());
}

inline int run_all() {
  state& s = global();
  int failed = 0;
  for (const test& t : s.tests) {
    const long before = s.failures;
    t.run();
    if (s.failures != before) {
      ++failed;
      std::printf("FAILED %s\n", t.name);
    }
  }
  std::printf("%ld checks\n%d passed, %d failed\n", s.checks, static_cast<int>(s.tests.size()) - failed,
              failed);
  return failed != 0 || s.checks == 0;
}

}  // namespace check

#define TEST(name)                                        \
  static void test_##name();                              \
  static const check::add add_##name(#name, test_##name); \
  static void test_##name()
#define CHECK(condition) check::report(static_cast<bool>(condition), __FILE__, __LINE__, #condition)
#define CHECK_NEAR(got, want, tolerance)                                                                     \
  check::near(static_cast<double>(got), static_cast<double>(want), static_cast<double>(tolerance), __FILE__, \
              __LINE__, #got)

int main() { return check::run_all(); }
