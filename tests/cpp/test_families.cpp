// Every family in double: laws that hold for all of them, and the closed forms of those that have one.
//
// The laws tie what a family states to what it derives: a dual number differentiates one function and the
// other one must come out (d survival/d r2 = -pi P22, d slope_sf/dt = -P2, d mean_excess/dx = -slope_sf).

#include "check.hpp"
#include "dual.hpp"
#include "families.hpp"

namespace {

namespace mf = microfacet;
using autodiff::dual;
constexpr double pi = mf::pi;

template <class Tag>
check::note here(const families::arguments& a) {
  const double none = 0;
  return check::note(Tag::template type<double>::name, " ", a.empty() ? none : a[0], " ",
                     a.size() < 2 ? none : a[1]);
}

constexpr double slopes[]{0.003, 0.1, 0.45, 0.9, 1.3, 2.2, 5.5};

}  // namespace

TEST(derivatives_are_the_other_functions) {
  families::each([]<class Tag>(const families::arguments& a) {
    const check::note family = here<Tag>(a);
    const auto f = families::make<double, Tag>(a);
    const auto differentiable = families::make<dual, Tag>(a);
    for (const double t : slopes) {
      const check::note at("t = ", t);
      CHECK_NEAR(differentiable.survival(dual::variable(t * t)).d, -pi * f.P22(t * t), 1e-10);
      CHECK_NEAR(differentiable.slope_sf(dual::variable(t)).d, -f.P2(t), 1e-10);
      CHECK_NEAR(differentiable.slope_sf(dual::variable(-t)).d, -f.P2(t), 1e-10);
      CHECK_NEAR(differentiable.mean_excess(dual::variable(t)).d, -f.slope_sf(t), 1e-10);
    }
  });
}

// A dual number has no logarithm in two parts.
TEST(values_of_a_dual_are_the_values) {
  families::each([]<class Tag>(const families::arguments& a) {
    const check::note family = here<Tag>(a);
    const auto f = families::make<double, Tag>(a);
    const auto g = families::make<dual, Tag>(a);
    for (const double t : slopes) {
      const check::note at("t = ", t);
      CHECK_NEAR(g.P22(dual(t)).x, f.P22(t), 1e-13);
      CHECK_NEAR(g.D(dual(0.8), dual(t)).x, f.D(0.8, t), 1e-13);
      CHECK_NEAR(g.P2(dual(t)).x, f.P2(t), 1e-13);
      CHECK_NEAR(g.survival(dual(t)).x, f.survival(t), 1e-13);
      CHECK_NEAR(g.slope_sf(dual(t)).x, f.slope_sf(t), 1e-13);
      CHECK_NEAR(g.mean_excess(dual(t)).x, f.mean_excess(t), 1e-13);
      CHECK_NEAR(g.radius2(dual(t / 6)).x, f.radius2(t / 6), 1e-13);
    }
  });
}

// In float the formulas are the same; a rounding of an exponent x costs x roundings of the result.
TEST(float_follows_double) {
  families::each([]<class Tag>(const families::arguments& exact) {
    const check::note family = here<Tag>(exact);
    families::arguments rounded = exact;
    for (double& a : rounded) a = static_cast<float>(a);
    const auto f = families::make<float, Tag>(rounded);
    const auto g = families::make<double, Tag>(rounded);
    for (const float t : {0.01f, 0.3f, 0.8f, 1.3f, 2.5f}) {
      const check::note at("t = ", t);
      const double x = t;
      const auto follows = [](float got, double want) {  // as far as float reaches
        if (want < 1e-30)
          CHECK(got < 1e-29F);
        else
          CHECK_NEAR(got, want, 1e-5);
      };
      follows(f.P22(t), g.P22(x));
      follows(f.D(0.7f, t), g.D(0.7f, x));
      follows(f.P2(t), g.P2(x));
      follows(f.survival(t), g.survival(x));
      follows(f.slope_sf(t), g.slope_sf(x));
      follows(f.slope_sf(-t), g.slope_sf(-x));
      follows(f.mean_excess(t), g.mean_excess(x));
      follows(f.radius2(t / 4), g.radius2(t / 4));
    }
  });
}

TEST(limits) {
  families::each([]<class Tag>(const families::arguments& a) {
    const check::note family = here<Tag>(a);
    const auto f = families::make<double, Tag>(a);
    CHECK_NEAR(f.survival(0.0), 1, 4e-15);
    CHECK_NEAR(f.slope_sf(0.0), 0.5, 4e-15);
    CHECK(f.survival(mf::inf) == 0);
    CHECK(f.slope_sf(mf::inf) == 0);
    CHECK(f.slope_sf(-mf::inf) == 1);
    CHECK(f.P22(mf::inf) == 0);
    CHECK(f.P2(mf::inf) == 0 && f.P2(-mf::inf) == 0);
    for (const double t : slopes) {
      CHECK_NEAR(f.slope_sf(-t) + f.slope_sf(t), 1, 1e-15);
      CHECK(f.P2(-t) == f.P2(t));
    }
  });
}

// The mean slope along an azimuth in two ways: mean_excess(0) is half of E|p|, and E|p| = (2/pi) E r with
// E r = int_0^inf survival(r^2) dr. Simpson's rule in v, r = exp(v - exp(-v)): algebraic tails fall like
// exp(-v).
TEST(mean_slope_is_the_integral_of_the_survival) {
  families::each(
      []<class Tag>(const families::arguments& a) {
        const check::note family = here<Tag>(a);
        const auto f = families::make<double, Tag>(a);
        constexpr int panels = 9000;
        const double from = -4, to = 200, h = (to - from) / panels;
        double sum = 0;
        for (int i = 0; i <= panels; ++i) {
          const double v = from + i * h, r = std::exp(v - std::exp(-v));
          sum +=
              f.survival(r * r) * r * (1 + std::exp(-v));  // the ends vanish: the trapezoidal rule suffices
        }
        CHECK_NEAR(f.mean_excess(0.0), sum * h / pi, 1e-12);
      },
      families::which::with_a_density);
}

TEST(density_of_directions_is_the_density_of_slopes) {
  families::each([]<class Tag>(const families::arguments& a) {
    const check::note family = here<Tag>(a);
    const auto f = families::make<double, Tag>(a);
    for (const double z : {1.0, 0.9, 0.5, 0.2})
      for (const double t : slopes) CHECK_NEAR(f.D(z, t * t * z * z), f.P22(t * t) / (z * z * z * z), 2e-14);
  });
}

TEST(inverse_of_the_survival) {
  families::each(
      []<class Tag>(const families::arguments& a) {
        const check::note family = here<Tag>(a);
        const auto f = families::make<double, Tag>(a);
        CHECK(f.radius2(0.0) == 0);
        CHECK(std::isinf(f.radius2(1.0)) || std::isnan(f.radius2(1.0)));
        double before = 0;
        for (const double xi : {1e-9, 1e-4, 0.02, 0.3, 0.5, 0.77, 0.99, 1 - 0x1p-40, 1 - 0x1p-53}) {
          const check::note at("xi = ", xi);
          const double r2 = f.radius2(xi);
          CHECK(r2 > before && r2 < mf::inf);
          CHECK_NEAR(f.survival(r2), 1 - xi, 1e-13 * (1 - std::log(1 - xi)));
          before = r2;
        }
      },
      families::which::with_a_density);
}

TEST(outside_the_domain_is_nan) {
  families::each([]<class Tag>(const families::arguments& inside) {
    const check::note family = here<Tag>(inside);
    for (std::size_t i = 0; i < inside.size(); ++i)
      for (const double bad : {0.0, -1.0, std::nan(""), mf::inf, -mf::inf}) {
        const check::note at("argument ", i, " = ", bad);
        families::arguments outside = inside;
        outside[i] = bad;
        const auto f = families::make<double, Tag>(outside);
        CHECK(std::isnan(f.P22(0.5)) && std::isnan(f.D(0.8, 0.2)) && std::isnan(f.P2(0.5)));
        CHECK(std::isnan(f.survival(0.5)) && std::isnan(f.radius2(0.5)));
        CHECK(std::isnan(f.slope_sf(0.5)) && std::isnan(f.mean_excess(0.5)));
      }
    const auto f = families::make<double, Tag>(inside);
    const double nan = std::nan("");
    CHECK(std::isnan(f.P22(nan)) && std::isnan(f.D(nan, 0.2)) && std::isnan(f.D(0.8, nan)) &&
          std::isnan(f.P2(nan)));
    CHECK(std::isnan(f.survival(nan)) && std::isnan(f.radius2(nan)));
    CHECK(std::isnan(f.slope_sf(nan)) && std::isnan(f.mean_excess(nan)));
  });
}

// Closed forms

TEST(beckmann) {
  const mf::beckmann<double> f;
  for (const double t : slopes) {
    CHECK_NEAR(f.P2(t), std::exp(-t * t) / std::sqrt(pi), 1e-14);
    CHECK_NEAR(f.slope_sf(t), std::erfc(t) / 2, 1e-14);
  }
  // (exp(-x^2)/sqrt(pi) - x erfc x)/2 has no cancellation to speak of for small x
  for (const double x : {0.0, 0.003, 0.1, 0.2})
    CHECK_NEAR(f.mean_excess(x), (std::exp(-x * x) / std::sqrt(pi) - x * std::erfc(x)) / 2, 1e-14);
}

TEST(student_t_and_gtr_meet_in_ggx) {
  const mf::ggx<double> ggx;
  const mf::student_t<double> student(2.0);
  for (const double alpha : {0.05, 0.4, 1.0, 1.7}) {
    const mf::gtr<double> gtr(alpha, 2.0);
    for (const double t : slopes) {
      const double x = t / alpha;
      CHECK_NEAR(gtr.P22(t * t), ggx.P22(x * x) / (alpha * alpha), 1e-14);
      CHECK_NEAR(gtr.P2(t), ggx.P2(x) / alpha, 1e-13);
      CHECK_NEAR(gtr.survival(t * t), ggx.survival(x * x), 1e-14);
      CHECK_NEAR(gtr.slope_sf(t), ggx.slope_sf(x), 1e-13);
      CHECK_NEAR(gtr.mean_excess(t), ggx.mean_excess(x) * alpha, 1e-13);
      CHECK_NEAR(gtr.radius2(t / 6), ggx.radius2(t / 6) * alpha * alpha, 1e-13);
    }
  }
  for (const double t : slopes) {
    CHECK_NEAR(student.P22(t * t), ggx.P22(t * t), 1e-14);
    CHECK_NEAR(student.P2(t), ggx.P2(t), 1e-14);
    CHECK_NEAR(student.slope_sf(t), ggx.slope_sf(t), 1e-14);
    CHECK_NEAR(student.mean_excess(t), ggx.mean_excess(t), 1e-14);
    CHECK_NEAR(student.radius2(t / 6), ggx.radius2(t / 6), 1e-14);
  }
}

// gamma = 1 and alpha = 1, where the general formulas are 0/0: their logarithmic and elementary limits.
TEST(gtr_limits) {
  for (const double alpha : {0.05, 0.4, 1.7}) {
    const mf::gtr<double> f(alpha, 1.0);
    const double a2 = alpha * alpha;
    for (const double t : slopes) {
      const double r2 = t * t;
      CHECK_NEAR(f.P22(r2), (a2 - 1) / (2 * pi * std::log(alpha) * (1 + r2) * (r2 + a2)), 1e-13);
      CHECK_NEAR(f.P2(t), (1 / std::sqrt(1 + r2) - 1 / std::sqrt(r2 + a2)) / std::log(a2), 1e-12);
      CHECK_NEAR(f.slope_sf(-t), 0.5 + (std::asinh(t) - std::asinh(t / alpha)) / std::log(a2), 1e-13);
    }
  }
  for (const double gamma : {0.3, 1.0, 1.5, 7.0}) {
    const mf::gtr<double> f(1.0, gamma);
    for (const double t : slopes) {
      CHECK_NEAR(f.survival(t * t), 1 / (1 + t * t), 1e-14);
      CHECK_NEAR(f.P2(t), 0.5 * std::pow(1 + t * t, -1.5), 1e-13);
    }
  }
}

// Means over roughness, by the middles of many intervals: of Beckmann with a uniform squared roughness or roughness,
// and of GGX with an exponentially distributed inverse squared one.
TEST(mixtures) {
  const mf::beckmann<double> beckmann;
  const mf::ggx<double> ggx;
  const auto compare = [](const auto& f, const auto& part, const auto& roughness) {
    for (const double t : {0.45, 0.9, 1.3, 2.2}) {
      double survival = 0, sf = 0, excess = 0, P2 = 0, P22 = 0;
      constexpr int parts = 20000;
      for (int i = 0; i < parts; ++i) {
        const double b = roughness((i + 0.5) / parts), x = t / b;
        survival += part.survival(x * x) / parts, sf += part.slope_sf(x) / parts;
        excess += b * part.mean_excess(x) / parts, P2 += part.P2(x) / (b * parts);
        P22 += part.P22(x * x) / (b * b * parts);
      }
      const check::note at(f.name, ", t = ", t);
      CHECK_NEAR(f.survival(t * t), survival, 1e-4);
      CHECK_NEAR(f.slope_sf(t), sf, 1e-4);
      CHECK_NEAR(f.mean_excess(t), excess, 1e-2);
      CHECK_NEAR(f.P2(t), P2, 1e-4);
      CHECK_NEAR(f.P22(t * t), P22, 1e-4);
    }
  };
  compare(mf::ei<double>(), beckmann, [](double m) { return std::sqrt(m); });
  compare(mf::erfc<double>(), beckmann, [](double m) { return m; });
  compare(mf::double_ggx<double>(), ggx, [](double m) { return 1 / std::sqrt(-std::log(m)); });
  CHECK(mf::ei<double>().P22(0.0) == mf::inf);
  CHECK(mf::erfc<double>().P22(0.0) == mf::inf && mf::erfc<double>().P2(0.0) == mf::inf);
  CHECK_NEAR(mf::double_ggx<double>().P22(0.0), 1 / pi, 1e-15);
}

TEST(bessel_k_and_k0) {
  const mf::k0<double> k0;
  const mf::bessel_k<double> one(1.0), two(2.0);
  for (const double x : slopes) {
    CHECK_NEAR(k0.P2(x), std::exp(-2 * x), 1e-15);
    CHECK_NEAR(one.P2(x), std::exp(-2 * x), 1e-13);
    CHECK_NEAR(one.slope_sf(x), k0.slope_sf(x), 1e-13);
    CHECK_NEAR(one.mean_excess(x), k0.mean_excess(x), 1e-13);
    CHECK_NEAR(two.P2(x), std::exp(-2 * x) * (2 * x + 1) / 2, 1e-13);
    CHECK_NEAR(two.mean_excess(x), std::exp(-2 * x) * (2 * x + 3) / 8, 1e-13);
  }
  CHECK(k0.P22(0.0) == mf::inf && one.P22(0.0) == mf::inf);
  CHECK_NEAR(two.P22(0.0), 1 / pi, 1e-14);
}

TEST(exponentials) {
  const mf::exponential<double> exponential;
  const mf::bessel_k<double> bessel(1.5);
  const mf::generalised_exponential<double> one(1.0), two(2.0), four(4.0);
  const mf::beckmann<double> beckmann;
  for (const double x : slopes) {
    CHECK_NEAR(exponential.P22(x * x), bessel.P22(x * x), 1e-13);
    CHECK_NEAR(exponential.P2(x), bessel.P2(x), 1e-13);
    CHECK_NEAR(exponential.survival(x * x), bessel.survival(x * x), 1e-13);
    CHECK_NEAR(exponential.radius2(x / 6), bessel.radius2(x / 6), 1e-13);
    CHECK_NEAR(one.P2(2 * x) * 2, exponential.P2(x), 1e-13);
    CHECK_NEAR(one.slope_sf(2 * x), exponential.slope_sf(x), 1e-13);
    CHECK_NEAR(one.mean_excess(2 * x) / 2, exponential.mean_excess(x), 1e-13);
    CHECK_NEAR(one.radius2(x / 6) / 4, exponential.radius2(x / 6), 1e-13);
    CHECK_NEAR(two.P2(x), beckmann.P2(x), 1e-13);
    CHECK_NEAR(two.slope_sf(x), beckmann.slope_sf(x), 1e-13);
    CHECK_NEAR(two.mean_excess(x), beckmann.mean_excess(x), 1e-13);
    CHECK_NEAR(two.radius2(x / 6), beckmann.radius2(x / 6), 1e-13);
    CHECK_NEAR(four.survival(x * x), std::erfc(x * x), 1e-13);
  }
}

// The azimuth f of what a direction x sees: (x f + sin f) is a share of its value at the end.
TEST(ring_as_it_is_seen) {
  const mf::dirac<double> ring;
  for (const double t : {0.0, 0.3, 0.9}) {
    CHECK_NEAR(ring.slope_sf(t), std::acos(t) / pi, 1e-14);
    CHECK_NEAR(ring.mean_excess(t), (std::sqrt(1 - t * t) - t * std::acos(t)) / pi, 1e-13);
  }
  CHECK(ring.P22(1.0) == mf::inf && ring.P22(0.99) == 0 && ring.D(0.5, 0.25) == mf::inf &&
        ring.D(0.5, 0.3) == 0);
  for (const double x : {-0.9, -0.5, -1e-3, 0.0, 0.2, 0.9, 1.0, 1.0000001, 1.5, 100.0, 1e15}) {
    const double last = x >= 1 ? pi : std::acos(-x), all = x * last + (x >= 1 ? 0 : std::sin(last));
    for (const double xi : {0.0, 1e-6, 0.1, 0.5, 0.9, 0.999999, 1 - 1e-12, 1 - 0x1p-53}) {
      const check::note at("x = ", x, ", xi = ", xi);
      const auto seen = ring.visible_slopes_of(x, xi, 0.25, 0.5),
                 other = ring.visible_slopes_of(x, xi, 0.75, 0.5);
      const double f = std::atan2(seen.across, seen.along);
      CHECK(std::abs((x * f + std::sin(f)) / all - xi) < 1e-14);
      CHECK_NEAR(std::hypot(seen.along, seen.across), 1, 1e-15);
      CHECK(other.along == seen.along && other.across == -seen.across);
    }
  }
}
