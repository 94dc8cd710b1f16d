// How each family is traced: by its closed forms where they are short, else by tables.
#pragma once

#include "traced_tables.hpp"
#include "variant.hpp"
#include "ways.hpp"

#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::plugin {

using tables = traced_tables<Float>;

// Closed forms that draw visible normals by the mixture alone: what solves for them is left out.
template <class Closed>
class composed : public Closed {
 public:
  static constexpr bool always_composes = true;
  using Closed::Closed;
  void sf_over_density() const = delete;
  void closed_slopes() const = delete;
};
template <class Closed>
class composed_in_closed_form : public composed<Closed> {
 public:
  using composed<Closed>::composed;
  Float excess_radius(const Float& v) const { return this->closed_excess_radius(v); }
};

// The same, with tables of the mean excess, which costs more, and of its inverse.
template <class Closed>
class with_table_of_excess : public composed<Closed> {
 public:
  template <class... Arguments>
  explicit with_table_of_excess(const tables& t, const Arguments&... arguments)
      : composed<Closed>(arguments...), tables_(&t), tabulated_(t) {}

  Float excess_radius(const Float& v) const { return tables_->visible.excess_radius(v); }
  Float mean_excess(const slope<Float>& x) const { return tabulated_.mean_excess(x); }
  fraction<Float> sigma_below(const Float& c, const double_double<Float>& s2) const {
    return tabulated_.sigma_below(c, s2);
  }

 private:
  const tables* tables_;
  tabulated<Float, tables> tabulated_;
};

// A closed density, and tables for all else.
template <class Closed>
class with_tables : public tabulated<Float, tables> {
 public:
  with_tables(const tables& t, const Closed& closed) : tabulated<Float, tables>(t), closed_(closed) {}
  Float D(const Float& z, const double_double<Float>& h2) const { return closed_.D(z, h2); }

 private:
  Closed closed_;
};

// Parameters: of the density in standard space.
template <class Closed>
auto traced(const tables* t, const Float& alpha, const Float& shape) {
  constexpr way by = way_of<Closed>();
  if constexpr (by == way::closed) {
    return made<Closed>(alpha, shape);
  } else if constexpr (by == way::composed) {
    return made<composed_in_closed_form<Closed>>(alpha, shape);
  } else if constexpr (by == way::table_of_excess) {
    return made<with_table_of_excess<Closed>>(alpha, shape, *t);
  } else if constexpr (by == way::closed_density) {
    return with_tables<Closed>(*t, made<Closed>(alpha, shape));
  } else {
    return tabulated<Float, tables>(*t);
  }
}

}  // namespace microfacet::plugin
