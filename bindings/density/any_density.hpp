// A density in double precision whatever its family, for what is made of it by fits: these are long, and compiled
// once (table_kernels.hpp). A call more for each pack of samples costs nothing beside the sample.
#pragma once

#include "bindings/loop/lanes.hpp"
#include "microfacet/tabulated/radial_tables.hpp"

namespace microfacet::bindings {

// The functions of family/radial.hpp that tables are built from.
class any_density {
 public:
  using scalar = lanes<double>;
  using sum = double_double<scalar>;

  virtual scalar P22(const sum& r2) const = 0;
  virtual scalar P22_of_slope(const scalar& r) const = 0;
  virtual scalar D(const scalar& z, const sum& h2) const = 0;
  virtual scalar survival(const sum& r2) const = 0;
  virtual scalar radius(const scalar& xi) const = 0;
  virtual scalar P2(const slope<scalar>& t) const = 0;
  virtual scalar slope_sf(const slope<scalar>& t) const = 0;
  virtual scalar mean_excess(const slope<scalar>& t) const = 0;

  const bool slow_tails;

 protected:
  explicit any_density(bool slow) : slow_tails(slow) {}
  ~any_density() = default;
};

template <class Family>
class any_density_of final : public any_density {
 public:
  explicit any_density_of(const Family& family) : any_density(Family::slow_tails), family_(family) {}

  scalar P22(const sum& r2) const override { return family_.P22(r2); }
  scalar P22_of_slope(const scalar& r) const override {
    if constexpr (P22_by_slope<Family>) {
      return family_.P22_of_slope(r);
    } else {
      return family_.P22(sum(scalar(r * r)));
    }
  }
  scalar D(const scalar& z, const sum& h2) const override { return family_.D(z, h2); }
  scalar survival(const sum& r2) const override { return family_.survival(r2); }
  scalar radius(const scalar& xi) const override {
    if constexpr (direct_radius<Family>) {
      return family_.radius(xi);
    } else {
      return sqrt(family_.radius2(xi));
    }
  }
  scalar P2(const slope<scalar>& t) const override { return family_.P2(t); }
  scalar slope_sf(const slope<scalar>& t) const override { return family_.slope_sf(t); }
  scalar mean_excess(const slope<scalar>& t) const override { return family_.mean_excess(t); }

 private:
  Family family_;
};

template <class Real>
void build_tables(radial_tables<Real>& tables, const any_density& density, unsigned functions);

}  // namespace microfacet::bindings
