// Graphs that the headers leave on the recording scalar compute what the headers compute, and so do their derivatives.

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "check.hpp"
#include "families.hpp"
#include "graph_values.hpp"
#include "microfacet/approx/accumulate.hpp"
#include "microfacet/record/quantities.hpp"

namespace {

namespace mf = microfacet;
// Unqualified, as the headers call them, so that the overloads of the recording scalar are found.
using graphs::inputs;
using mf::accumulate, mf::iterate, mf::select_lazy, mf::select_seldom;
using real = mf::record::number<double>;

// A function of x and y as a graph, differentiated by both.
template <class Function>
mf::record::graph graph_of(const Function& f) {
  mf::record::graph g;
  g.in_float64 = true;
  const mf::record::recording on(g);
  const real x = real::varying(g.input("x"), 0), y = real::varying(g.input("y"), 1), value = f(x, y);
  g.results = {{"value", value.id()}, {"x", value.derivative(0).id()}, {"y", value.derivative(1).id()}};
  return mf::record::finished(g);
}
struct answer {
  double value, by_x, by_y;
};
answer answer_of(const mf::record::graph& g, double x, double y) {
  const graphs::values<double> at(g, {{"x", x}, {"y", y}});
  return {at["value"], at["x"], at["y"]};
}

// By differences of eighth order.
double difference(const std::function<double(double)>& f, double x) {
  const double h = 2e-3 * std::max(std::abs(x), 0.05);
  const auto pair = [&](int k) { return f(x + k * h) - f(x - k * h); };
  return (0.8 * pair(1) - 0.2 * pair(2) + 4.0 / 105 * pair(3) - 1.0 / 280 * pair(4)) / h;
}

using results = std::vector<double>;
using distribution_inputs = std::map<std::string, double>;

// What the headers give in double, in the order of a graph's results.
template <class Tag>
struct expected {
  using family = typename Tag::template type<double>;
  const std::string& quantity;

  results operator()(const inputs& at) const {
    families::arguments arguments;
    if (!family::shape_invariant) arguments.push_back(at.at("alpha"));
    for (const auto& p : family::parameters) arguments.push_back(at.at(std::string(p.name)));
    const family density = families::make<double, Tag>(arguments);
    const mf::isotropic_shape<double> shape(family::shape_invariant ? at.at("alpha") : 1.0);
    const mf::ndf<family, double, mf::isotropic_shape<double>> ndf(density, shape);
    const auto number = [&](const char* name) { return at.at(name); };
    const auto direction = [&](const std::string& name) {
      return mf::vec3<double>{at.at(name + ".x"), at.at(name + ".y"), at.at(name + ".z")};
    };
    const auto parts = [](const mf::vec3<double>& m) { return results{m.x, m.y, m.z}; };
    const double x = at.at("xi.x"), y = at.at("xi.y"), z = at.at("xi.z");
    if (quantity == "P22") return {ndf.P22(number("p"), number("q"))};
    if (quantity == "P2") return {ndf.P2(number("p"))};
    if (quantity == "slope_cdf") return {ndf.slope_cdf(number("p"))};
    if (quantity == "survival") return {mf::survival(ndf, number("r"))};
    if (quantity == "D") return {ndf.D_of_unit(direction("m"))};
    if (quantity == "sigma") return {ndf.sigma(direction("w"))};
    if (quantity == "Lambda") return {ndf.Lambda(direction("w"))};
    if (quantity == "G1") return {ndf.G1(direction("w"))};
    if (quantity == "G2") return {ndf.G2(direction("w"), direction("wo"))};
    if (quantity == "pdf_visible") return {ndf.D_visible(direction("m"), direction("w"))};
    if (quantity == "sample") return parts(mf::sample_normal(ndf, x, y));
    if (quantity == "sample_visible") return parts(mf::sample_visible(ndf, direction("w"), x, y, z));
    return parts(mf::sample_visible_mixture(ndf, direction("w"), x, y, z, at.at("xi.w")));
  }
};

// All parameters of a family free.
template <class Tag>
mf::record::graph recorded(const std::string& quantity, bool native,
                           std::vector<std::string> derivatives = {}) {
  using family = typename Tag::template type<real>;
  mf::record::request asked{
      .quantity = quantity, .parameters = {{"alpha", {}}}, .derivatives = std::move(derivatives)};
  for (const auto& p : family::parameters) asked.parameters[std::string(p.name)] = {};
  return mf::record::recorded<double>(asked, native, [](const auto& parameter) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      if constexpr (family::shape_invariant) {
        return family(parameter(std::string(family::parameters[I].name))...);
      } else {
        return family(parameter("alpha"), parameter(std::string(family::parameters[I].name))...);
      }
    }(std::make_index_sequence<family::parameters.size()>());
  });
}

// Slopes, directions above and below the horizon, and uniforms.
inputs arguments_at(const families::arguments& shape, double alpha, std::size_t i) {
  const auto spread = [&](double step) { return std::fmod(0.37 + step * static_cast<double>(i + 1), 1.0); };
  const double cosine = (i % 3 == 2 ? -0.3 : 1.0) * (0.03 + 0.96 * spread(0.618)),
               turn = 6.28 * spread(0.755);
  const double slope = alpha * std::exp(4 * spread(0.57) - 2.5), sine = std::sqrt(1 - cosine * cosine);
  const double z = 1 / std::sqrt(1 + slope * slope);
  (void)shape;
  return {{"p", slope},
          {"q", 0.7 * slope},
          {"r", slope},
          {"m.x", slope * z * std::cos(turn)},
          {"m.y", slope * z * std::sin(turn)},
          {"m.z", z},
          {"w.x", sine},
          {"w.y", 0.0},
          {"w.z", cosine},
          {"wi.x", sine},
          {"wi.y", 0.0},
          {"wi.z", cosine},
          {"wo.x", 0.48},
          {"wo.y", 0.6},
          {"wo.z", 0.64},
          {"xi.x", spread(0.41)},
          {"xi.y", spread(0.29)},
          {"xi.z", spread(0.83)},
          {"xi.w", spread(0.67)}};
}
template <class Tag>
inputs with_parameters(inputs at, families::arguments shape) {
  using family = typename Tag::template type<double>;
  at["alpha"] = family::shape_invariant ? 0.3 : shape[0];
  std::size_t k = family::shape_invariant ? 0 : 1;
  for (const auto& p : family::parameters) at[std::string(p.name)] = shape[k++];
  return at;
}

const std::vector<std::string> quantities{"P22",
                                          "P2",
                                          "slope_cdf",
                                          "survival",
                                          "D",
                                          "sigma",
                                          "Lambda",
                                          "G1",
                                          "G2",
                                          "pdf_visible",
                                          "sample",
                                          "sample_visible",
                                          "sample_visible_mixture"};

template <class Tag>
void compare(const std::string& quantity, bool native, double tolerance) {
  const mf::record::graph g = recorded<Tag>(quantity, native);
  for (const families::arguments& shape : families::examples<Tag>())
    for (std::size_t i = 0; i < 6; ++i) {
      const double alpha = Tag::template type<double>::shape_invariant ? 0.3 : shape[0];
      const inputs at = with_parameters<Tag>(arguments_at(shape, alpha, i), shape);
      const results want = expected<Tag>{quantity}(at);
      const graphs::values<double> got(g, at);
      for (std::size_t k = 0; k < want.size(); ++k) {
        const check::note note(Tag::template type<double>::name, ' ', quantity, " point ", i, " of shape ",
                               shape.empty() ? 0.0 : shape.back(), " alpha ", alpha);
        if (std::isnan(want[k])) continue;  // of a direction that such a shape does not have: sigma diverges
        const double found = got[g.results[k].first];
        CHECK(std::abs(found - want[k]) <=
              tolerance * std::max(std::abs(want[k]), want.size() > 1 ? 1.0 : 0.0));
      }
    }
}

template <class Visitor>
void each_tag(const Visitor& visit) {
  std::apply([&](auto... tags) { (visit(tags), ...); }, mf::all_families{});
}

}  // namespace

TEST(a_graph_of_any_family_computes_what_the_headers_do) {
  each_tag([]<class Tag>(Tag) {
    using family = typename Tag::template type<double>;
    // Where the mixture scheme has an inverse of its own for graphs, it draws other normals from the same uniforms.
    constexpr bool other_mixture = mf::tail_quotients<family> && mf::mixture_sampling<family>;
    for (const std::string& q : quantities)
      if (!other_mixture || q != "sample_visible_mixture") compare<Tag>(q, true, 2e-12);
  });
}

TEST(functions_that_are_spelt_out_compute_the_same_to_single_precision) {
  each_tag([]<class Tag>(Tag) {
    for (const char* q : {"D", "Lambda", "sample"}) compare<Tag>(q, false, 2e-7);
  });
}

TEST(derivatives_of_any_family_are_those_of_the_headers) {
  each_tag([]<class Tag>(Tag) {
    using family = typename Tag::template type<double>;
    for (const std::string q : {"D", "Lambda", "sample", "sample_visible"}) {
      std::vector<std::string> names{"alpha"};
      for (const auto& p : family::parameters) names.emplace_back(p.name);
      names.emplace_back(q == "D" ? "m.x" : q == "sample" ? "xi.x" : "w.z");
      const mf::record::graph g = recorded<Tag>(q, true, names);
      const std::size_t results_each = names.size() + 1;
      // At alpha = 1, the sphere, GTR's forms are limits, which know no derivative by alpha.
      for (const families::arguments& shape : families::examples<Tag>()) {
        const double alpha = family::shape_invariant ? 0.3 : shape[0];
        const inputs at = with_parameters<Tag>(arguments_at(shape, alpha, 4), shape);
        const graphs::values<double> got(g, at);
        for (std::size_t r = 0; r < g.results.size() / results_each; ++r)
          for (const std::string& name : names) {
            const auto f = [&](double x) {
              inputs moved = at;
              moved[name] = x;
              return expected<Tag>{q}(moved)[r];
            };
            const std::string result = g.results[r * results_each].first + "/" + name;
            const check::note note(family::name, ' ', q, ' ', result, " of shape ",
                                   shape.empty() ? 0.0 : shape.back(), " alpha ", alpha);
            const double want = difference(f, at.at(name)), scale = std::abs(want) + std::abs(f(at.at(name)));
            if (std::isnan(want) || (!family::shape_invariant && alpha == 1)) continue;
            // Where a special form stands in for a limit, derivatives have half the digits.
            const bool leaves = !family::shape_invariant && shape[1] == 1;
            CHECK(std::abs(got[result] - want) <= (leaves ? 3e-6 : 1e-8) * scale);
          }
      }
    }
  });
}

TEST(a_sum_is_one_loop_and_its_states_carry_derivatives) {
  // sum of x^k y, k < 30, but no more than y + 4 terms
  const auto g = graph_of([](const real& x, const real& y) {
    using states = std::array<real, 2>;
    return accumulate(30, y + real(4), states{real(0), y},
                      [&](const auto&, const states& now) { return states{now[0] + now[1], now[1] * x}; })[0];
  });
  CHECK(g.loops.size() == 1 && g.loops[0].most == 30);
  for (const double y : {-5.0, 0.5, 3.0, 200.0}) {
    const int terms = std::min(30, static_cast<int>(std::ceil(std::max(y + 4, 0.0))));
    double sum = 0, slope = 0;
    for (int k = 0; k < terms; ++k)
      sum += y * std::pow(0.8, k), slope += k == 0 ? 0 : y * k * std::pow(0.8, k - 1);
    const answer a = answer_of(g, 0.8, y);
    CHECK_NEAR(a.value, sum, 1e-14);
    CHECK_NEAR(a.by_x, slope, 1e-13);
    CHECK_NEAR(a.by_y, sum / y, 1e-13);
  }
}

TEST(a_term_knows_its_index_and_looks_it_up) {
  const auto g = graph_of([](const real& x, const real&) {
    return accumulate(3, real(0), [&](const auto& k, const real& sum) {
      return sum + x * real(k.of(std::array{2.0, 5.0, 11.0})) * real(k.plus(1)) + real(k.inverse(2));
    });
  });
  CHECK(g.tables.size() == 1 && g.tables[0].values.size() >= 3);
  const answer a = answer_of(g, 2.0, 0.0);
  CHECK_NEAR(a.value, 2.0 * (2 + 10 + 33) + 0.5 + 1.0 / 3 + 0.25, 1e-15);
  CHECK_NEAR(a.by_x, 45.0, 1e-15);
}

TEST(sums_nest_and_the_inner_one_starts_anew) {
  // sum over k < 5 of sum over j < 4 of x^k (j + y), by states that the inner sum needs
  const auto g = graph_of([](const real& x, const real& y) {
    using states = std::array<real, 2>;
    return accumulate(5, states{real(0), real(1)}, [&](const auto&, const states& now) {
      const real inner = accumulate(
          4, real(0), [&](const auto& j, const real& sum) { return sum + now[1] * (real(j.plus(0)) + y); });
      return states{now[0] + inner, now[1] * x};
    })[0];
  });
  CHECK(g.loops.size() == 2 && g.loops[1].parent == 0);
  const double x = 0.7, y = 0.3;
  double powers = 0, slopes = 0;
  for (int k = 0; k < 5; ++k) powers += std::pow(x, k), slopes += k == 0 ? 0 : k * std::pow(x, k - 1);
  const answer a = answer_of(g, x, y);
  CHECK_NEAR(a.value, powers * (6 + 4 * y), 1e-14);
  CHECK_NEAR(a.by_x, slopes * (6 + 4 * y), 1e-14);
  CHECK_NEAR(a.by_y, 4 * powers, 1e-14);
}

TEST(a_loop_that_is_there_already_is_that_one) {
  const auto square_sum = [](const real& x) {
    return accumulate(7, real(0), [&](const auto& k, const real& sum) { return sum + x * real(k.plus(1)); });
  };
  const auto twice =
      graph_of([&](const real& x, const real& y) { return square_sum(x) * square_sum(x) + y; });
  CHECK(twice.loops.size() == 1);
  const auto apart = graph_of([&](const real& x, const real& y) { return square_sum(x) * square_sum(y); });
  CHECK(apart.loops.size() == 2);
  CHECK_NEAR(answer_of(apart, 2.0, 3.0).value, 56.0 * 84.0, 1e-15);
  CHECK_NEAR(answer_of(twice, 2.0, 3.0).by_x, 2 * 28 * 56.0, 1e-15);
}

TEST(a_solver_has_the_derivative_of_its_solution) {
  // The root of t^3 + y t = x.
  const auto g = graph_of([](const real& x, const real& y) {
    return iterate(60, real(1), x == x, [&](const real& t) {
      const real next = t - (t * t * t + y * t - x) / (real(3) * t * t + y);
      return mf::iteration{next, abs(next - t) > real(1e-12)};
    });
  });
  const answer a = answer_of(g, 10.0, 3.0);  // t = 2 solves t^3 + t = 10
  const double t = a.value, slope = 3 * t * t + 3;
  CHECK_NEAR(t * t * t + 3 * t, 10.0, 1e-14);
  CHECK_NEAR(a.by_x, 1 / slope, 1e-13);
  CHECK_NEAR(a.by_y, -t / slope, 1e-13);
}

TEST(a_side_that_is_long_is_a_branch_and_a_short_one_is_not) {
  const auto long_side = [](const real& x) {
    real sum(1);
    for (int k = 30; k > 0; --k) sum = sum * x * real(1.0 / k) + real(1);
    return sum;
  };
  const auto g = graph_of([&](const real& x, const real& y) {
    return select_lazy(x < y, [&] { return long_side(x); }, [&] { return x + y; });
  });
  CHECK(!g.branches.empty());
  const answer taken = answer_of(g, 0.5, 0.6), other = answer_of(g, 0.6, 0.5);
  CHECK_NEAR(taken.value, std::exp(0.5), 1e-14);
  CHECK_NEAR(taken.by_x, std::exp(0.5), 1e-14);
  CHECK(taken.by_y == 0 && other.value == 1.1 && other.by_x == 1 && other.by_y == 1);
  const auto seldom = graph_of([&](const real& x, const real& y) {
    return select_seldom(x < y, [&] { return long_side(x); }, x + y);
  });
  CHECK_NEAR(answer_of(seldom, 0.5, 0.6).value, std::exp(0.5), 1e-14);
  CHECK(answer_of(seldom, 0.6, 0.5).value == 1.1);
  const auto plain = graph_of([&](const real& x, const real& y) {
    return select_lazy(x < y, [&] { return x * y; }, [&] { return x + y; });
  });
  CHECK(plain.branches.empty() && plain.loops.empty());
}
