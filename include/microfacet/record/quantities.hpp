// What is recorded: quantities of a distribution and of materials, by their names.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "microfacet/record/finish.hpp"
#include "microfacet/record/materials.hpp"
#include "microfacet/record/request.hpp"
#include "microfacet/record/sums.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/sample_normal.hpp"

namespace microfacet::record {

namespace detail {

template <class T, class Distribution>
inline constexpr bool sees_cosines =
    std::is_same_v<std::remove_cvref_t<decltype(std::declval<Distribution>().shape())>, isotropic_shape<T>>;

// Of slopes, and of one direction.
template <class Real, class Distribution>
bool record_of_distribution(const recorder<Real>& r, const Distribution& ndf) {
  const std::string& q = r.asked().quantity;
  if (q == "P22") return r.give("value", ndf.P22(r.input("p"), r.input("q"))), true;
  if (q == "P2") return r.give("value", ndf.P2(r.input("p"))), true;
  if (q == "slope_cdf") return r.give("value", ndf.slope_cdf(r.input("p"))), true;
  const auto of_direction = [&](const auto& named) {
    if (q == "D") return r.give("value", ndf.D_of_unit(named("m"))), true;
    if (q == "sigma") return r.give("value", ndf.sigma(named("w"))), true;
    if (q == "Lambda") return r.give("value", ndf.Lambda(named("w"))), true;
    if (q == "G1") return r.give("value", ndf.G1(named("w"))), true;
    return false;
  };
  if (!r.asked().of_cosine) return of_direction([&](const char* name) { return r.direction(name); });
  if constexpr (sees_cosines<number<Real>, Distribution>)
    return of_direction([&](const char*) { return cosine<number<Real>>(r.input("u")); });
  return false;
}

// Of normals and of pairs of directions.
template <class Real, class Distribution>
bool record_of_directions(const recorder<Real>& r, const Distribution& ndf) {
  const std::string& q = r.asked().quantity;
  if (q == "pdf") return r.give("value", ndf.pdf(r.direction("m"))), true;
  if (q == "D_visible" || q == "pdf_visible")
    return r.give("value", ndf.D_visible(r.direction("m"), r.direction("w"))), true;
  if (q == "G2") return r.give("value", ndf.G2(r.direction("wi"), r.direction("wo"))), true;
  if (q == "sample") return r.give("m", sample_normal(ndf, r.input("xi.x"), r.input("xi.y"))), true;
  for (const bool mixture : {false, true})
    if (q == (mixture ? "sample_visible_mixture" : "sample_visible"))
      return r.give("m", visible_normal(r, ndf, r.direction("w"), mixture)), true;
  return false;
}

template <class Real, class Family>
bool record_of_family(const recorder<Real>& r, const Family& family) {
  using T = number<Real>;
  const auto record = [&](const auto& shape) {
    const ndf<Family, T, std::remove_cvref_t<decltype(shape)>> distribution(family, shape);
    if constexpr (sees_cosines<T, decltype(distribution)>)
      if (r.asked().quantity == "survival")
        return r.give("value", survival(distribution, r.input("r"))), true;
    return record_of_distribution(r, distribution) || record_of_directions(r, distribution) ||
           record_of_materials(r, distribution);
  };
  if (r.asked().has("alpha_x")) {
    const elementary::circle<T> axes = circle_of_turns(T(r.parameter("rotation") * T(1 / (2 * pi))));
    return record(
        anisotropic_shape<T>(r.parameter("alpha_x"), r.parameter("alpha_y"), axes.cosine, axes.sine));
  }
  return record(isotropic_shape<T>(Family::shape_invariant ? r.parameter("alpha") : T(1)));
}

}  // namespace detail

// Records a quantity of a family: its density is made by `make` from a function that gives a parameter by its name.
template <class Real, class Make>
graph recorded(const request& asked, bool native, const Make& make) {
  graph g;
  g.in_float64 = sizeof(Real) == 8, g.native = native;
  const recording on(g);
  const recorder<Real> r(asked);
  if (!detail::record_of_family(r, make([&](const std::string& name) { return r.parameter(name); })))
    throw std::invalid_argument("no quantity is called " + asked.quantity);
  return finished(g);
}

}  // namespace microfacet::record
