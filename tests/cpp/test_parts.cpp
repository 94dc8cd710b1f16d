// A family whose members and parts do not agree is none: a misspelt member does not compile.

#include "check.hpp"
#include "microfacet/family/all.hpp"

namespace {

namespace mf = microfacet;

static_assert(mf::radial_family<mf::ggx<double>> && mf::radial_family<mf::beckmann<float>>);

// What a part needs is there under another name, or takes other arguments.
struct misspelt_sigma : mf::ggx<double> {
  void sigma_below() const = delete;
  mf::fraction<double> sigma_bellow(double c, mf::double_double<double> s2) const {
    return mf::ggx<double>::sigma_below(c, s2);
  }
};
static_assert(!mf::scaled_sigma<misspelt_sigma> && !mf::radial_family<misspelt_sigma>);

struct misspelt_quotient : mf::beckmann<double> {
  void near_moments(double) const = delete;
};
static_assert(!mf::tail_quotients<misspelt_quotient> && !mf::radial_family<misspelt_quotient>);

struct misspelt_mixture : mf::student_t<double> {
  void moment_beyond(double) const = delete;
};
static_assert(!mf::mixture_sampling<misspelt_mixture> && !mf::radial_family<misspelt_mixture>);

// A member that the list of parts does not name.
struct unlisted_radius : mf::ggx<double> {
  double radius(double xi) const { return std::sqrt(radius2(xi)); }
};
static_assert(mf::direct_radius<unlisted_radius> && !mf::radial_family<unlisted_radius>);

// A required member that is misspelt.
struct misspelt_survival : mf::ggx<double> {
  void survival(double, double) const = delete;
};
static_assert(!mf::radial_family<misspelt_survival>);

}  // namespace

TEST(parts_say_how_many_uniforms_a_visible_normal_takes) {
  CHECK(mf::ggx<double>::visible_dimensions == 2 && mf::ggx<double>::mixture_dimensions == 2);
  CHECK(mf::beckmann<double>::visible_dimensions == 2 && mf::beckmann<double>::mixture_dimensions == 3);
  CHECK(mf::k0<double>::visible_dimensions == 3 && mf::k0<double>::mixture_dimensions == 3);
  CHECK(mf::gtr<double>::visible_dimensions == 3 && mf::gtr<double>::mixture_dimensions == 4);
}
