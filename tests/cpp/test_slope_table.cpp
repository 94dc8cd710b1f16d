// Densities on grids of slopes: rows of prefix sums against sums over cells, samples against what is asked for.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "check.hpp"
#include "microfacet/smith/slope_table.hpp"

namespace {

namespace mf = microfacet;
using vec = mf::vec3<double>;

// Numbers in [0, 1) that need no library.
class uniform_numbers {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  unsigned long long state_ = 1;
};

vec unit(const vec& w) {
  const double length = std::sqrt(mf::dot(w, w));
  return {w.x / length, w.y / length, w.z / length};
}
vec direction(uniform_numbers& u) { return unit({u() - 0.5, u() - 0.5, u() - 0.5}); }

struct example {
  const char* name;
  mf::slope_axis p, q;
  std::vector<double> masses;

  mf::slope_table table() const { return {p, q, masses.data()}; }
};

std::vector<example> examples() {
  uniform_numbers u;
  std::vector<example> found{{"one cell", {0.1, 0.4, 1}, {-0.3, 0.9, 1}, {2.0}},
                             {"a row", {-1, 0.5, 4}, {0.2, 0.1, 1}, {1, 0, 3, 2}},
                             {"a column", {0.3, 0.1, 1}, {-1, 0.4, 5}, {1, 2, 0, 0, 1}},
                             {"holes", {-0.9, 0.13, 17}, {-0.5, 0.2, 9}, {}},
                             {"tilted", {0.7, 0.01, 20}, {-2.0, 0.05, 30}, {}}};
  for (example& e : found)
    while (e.masses.size() < static_cast<std::size_t>(e.p.count * e.q.count))
      e.masses.push_back(u() < 0.4 ? 0.0 : u());
  return found;
}

// The mean of max(t + a u + b v, 0), |u|, |v| < 1/2, by the midpoint rule over v of the integral over u.
double mean_seen(double t, double a, double b) {
  constexpr int n = 4000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double middle = t + b * ((i + 0.5) / n - 0.5), low = middle - a / 2, high = middle + a / 2;
    const double part = high <= 0 ? 0 : low >= 0 ? middle : high * high / (2 * a);
    sum += part;
  }
  return sum / n;
}

TEST(areas_are_sums_of_what_cells_show) {
  uniform_numbers u;
  for (const example& e : examples()) {
    const check::note at(e.name);
    const mf::slope_table table = e.table();
    for (int k = 0; k < 20; ++k) {
      const vec w = direction(u);
      double sum = 0;
      for (int j = 0; j < e.q.count; ++j)
        for (int i = 0; i < e.p.count; ++i) {
          const double t =
              w.z - w.x * (e.p.first + e.p.step * (i + 0.5)) - w.y * (e.q.first + e.q.step * (j + 0.5));
          sum += table.grid().mass(i, j) * mean_seen(t, std::abs(w.x) * e.p.step, std::abs(w.y) * e.q.step);
        }
      if (sum > 1e-3) CHECK_NEAR(table.sigma(w), sum, 1e-6);
      CHECK_NEAR(table.sigma(w), mf::slope_half_plane(table.grid(), w).area_of_cells(), 1e-11);
    }
    CHECK_NEAR(table.sigma({0, 0, 1}), 1, 1e-14);
    CHECK(table.sigma({0, 0, -1}) == 0);
    CHECK(table.error() < 1e-12);
  }
}

TEST(below_a_plane_is_what_is_not_above) {
  uniform_numbers u;
  for (const example& e : examples()) {
    const mf::slope_table table = e.table();
    for (int k = 0; k < 200; ++k) {
      const vec w = direction(u), back{-w.x, -w.y, -w.z};
      const double up = table.up(w), sigma = table.sigma(w), below = table.sigma(back);
      CHECK(std::abs(sigma - below - up) < 1e-13);
      if (up > 1e-6) {
        CHECK_NEAR(table.Lambda(w), below / up, 1e-12);
        CHECK_NEAR(table.Lambda(back), -1 - below / up, 1e-12);
        CHECK_NEAR(table.G1(w), up / sigma, 1e-14);
        CHECK(table.G1(back) == 0);
        CHECK(table.G2(back, w) == 0);
        CHECK_NEAR(table.G2(w, w), 1 / (1 + 2 * table.Lambda(w)), 1e-13);
        CHECK_NEAR(table.G2_uncorrelated(w, back), mf::square(table.G1(w)), 1e-13);
      }
    }
  }
}

// What is drawn has to follow the density in its own coordinates: the part of the weight that lies before a drawn
// slope is spread evenly.
TEST(visible_slopes_are_spread_as_they_are_seen) {
  uniform_numbers u;
  for (const example& e : examples()) {
    const check::note at(e.name);
    const mf::slope_table table = e.table();
    for (int k = 0; k < 6; ++k) {
      const vec w = direction(u);
      const double sigma = table.sigma(w);
      if (sigma < 1e-3) continue;
      // The mean slope of what w sees, from a finer grid.
      constexpr int n = 40000;
      std::array<double, 2> drawn{};
      for (int i = 0; i < n; ++i) {
        const double xi0 = (i + 0.5) / n, xi1 = std::fmod(i * 0.6180339887498949, 1.0);
        const vec m = table.sample_visible(w, xi0, xi1);
        CHECK(mf::dot(m, w) > -1e-12);
        drawn[0] -= m.x / m.z / n, drawn[1] -= m.y / m.z / n;
      }
      std::array<double, 2> mean{};
      constexpr int fine = 40;
      for (int j = 0; j < e.q.count * fine; ++j)
        for (int i = 0; i < e.p.count * fine; ++i) {
          const double p = e.p.first + e.p.step * (i + 0.5) / fine,
                       q = e.q.first + e.q.step * (j + 0.5) / fine;
          const double weight = table.grid().mass(i / fine, j / fine) / (fine * fine) *
                                std::max(w.z - w.x * p - w.y * q, 0.0) / sigma;
          mean[0] += p * weight, mean[1] += q * weight;
        }
      CHECK(std::abs(drawn[0] - mean[0]) < 2e-3 * e.p.step * e.p.count + 1e-4);
      CHECK(std::abs(drawn[1] - mean[1]) < 2e-3 * e.q.step * e.q.count + 1e-4);
    }
  }
}

TEST(parts_of_cells_are_inverted) {
  for (const double xi : {0.0, 0.1, 0.5, 0.9, 0.999999})
    for (const std::array<double, 2>& ends :
         {std::array{1.0, 0.0}, std::array{0.0, 1.0}, std::array{1.0, 1.0}, std::array{1e20, 1e20},
          std::array{3.0, 2.0}}) {
      const double a = ends[0], b = ends[1], t = mf::inverse_of_linear(xi, a, b),
                   s = mf::inverse_of_square(xi, a, b);
      CHECK(std::abs((a * t + (b - a) * t * t / 2) / ((a + b) / 2) - xi) < 1e-14);
      const double at = a + (b - a) * s, all = a * a + a * b + b * b;
      CHECK(std::abs(s * (a * a + a * at + at * at) / all - xi) < 1e-14);
    }
}

TEST(frames_turn_the_mean_normal_up) {
  uniform_numbers u;
  for (int k = 0; k < 50; ++k) {
    const double p = 4 * u() - 2, q = 4 * u() - 2;
    const mf::mean_plane::frame frame(p, q);
    const vec normal = unit({-p, -q, 1}), w = direction(u), there = frame.from_world(w),
              back = frame.to_world(there);
    const vec up = frame.from_world(normal);
    CHECK(std::abs(up.x) + std::abs(up.y) + std::abs(up.z - 1) < 1e-15);
    CHECK(std::abs(back.x - w.x) + std::abs(back.y - w.y) + std::abs(back.z - w.z) < 2e-15);
    CHECK_NEAR(frame.area(), 1 / normal.z, 1e-15);
    CHECK_NEAR(mf::dot(there, there), 1, 1e-15);
  }
  const mf::mean_plane::frame level(0, 0);
  const vec same = level.from_world({0.6, 0.0, 0.8});
  CHECK(same.x == 0.6 && same.y == 0 && same.z == 0.8);
}

TEST(nothing_comes_of_no_direction) {
  const mf::slope_table table = examples()[3].table();
  const double bad = mf::nan<double>(), far = mf::infinite<double>();
  for (const vec& w : {vec{bad, 0, 1}, vec{0, bad, 1}, vec{0, 0, bad}, vec{far, 0, 1}, vec{0, 0, -far}}) {
    CHECK(std::isnan(table.sigma(w)));
    CHECK(std::isnan(table.sample_visible(w, 0.5, 0.5).z));
  }
  CHECK(std::isnan(table.D({bad, 0, 1})));
  CHECK(std::isnan(table.P22(0, bad)) && std::isnan(table.P2(bad)) && std::isnan(table.slope_cdf(bad)));
  CHECK(table.D({0, 0, -1}) == 0 && table.D({1, 0, 1e-320}) == 0 && table.P22(far, 0) == 0);
  CHECK(std::isnan(table.sample(1, 0.5).z) && std::isnan(table.sample(0.5, -0.1).z));
  CHECK(std::isnan(table.sample_visible({0, 0, -1}, 0.5, 0.5).z));
}

}  // namespace
