// What a family is: an isotropic density of slopes in standard space (roughness 1).
//
// It states its joint density P22, the probability `survival` that the squared slope exceeds r2 and the inverse
// of that, and three functions of the slope along an axis. Everything else (sigma, Lambda, G1, G2, sampling,
// shape) is written once for all families, in smith/. A family may state more, in parts that have names.
#pragma once

#include <array>
#include <concepts>

#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/slope.hpp"

namespace microfacet {

// Functions of a density, to be combined with |: what a quantity needs, and what it pays to tabulate.
enum radial_function : unsigned {
  of_P22 = 1,
  of_survival = 2,
  of_radius = 4,
  of_P2 = 8,
  of_slope_sf = 16,
  of_mean_excess = 32,
  of_all = 63,
  of_visible = 64  // what visible normals need besides
};

// What a family may state besides, each part a concept of its name: where it is stated the rest of the library
// takes the short way. A family lists its parts in `radial_defaults`, and radial_family holds the list against
// the members, so that a misspelt member does not compile.
//
// clang-format off
template <class F>
concept scaled_P2 = requires(const F f, typename F::scalar c, slope<typename F::scalar> t) { f.P2(t, c); };  // c P2(t), where P2 underflows
template <class F>
concept P22_by_slope = requires(const F f, typename F::scalar r) { f.P22_of_slope(r); };   // P22 at r, whose square underflows
template <class F>
concept survival_by_slope = requires(const F f, typename F::scalar r) { f.survival_of_slope(r); };
template <class F>
concept direct_radius = requires(const F f, typename F::scalar xi) { f.radius(xi); };      // the root of radius2
template <class F>
concept radius_by_odds = requires(const F f, typename F::scalar x) { f.radius_at_odds(x); };  // at xi = x/(1 + x)
template <class F>
concept scaled_excess = requires(const F f, slope<typename F::scalar> x, typename F::scalar c) { f.mean_excess(x, c); };  // c mean_excess(x), where mean_excess underflows
template <class F>
concept scaled_sigma = requires(const F f, typename F::scalar c, double_double<typename F::scalar> s2) { f.sigma_below(c, s2); };  // 2^lift s J(|c|/s), a fraction
// Visible normals (smith/visible/): the facet or both slopes at once ...
template <class F>
concept facet_sampling = requires(const F f, cap_direction<typename F::scalar> w, typename F::scalar x) { f.visible_facet(w, x, x); };
template <class F>
concept bounded_facet_sampling = facet_sampling<F> && requires(const F f, cap_direction<typename F::scalar> w, typename F::scalar x) { f.bounded_facet(w, x, x, x); };
template <class F>
concept slope_sampling = requires(const F f, typename F::scalar x) { f.visible_slopes_of(x, x, x, x); };
template <class F>  // where has_closed_slopes() holds, at a shape for which draws_in_closed_form(shape) does
concept special_slope_sampling = requires(const F f, typename F::scalar x) { F::draws_in_closed_form(0.0); f.has_closed_slopes(); f.closed_slopes(x, x, x); };
// ... or quotients of tails by P2(t), and their inverses. The slope across is independent of that in the plane
// of incidence (by its quantile), or the rest of one in three dimensions.
template <class F>
concept quantile_across = requires(const F f, typename F::scalar xi) { f.across_by_quantile(xi); };
template <class F>
concept tail_quotients = requires(const F f, typename F::scalar t) {
  f.sf_over_density(t); f.excess_over_density(t, t); f.moment_over_density(t, t);
  f.score(t, t); f.log_density_ratio(t, t); f.survival_radius(t); f.moment_radius(t, t); f.inverse_tail();
  f.is_near(t, t, t); f.near_moments(t, t);
} && (quantile_across<F> || requires(const F f, typename F::scalar t) { f.across(t, t); });
template <class F>  // where an inversion in float32 starts (smith/visible/started.hpp)
concept started_inversion = requires(const F f, typename F::scalar t) { f.start(); f.over_density(t); };
// The mixture scheme without iteration: M(P) = (1 - xi) M(t), the slope across, and in float32 t at t/J(t).
template <class F>
concept mixture_sampling = requires(const F f, typename F::scalar t) { f.moment_beyond(t, t); f.across_of_tables(t, t, t); };
template <class F>
concept excess_quantile = requires(const F f, typename F::scalar v) { f.excess_radius(v); };
template <class F>  // the same in closed form, for float32: where programs are recorded, iterations are dear
concept closed_excess_quantile = requires(const F f, typename F::scalar v) { f.closed_excess_radius(v); };
template <class F>  // tables from which iterations start: their error is not bounded
concept tabulated_inverses = requires(const F f) { f.visible(); };
template <class F>  // whether P2 falls everywhere, for these parameters; elsewhere it does for all
concept conditional_fall = requires(const F f) { f.falls(); };
template <class F>  // whether float32 reaches all slopes that are drawn at this shape
concept float32_sampling_range = requires(double shape) { { F::sampling_fits_float32(shape) } -> std::same_as<bool>; };

namespace part {
enum parts : unsigned {
  scaled_P2 = 1, P22_by_slope = 1 << 1, survival_by_slope = 1 << 2, direct_radius = 1 << 3, radius_by_odds = 1 << 4,
  scaled_excess = 1 << 5, scaled_sigma = 1 << 6, facet_sampling = 1 << 7, bounded_facet_sampling = 1 << 8,
  slope_sampling = 1 << 9, special_slope_sampling = 1 << 10, quantile_across = 1 << 11, tail_quotients = 1 << 12,
  mixture_sampling = 1 << 13, excess_quantile = 1 << 14, conditional_fall = 1 << 15, float32_sampling_range = 1 << 16,
  started_inversion = 1 << 17, tabulated_inverses = 1 << 18, closed_excess_quantile = 1 << 19
};
}

template <class F, part::parts Part, bool HasItsMembers>
concept agrees = HasItsMembers == ((F::parts & Part) != 0);
template <class F>
concept has_the_parts_it_states =
    agrees<F, part::scaled_P2, scaled_P2<F>> && agrees<F, part::P22_by_slope, P22_by_slope<F>> &&
    agrees<F, part::survival_by_slope, survival_by_slope<F>> && agrees<F, part::direct_radius, direct_radius<F>> &&
    agrees<F, part::radius_by_odds, radius_by_odds<F>> && agrees<F, part::scaled_excess, scaled_excess<F>> &&
    agrees<F, part::scaled_sigma, scaled_sigma<F>> && agrees<F, part::facet_sampling, facet_sampling<F>> &&
    agrees<F, part::bounded_facet_sampling, bounded_facet_sampling<F>> &&
    agrees<F, part::slope_sampling, slope_sampling<F>> &&
    agrees<F, part::special_slope_sampling, special_slope_sampling<F>> &&
    agrees<F, part::quantile_across, quantile_across<F>> && agrees<F, part::tail_quotients, tail_quotients<F>> &&
    agrees<F, part::mixture_sampling, mixture_sampling<F>> && agrees<F, part::excess_quantile, excess_quantile<F>> &&
    agrees<F, part::closed_excess_quantile, closed_excess_quantile<F>> &&
    agrees<F, part::tabulated_inverses, tabulated_inverses<F>> && agrees<F, part::conditional_fall, conditional_fall<F>> &&
    agrees<F, part::float32_sampling_range, float32_sampling_range<F>> &&
    agrees<F, part::started_inversion, started_inversion<F>>;

template <class F>
concept closed_visible_sampling = facet_sampling<F> || slope_sampling<F>;

// Of what stands for a family: the radius at a depth -log(survival), or at a survival, and whether visible
// normals always come from the mixture scheme's inverses.
template <class F>
concept radius_by_depth = requires(const F f, typename F::scalar depth) { f.survival_radius(depth); };
template <class F>
concept radius_by_survival = requires(const F f, typename F::scalar rest) { f.radius_at_survival(rest); };
template <class F>
concept always_composes = requires { requires F::always_composes; };

template <class F>
concept radial_family = has_the_parts_it_states<F> && requires(const F f, typename F::scalar xi, double_double<typename F::scalar> r2, slope<typename F::scalar> t) {
  F::name;                                                     // one string everywhere
  F::sources;                                                  // keys of references.bib
  F::parameters;                                               // std::array<parameter, n>: the shape parameters
  { f.zero_or_nan() } -> std::convertible_to<typename F::scalar>;    // 0, nan where a parameter lies outside its domain
  { F::shape_invariant } -> std::convertible_to<bool>;         // whether roughness is a stretch of the slopes
  { f.P22(r2) } -> std::convertible_to<typename F::scalar>;    // joint density of slopes at squared slope r2
  { f.D(xi, r2) } -> std::convertible_to<typename F::scalar>;  // D(z, h2) = P22(h2/z^2)/z^4, never over- or underflowing
  { f.survival(r2) } -> std::convertible_to<typename F::scalar>;     // Pr(slope^2 > r2)
  { f.radius2(xi) } -> std::convertible_to<typename F::scalar>;      // survival(radius2(xi)) = 1 - xi
  { f.P2(t) } -> std::convertible_to<typename F::scalar>;            // density of the slope along an azimuth
  { f.slope_sf(t) } -> std::convertible_to<typename F::scalar>;      // Pr(slope along an azimuth > t)
  { f.mean_excess(t) } -> std::convertible_to<typename F::scalar>;  // int_t^inf slope_sf = E[(slope - t)_+], t >= 0
};
// clang-format on

// What most families say alike. Parts: what a family states besides. Tabulate: the functions for which a table is
// faster; a family whose survival is one of them computes in float64 where its parameters vary.
template <class T, unsigned Parts = 0, unsigned Tabulate = 0>
struct radial_defaults {
  using scalar = T;
  static constexpr unsigned parts = Parts, tabulate = Tabulate;
  static constexpr bool float32_arithmetic = (Tabulate & of_survival) == 0;
  // Whether a graph in float32 may have any shape as an argument: its own forms reach 2e-5 there.
  static constexpr bool float32_graphs = true;
  // Whether arrays are computed from one table for all: of a family without shape parameters, whose functions may
  // then be long. The functions themselves are called to make the tables.
  static constexpr bool tables_alone = false;
  // Whether the tails are no powers at slopes of exp(40): logarithms take longer tables.
  static constexpr bool slow_tails = false;
  static constexpr bool shape_invariant = true;
  // Whether all facets have one slope: P22 is zero or infinite, and nothing can be fitted to it.
  static constexpr bool singular = false;
  static constexpr std::array<parameter, 0> parameters{};
  // Uniforms that a visible normal takes, by the scheme that is continuous in them and by the mixture.
  static constexpr int visible_dimensions =
      (Parts & (part::facet_sampling | part::quantile_across)) != 0 ? 2 : 3;
  static constexpr int mixture_dimensions =
      visible_dimensions + ((Parts & (part::facet_sampling | part::slope_sampling)) != 0 ? 0 : 1);

  MICROFACET_INLINE T zero_or_nan() const { return T(0); }
};

// A family by its name, whatever its numbers are.
template <template <class> class Family>
struct family_tag {
  template <class T>
  using type = Family<T>;
};

}  // namespace microfacet
