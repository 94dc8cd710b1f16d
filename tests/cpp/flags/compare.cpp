// Compares what flags/values.cpp says, compiled with the flags of others, with what it says without them:
//   compare plain.txt fast.txt least
// of which the second may end early, after `least` lines.
//
// Both are within the accuracy contract of the truth, and so within twice that of each other. Flags that
// allow -ffast-math's arithmetic flush subnormal numbers, factors of a result among them.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace {

struct line {
  std::string name;
  double value = 0;
};
bool read(std::istream& in, line& l) {
  std::string text;
  if (!std::getline(in, l.name, '\t') || !std::getline(in, text)) return false;
  l.value = std::strtod(text.c_str(), nullptr);
  return true;
}

bool has(const std::string& name, const char* part) { return name.find(part) != std::string::npos; }

// The error allowed, and what is too small to count.
struct allowed {
  double relative, absolute;
};
allowed of(const line& l) {
  const bool single = has(l.name, "float");
  for (const char* part : {".x ", ".y ", ".z "})  // of directions
    if (has(l.name, part)) return {0, single ? 2e-4 : 1e-9};
  // Of a pair of directions, whose facet has a rounding of its own.
  for (const char* part : {" eval ", " pdf ", " weight "})
    if (has(l.name, part)) return {single ? 2e-4 : 1e-10, 1e-20};
  const bool far = std::abs(std::log(std::abs(l.value))) > (single ? 20 : 50);
  return {single ? (far ? 1e-4 : 8e-6) : (far ? 2e-12 : 2e-13), single ? 1e-30 : 1e-300};
}

}  // namespace

int main(int, char** names) {
  std::ifstream plain(names[1]), fast(names[2]);
  line want, got;
  long count = 0, failures = 0;
  while (read(fast, got)) {
    ++count;
    const allowed a = read(plain, want) ? of(want) : allowed{0, 0};
    // nan means nothing under such flags.
    const bool same = got.name == want.name && (got.value == want.value || std::isnan(want.value) ||
                                                std::abs(got.value - want.value) <=
                                                    std::max(a.relative * std::abs(want.value), a.absolute));
    if (!same && ++failures <= 20)
      std::printf("%s: %.17g, with flags %.17g (%s)\n", want.name.c_str(), want.value, got.value,
                  got.name.c_str());
  }
  std::printf("%ld values, %ld differ\n", count, failures);
  return failures != 0 || count < std::stol(names[3]);
}
