// How each family is traced: by its closed forms where they are short, else by tables.
#pragma once

#include "traced_tables.hpp"
#include "variant.hpp"

#include "microfacet/family/all.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::plugin {

using tables = traced_tables<Float>;

// Closed forms, and a table of the one inverse that sampling needs besides.
template <class Closed>
class with_table : public Closed {
 public:
  static constexpr bool always_composes = true;
  template <class... Arguments>
  explicit with_table(const tables& t, const Arguments&... arguments) : Closed(arguments...), tables_(&t) {}

  Float excess_radius(const Float& v) const { return tables_->visible.excess_radius(v); }
  // What solves without the table.
  void sf_over_density() const = delete;
  void closed_slopes() const = delete;

 private:
  const tables* tables_;
};

// The same, where the projected area costs more than its table.
template <class Closed>
class with_table_of_excess : public with_table<Closed> {
 public:
  template <class... Arguments>
  explicit with_table_of_excess(const tables& t, const Arguments&... arguments)
      : with_table<Closed>(t, arguments...), prepared_(t) {}

  Float slope_excess(const slope<Float>& x) const { return prepared_.slope_excess(x); }
  fraction<Float> sigma_below(const Float& c, const double_double<Float>& s2) const {
    return prepared_.sigma_below(c, s2);
  }

 private:
  tabulated<Float, tables> prepared_;
};

// A closed density, and tables for all else.
template <class Closed>
class with_tables : public tabulated<Float, tables> {
 public:
  template <class... Arguments>
  explicit with_tables(const tables& t, const Arguments&... arguments)
      : tabulated<Float, tables>(t), closed_(arguments...) {}
  Float D(const Float& z, const double_double<Float>& h2) const { return closed_.D(z, h2); }

 private:
  Closed closed_;
};

// Parameters: of the density in standard space.
template <class Closed>
struct traced {
  static constexpr bool has_tables = false;
  static Closed make(const tables*, const Float&, const Float&) { return Closed(); }
};
template <>
struct traced<beckmann<Float>> {
  static constexpr bool has_tables = true;
  static auto make(const tables* t, const Float&, const Float&) { return with_table<beckmann<Float>>(*t); }
};
template <>
struct traced<student_t<Float>> {
  static constexpr bool has_tables = true;
  static auto make(const tables* t, const Float&, const Float& shape) {
    return with_table_of_excess<student_t<Float>>(*t, shape);
  }
};
template <>
struct traced<gtr<Float>> {
  static constexpr bool has_tables = true;
  static auto make(const tables* t, const Float& alpha, const Float& shape) {
    return with_tables<gtr<Float>>(*t, alpha, shape);
  }
};
template <>
struct traced<bessel_k<Float>> {
  static constexpr bool has_tables = true;
  static auto make(const tables* t, const Float&, const Float&) { return tabulated<Float, tables>(*t); }
};

}  // namespace microfacet::plugin
