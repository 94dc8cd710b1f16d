// A density as tables: whatever it is, it costs the same.
//
//   radial_tables<float> tables;
//   tables.build(bessel_k<double>(0.7), of_P22 | of_mean_excess);
//   tabulated<pack<float, 64>> density(tables);  // a radial_family on packs
#pragma once

#include <array>
#include <string_view>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/family/radial.hpp"
#include "microfacet/tabulated/radial_tables.hpp"

namespace microfacet {

namespace detail {

template <class Tables>
inline constexpr unsigned parts_of_tables =
    part::scaled_P2 | part::direct_radius | part::radius_by_odds | part::scaled_sigma |
    part::tabulated_inverses | part::mixture_sampling |
    (Tables::searches ? 0U : part::P22_by_slope | part::survival_by_slope) |
    (Tables::single ? part::excess_quantile : 0U);

}  // namespace detail

// On scalars R, from tables that must outlive it.
template <class R, class Tables = radial_tables<typename scalar_traits<R>::real>>
class tabulated : public radial_defaults<R, detail::parts_of_tables<Tables>> {
 public:
  using tables = Tables;
  static constexpr std::string_view name = "tabulated";
  static constexpr std::array<std::string_view, 0> sources{};
  static constexpr bool always_composes = tables::always_composes, searches = tables::searches;

  explicit tabulated(const tables& t) : t_(&t) {}

  MICROFACET_INLINE R P22(const double_double<R>& r2) const {
    return square(R(t_->root_D(r2) / (R(1) + r2.high)));
  }
  MICROFACET_INLINE R P22_of_slope(const R& r) const
    requires(!searches)
  {
    return square(R(t_->root_D.of_root(r) / (R(1) + r * r)));
  }
  MICROFACET_INLINE R D(const R& z_argument, const double_double<R>& h2) const {
    const R z = maximum(z_argument, R(4) * sqrt(smallest<R>()));
    const double_double<R> z2 = two_prod(z, z);
    return square(R(t_->root_D(ratio(h2, z2, R(R(1) / z2.high))) / (z2.high + h2.high)));
  }
  MICROFACET_INLINE R survival_of_slope(const R& r) const
    requires(!searches)
  {
    return at_most_one(R(t_->survival.of_root(r)), r);
  }
  MICROFACET_INLINE R survival(const double_double<R>& r2) const {
    return at_most_one(R(t_->survival(r2)), r2.high);
  }
  MICROFACET_INLINE R radius(const R& xi) const {
    return t_->radius(quotient(double_double<R>(xi), fast_two_sum(R(1), R(-xi))));
  }
  // At a probability to be exceeded, for numbers whose expm1 is dear.
  MICROFACET_INLINE R radius_at_survival(const R& rest) const
    requires always_composes
  {
    return t_->radius(double_double<R>((R(1) - rest) / rest));
  }
  MICROFACET_INLINE R radius_at_odds(const R& odds) const { return t_->radius(double_double<R>(odds)); }
  MICROFACET_INLINE const auto& visible() const { return t_->visible; }
  // For smith/visible/sample_visible_mixture.hpp: J(t)/t = 1/v, M(P) = (1 - xi) M(t), and the slope across.
  MICROFACET_INLINE bool samples_from_tables() const { return t_->visible.complete; }
  MICROFACET_INLINE R excess_radius(const R& v) const
    requires tables::single
  {
    return t_->visible.excess_radius(double_double<R>(v));
  }
  MICROFACET_INLINE R moment_beyond(const R& t, const R& xi) const {
    const auto& v = t_->visible;
    const R odds = R(v.first_moment) / (v.moment(double_double<R>(t)) * (R(1) - xi)) - R(1);
    return maximum(R(v.moment_radius(double_double<R>(minimum(odds, R(1e37))))), t);
  }
  MICROFACET_INLINE R across_of_tables(const R& along, const R& xi, const R& turn) const {
    const auto& v = t_->visible;
    const auto by_length = [&] {
      const R density = maximum(P2(slope<R>(along)), smallest<R>()), start(v.inverse_P2);
      const R inverse = minimum(R(R(1) / (density * (R(1) - xi)) - start), R(1e37));
      const R length = v.marginal_radius(double_double<R>(inverse));
      const R rest = maximum(R((length - along) * (length + along)), R(0));
      return R(sqrt(rest) * elementary::cos_sin_of_turns(R(R(0.5) * turn)).cosine);
    };
    if constexpr (requires { v.shells; }) {
      if (!v.falls()) {
        const auto by_shells = [&] {
          return R(select(turn < R(0.5), R(1), R(-1)) * v.shells.across(R(abs(along)), xi));
        };
        return select_lazy(abs(along) < R(v.fall), by_shells, by_length);
      }
    }
    return by_length();
  }
  MICROFACET_INLINE R radius2(const R& xi) const { return square(radius(xi)); }
  MICROFACET_INLINE R P2(const slope<R>& t, const R& factor = R(1)) const {
    return square(R(t_->root_P2(abs(t.value)) * sqrt(factor)));
  }
  MICROFACET_INLINE R slope_sf(const slope<R>& t) const {
    return symmetric_sf(t, [this](const slope<R>& x) { return t_->slope_sf(x.value); });
  }
  // s J(|c|/s) of smith/masking.hpp, without what mean_excess does not look at.
  MICROFACET_INLINE fraction<R> sigma_below(const R& c, const double_double<R>& s2) const {
    const R divisor = maximum(s2.high, smallest<R>()), reciprocal = R(1) / divisor;
    const double_double<R> x2 = ratio(two_prod(c, c), double_double<R>(divisor, low_of(s2)), reciprocal);
    return {lifted(sqrt(s2.high)) * t_->mean_excess(x2), R(1)};
  }
  MICROFACET_INLINE R mean_excess(const slope<R>& x) const { return t_->mean_excess(x.squared); }

 private:
  // A probability to exceed x; the last piece of a table ends before infinity.
  MICROFACET_INLINE static R at_most_one(const R& found, const R& x) {
    return select(x <= largest<R>(), minimum(found, R(1)), R(R(0) * found));
  }
  // a/b, given 1/b.high; an infinite quotient is alone.
  MICROFACET_INLINE static double_double<R> ratio(const double_double<R>& a, const double_double<R>& b,
                                                  const R& reciprocal) {
    const R q = a.high * reciprocal;
    if constexpr (one_number<R>) return q;
    const R rest = multiply_add(-q, b.high, a.high) + multiply_add(-q, low_of(b), low_of(a));
    return {q, select(q <= largest<R>(), R(rest * reciprocal), R(0))};
  }

  const tables* t_;
};

// A density of the user's own.
template <class R>
using tabulated_user_density = tabulated<R, user_density_tables<typename scalar_traits<R>::real>>;

static_assert(radial_family<tabulated<float>> && radial_family<tabulated<double>> &&
              radial_family<tabulated_user_density<float>> && radial_family<tabulated_user_density<double>>);

}  // namespace microfacet
