// A lane's bits do not depend on its neighbours, whose arguments and parameters may need other branches, more
// steps or more nodes.

#include <array>
#include <random>
#include <vector>

#include "agreement.hpp"
#include "check.hpp"
#include "microfacet/family/all.hpp"

#if MICROFACET_VECTOR_EXTENSIONS
namespace {

namespace mf = microfacet;
using pack = mf::pack<double, 64>;

struct point {
  double x, alpha, shape;
};

// Points all over the domain, the ends and the limits among them.
std::vector<point> points(const std::vector<double>& shapes, double lower, double upper) {
  std::mt19937_64 generator(7);
  const auto between = [&](double a, double b) {
    return a * std::pow(b / a, std::uniform_real_distribution<>()(generator));
  };
  const std::vector<double> slopes{0, 1e-300, 1e-20, 0.2499, 0.25, 1, 5.5, 400, 1e5, 1e200};
  const std::vector<double> alphas{1e-4, 0.3, 1, 1 + 1e-9, 10};
  std::vector<point> all;
  for (std::size_t i = 0; i < 400; ++i) {
    const bool drawn = i % 2 == 0;
    all.push_back({drawn ? between(1e-6, 1e3) : slopes[i / 2 % slopes.size()],
                   drawn ? between(1e-4, 10) : alphas[i / 2 % alphas.size()],
                   i % 3 == 0 ? shapes[i / 3 % shapes.size()] : between(lower, upper)});
  }
  return all;
}

pack lanes_of(const std::vector<point>& all, double point::* member, std::size_t first, std::size_t stride) {
  pack p(0.0);
  for (int i = 0; i < pack::size; ++i)
    p.set(i, all[(first + static_cast<std::size_t>(i) * stride) % all.size()].*member);
  return p;
}

template <class Make>
void alone_or_in_company(const char* family, const std::vector<point>& all, const Make& make) {
  const auto check = [&](const char* name, const auto& function) {
    const auto in_pack = [&](std::size_t first, std::size_t stride) {
      return function(
          make(lanes_of(all, &point::alpha, first, stride), lanes_of(all, &point::shape, first, stride)),
          lanes_of(all, &point::x, first, stride));
    };
    std::vector<double> alone;
    for (std::size_t i = 0; i < all.size(); ++i) alone.push_back(in_pack(i, 0)[0]);
    for (const std::size_t stride : {std::size_t{1}, std::size_t{53}}) {
      for (std::size_t first = 0; first < all.size(); ++first) {
        const pack y = in_pack(first, stride);
        for (int i = 0; i < pack::size; ++i) {
          const std::size_t k = (first + static_cast<std::size_t>(i) * stride) % all.size();
          const check::note at(family, ".", name, "(", all[k].x, "), alpha ", all[k].alpha, ", shape ",
                               all[k].shape, ": ", y[i], ", alone ", alone[k]);
          CHECK(lanes::same_bits(y[i], alone[k]));
        }
      }
    }
  };
  check("D", [](const auto& f, const pack& x) { return f.D(pack(0.5), mf::double_double<pack>(x)); });
  check("survival", [](const auto& f, const pack& x) { return f.survival(mf::double_double<pack>(x)); });
  check("P2", [](const auto& f, const pack& x) { return f.P2(mf::slope<pack>(x)); });
  check("slope_sf", [](const auto& f, const pack& x) { return f.slope_sf(mf::slope<pack>(-x)); });
  check("mean_excess", [](const auto& f, const pack& x) { return f.mean_excess(mf::slope<pack>(x)); });
  check("radius2", [](const auto& f, const pack& x) { return f.radius2(x / (pack(1) + x)); });
}

}  // namespace

TEST(student_t) {
  alone_or_in_company("student_t", points({1.05, 1.5001, 2, 1e6, 0.5, 1e300}, 1.501, 300),
                      [](const pack&, const pack& gamma) { return mf::student_t<pack>(gamma); });
}
TEST(gtr) {
  alone_or_in_company("gtr", points({0.25, 1, 1 + 1e-10, 1.5, 2, 15, -1, 90}, 0.25, 15),
                      [](const pack& alpha, const pack& gamma) { return mf::gtr<pack>(alpha, gamma); });
}
TEST(bessel_k) {
  alone_or_in_company("bessel_k", points({0.05, 0.5, 1, 1.5, 150, 399.9, 400, 1e6, -1}, 0.05, 150),
                      [](const pack&, const pack& a) { return mf::bessel_k<pack>(a); });
}
#endif
