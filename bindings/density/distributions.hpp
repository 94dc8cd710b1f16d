// Distributions at constant parameters, of a family's own forms and on tables, as a kernel's context.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>

#include "bindings/density/models.hpp"

namespace microfacet::bindings {

// Parameters that are the same for all elements, with all digits of what is stored. What is made of them does
// not depend on the operation, and is compiled once.
template <class Model>
using parameter_values = std::array<double, Model::count>;

template <class Model, class Lanes>
std::array<double_double<Lanes>, Model::count> in_all_lanes(const parameter_values<Model>& numbers) {
  const auto lanes_of = [](double number) {
    const auto high = static_cast<lane_of<Lanes>>(number);
    return double_double<Lanes>(Lanes(high),
                                Lanes(static_cast<lane_of<Lanes>>(number - static_cast<double>(high))));
  };
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<double_double<Lanes>, Model::count>{lanes_of(numbers[I])...};
  }(std::make_index_sequence<Model::count>());
}
template <class Model, class Lanes>
[[gnu::noinline]] auto constant_distribution(const parameter_values<Model>& numbers) {
  const auto p = in_all_lanes<Model, Lanes>(numbers);
  return make_distribution<Lanes>(make_family<Model>(p.data()), Model::shape(p.data(), numbers.data()));
}
template <class Model, class Lanes, class Tables>
[[gnu::noinline]] auto tabulated_distribution(const Tables& tables, const parameter_values<Model>& numbers) {
  const auto p = in_all_lanes<Model, Lanes>(numbers);
  return make_distribution<Lanes>(table_density<Model, Lanes>(tables),
                                  Model::shape(p.data(), numbers.data()));
}

// A distribution for one call of a kernel, and the tables that it reads.
struct distribution_in_use {
  std::shared_ptr<const void> tables;
  alignas(64) std::array<std::byte, 4096> distribution;

  template <class Distribution>
  void hold(const Distribution& d) {
    static_assert(std::is_trivially_destructible_v<Distribution> && sizeof d <= sizeof distribution);
    new (distribution.data()) Distribution(d);
  }
};

// The constant distribution that was asked for last: a call on one number, and each inner loop of a call that
// broadcasts, would set it up anew. A thread that finds another one here does so.
template <class Model, class Lanes>
struct last_distribution {
  using distribution = decltype(constant_distribution<Model, Lanes>({}));
  constinit inline static std::atomic_flag busy;
  constinit inline static std::optional<std::pair<parameter_values<Model>, distribution>> last;
};
// Make a distribution of its own forms, and on tables of `functions`: false where there are none that keep the
// accuracy contract.
template <class Model, class Lanes>
bool use_own_forms(const double* parameters, unsigned, distribution_in_use& in_use) {
  parameter_values<Model> numbers;
  std::copy_n(parameters, Model::count, numbers.begin());
  const auto same_bits = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  };
  auto& last = last_distribution<Model, Lanes>::last;
  std::atomic_flag& busy = last_distribution<Model, Lanes>::busy;
  if (busy.test_and_set(std::memory_order_acquire)) {
    in_use.hold(constant_distribution<Model, Lanes>(numbers));
    return true;
  }
  if (!last || !std::equal(numbers.begin(), numbers.end(), last->first.begin(), same_bits))
    last.emplace(numbers, constant_distribution<Model, Lanes>(numbers));
  in_use.hold(last->second);
  busy.clear(std::memory_order_release);
  return true;
}
template <class Model, class Lanes>
bool use_tables(const double* parameters, unsigned functions, distribution_in_use& in_use) {
  const auto tables = tables_of<Model, lane_of<Lanes>>(parameters, functions);
  if (tables == nullptr) return false;
  parameter_values<Model> numbers;
  std::copy_n(parameters, Model::count, numbers.begin());
  in_use.hold(tabulated_distribution<Model, Lanes>(*tables, numbers));
  in_use.tables = tables;
  return true;
}
// The tables themselves, for kernels that bring the rest.
template <class Model, class Real>
bool use_bare_tables(const double* parameters, unsigned functions, distribution_in_use& in_use) {
  const auto tables = tables_of<Model, Real>(parameters, functions);
  if (tables == nullptr) return false;
  in_use.hold(tables.get());
  in_use.tables = tables;
  return true;
}

}  // namespace microfacet::bindings
