// The scalar that records. The headers run on it once, and what they do is left as a graph: in the format of Real for
// the choice of coefficients, whatever computes it later.
//
// A number may carry derivatives along, in as many directions as the inputs have that vary: forward differentiation.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/format.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/record/logic.hpp"

namespace microfacet::record {

struct mask {
  int id;

  mask() : mask(false) {}
  explicit mask(bool truth) : id(here().literal(truth)) {}
  static mask of(int id) { return mask(id, 0); }

  friend mask operator&(const mask& a, const mask& b) {
    return of(of_masks(operation::logical_and, a.id, b.id));
  }
  friend mask operator|(const mask& a, const mask& b) {
    return of(of_masks(operation::logical_or, a.id, b.id));
  }
  friend mask operator!(const mask& a) { return of(opposite(a.id)); }
  // Unknown lanes may be any.
  friend bool any_lane(const mask& m) { return assumption::truth_of(m.id).value_or(true); }
  friend mask select(const mask& m, const mask& a, const mask& b) {
    return of(chosen(kind::mask, m.id, a.id, b.id));
  }

 private:
  mask(int i, int) : id(i) {}
};

struct integer {
  int id;

  integer() : integer(0) {}
  template <std::integral A>
  explicit integer(A x) : id(here().literal(static_cast<std::int64_t>(x))) {}
  static integer of(int id) {
    integer x;
    x.id = id;
    return x;
  }

#define MICROFACET_RECORD(SYMBOL, NAME)                                \
  friend integer operator SYMBOL(const integer& a, const integer& b) { \
    return of(of_integer(operation::NAME, a.id, b.id));                \
  }
  MICROFACET_RECORD(+, add)
  MICROFACET_RECORD(-, subtract)
  MICROFACET_RECORD(&, logical_and)
  MICROFACET_RECORD(|, logical_or)
#undef MICROFACET_RECORD
  friend integer operator<<(const integer& a, int n) {
    return of(of_integer(operation::shift_left, a.id, integer(n).id));
  }
  friend integer operator>>(const integer& a, int n) {
    return of(of_integer(operation::shift_right, a.id, integer(n).id));
  }
  friend integer shift_right(const integer& a, const integer& n) {
    return of(of_integer(operation::shift_right_logical, a.id, n.id));
  }
  friend mask operator==(const integer& a, const integer& b) {
    return mask::of(of_comparison(operation::equal, a.id, b.id));
  }
  friend mask operator!=(const integer& a, const integer& b) {
    return mask::of(of_comparison(operation::not_equal, a.id, b.id));
  }
  friend mask operator>(const integer& a, const integer& b) {
    return mask::of(of_comparison(operation::greater, a.id, b.id));
  }
  friend integer select(const mask& m, const integer& a, const integer& b) {
    return of(chosen(kind::integer, m.id, a.id, b.id));
  }
};

template <std::floating_point Real>
class number {
 public:
  number() : number(0) {}
  template <class A>
    requires std::is_arithmetic_v<A>
  explicit number(A x) : id_(here().literal(static_cast<double>(x))) {}
  static number of(int id) {
    number x(0);
    x.id_ = id;
    return x;
  }
  // An input, of which direction k differentiates.
  static number varying(int id, std::size_t k) {
    return of(id).with_derivatives(k + 1, [&](std::size_t i) { return number(i == k ? 1 : 0); });
  }

  int id() const { return id_; }
  // The value without derivatives, and the derivatives in turn, 0 beyond the last one.
  number value() const { return of(id_); }
  std::size_t directions() const { return derivatives_.size(); }
  number derivative(std::size_t k) const { return k < directions() ? of(derivatives_[k]) : number(0); }
  template <class Derivative>
  number with_derivatives(std::size_t directions, const Derivative& derivative) const {
    number x = value();
    for (std::size_t k = 0; k < directions; ++k) x.derivatives_.push_back(derivative(k).id_);
    return x;
  }

  // A function of one number or two, and its slopes.
  template <class Slope>
  static number function(operation op, const number& a, const Slope& slope) {
    const number value = of(of_real(op, a.id_));
    return value.with_derivatives(a.directions(), [&](std::size_t k) {
      const number d = a.derivative(k);
      return detail::known_as(d.id_, 0) ? d : slope(value) * d;
    });
  }
  template <class Derivative>
  static number function(operation op, const number& a, const number& b, const Derivative& derivative) {
    const number value = of(of_real(op, a.id_, b.id_));
    return value.with_derivatives((std::max)(a.directions(), b.directions()), [&](std::size_t k) {
      return derivative(value, a.derivative(k), b.derivative(k));
    });
  }

  friend number operator+(const number& a) { return a; }
  friend number operator-(const number& a) {
    return function(operation::negate, a, [](const number&) { return number(-1); });
  }
  friend number operator+(const number& a, const number& b) {
    return function(operation::add, a, b,
                    [](const auto&, const number& da, const number& db) { return da + db; });
  }
  friend number operator-(const number& a, const number& b) {
    return function(operation::subtract, a, b,
                    [](const auto&, const number& da, const number& db) { return da - db; });
  }
  friend number operator*(const number& a, const number& b) {
    return function(operation::multiply, a, b, [&](const auto&, const number& da, const number& db) {
      return da * b.value() + a.value() * db;
    });
  }
  friend number operator/(const number& a, const number& b) {
    return function(operation::divide, a, b, [&](const number& q, const number& da, const number& db) {
      return (da - q * db) / b.value();
    });
  }
  number& operator+=(const number& b) { return *this = *this + b; }
  number& operator-=(const number& b) { return *this = *this - b; }
  number& operator*=(const number& b) { return *this = *this * b; }
  number& operator/=(const number& b) { return *this = *this / b; }

#define MICROFACET_RECORD(SYMBOL, NAME)                            \
  friend mask operator SYMBOL(const number& a, const number& b) {  \
    return mask::of(of_comparison(operation::NAME, a.id_, b.id_)); \
  }
  MICROFACET_RECORD(<, less)
  MICROFACET_RECORD(<=, less_equal)
  MICROFACET_RECORD(>, greater)
  MICROFACET_RECORD(>=, greater_equal)
  MICROFACET_RECORD(==, equal)
  MICROFACET_RECORD(!=, not_equal)
#undef MICROFACET_RECORD

 private:
  int id_;
  std::vector<int> derivatives_;
};

}  // namespace microfacet::record

template <class Real>
struct microfacet::scalar_traits<microfacet::record::number<Real>> {
  using real = Real;
};
template <class Real>
struct microfacet::elementary::integers_of<microfacet::record::number<Real>> {
  using type = microfacet::record::integer;
};
template <class Real>
inline constexpr bool microfacet::records<microfacet::record::number<Real>> = true;
// Nothing is lifted: results below the normal numbers are zero.
template <class Real>
inline constexpr int microfacet::lift<microfacet::record::number<Real>> = 0;
