// Visits the families that family/all.hpp lists, each at a few shape parameters inside its domain, so that a
// new family is tested without being named here.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "microfacet/family/all.hpp"

namespace families {

// The arguments of a family's constructor: its shape parameters, after alpha where it is not shape invariant.
using arguments = std::vector<double>;

template <class Tag>
std::vector<arguments> examples() {
  using family = typename Tag::template type<double>;
  std::vector<arguments> all{{}};
  const auto extend = [&all](const std::vector<double>& values) {
    std::vector<arguments> longer;
    for (const arguments& a : all)
      for (const double v : values) {
        longer.push_back(a);
        longer.back().push_back(v);
      }
    all = longer;
  };
  if (!family::shape_invariant) extend({0.05, 0.4, 1.0, 1.7});
  for (const auto& p : family::parameters) {
    const double unit = std::min(1.0, (p.upper - p.lower) / 12);
    extend({p.lower + 0.3 * unit, p.lower + unit, p.lower + 1.8 * unit, p.lower + 11 * unit});
  }
  return all;
}

template <class T, class Tag, std::size_t... I>
auto construct(const arguments& a, std::index_sequence<I...>) {
  return typename Tag::template type<T>(T(a[I])...);
}

// The family over any scalar T.
template <class T, class Tag>
auto make(const arguments& a) {
  using family = typename Tag::template type<double>;
  constexpr std::size_t count = family::parameters.size() + (family::shape_invariant ? 0 : 1);
  return construct<T, Tag>(a, std::make_index_sequence<count>());
}

// visit.operator()<Tag>(arguments) for every family and example, or for those whose density is a function: a law that
// integrates or inverts it says nothing of a ring.
enum class which { all, with_a_density };
template <class Visitor>
void each(const Visitor& visit, which chosen = which::all) {
  std::apply(
      [&](auto... tags) {
        const auto one = [&]<class Tag>(Tag) {
          if (Tag::template type<double>::singular && chosen == which::with_a_density) return;
          for (const arguments& a : examples<Tag>()) visit.template operator()<Tag>(a);
        };
        (one(tags), ...);
      },
      microfacet::all_families{});
}

}  // namespace families
