// Distributions of normals and their samplers, at any parameters, shapes, directions and uniforms.

#include "fuzz_family.hpp"
#include "microfacet/smith/sample_normal.hpp"
#include "microfacet/smith/visible/sample_visible_bounded.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"

namespace mf = microfacet;

namespace {

template <class T>
void require_normal(std::string_view what, const mf::vec3<T>& m) {
  fuzz::require_unit(what, m.x, m.y, m.z);
  fuzz::require_positive(what, static_cast<double>(m.z));
}

template <class T, class Family, class Tell>
void draw(const mf::ndf<Family, T>& ndf, const mf::vec3<T>& w, const std::array<T, 4>& xi, const Tell& tell) {
  tell("sample_normal", sample_normal(ndf, xi[0], xi[1]));
  tell("sample_visible", sample_visible(ndf, w, xi[0], xi[1], xi[2]));
  tell("sample_visible_mixture", sample_visible_mixture(ndf, w, xi[0], xi[1], xi[2], xi[3]));
  if constexpr (mf::bounded_facet_sampling<Family>)
    tell("sample_visible_bounded", sample_visible_bounded(ndf, w, xi[0], xi[1]));
}

// Whatever is given, in the domain or not.
template <class T, class Family>
void ask_anything(const Family& family, fuzz::input& in) {
  const mf::anisotropic_shape<T> shape(in.number<T>(), in.number<T>(), in.number<T>(), in.number<T>());
  const mf::ndf<Family, T> ndf(family, shape);
  const mf::vec3<T> w{in.number<T>(), in.number<T>(), in.number<T>()},
      m{in.number<T>(), in.number<T>(), in.number<T>()};
  fuzz::compute(ndf.D(m)), fuzz::compute(ndf.sigma(w)), fuzz::compute(ndf.Lambda(w)),
      fuzz::compute(ndf.G1(w));
  fuzz::compute(ndf.G2(w, m)), fuzz::compute(ndf.D_visible(m, w)), fuzz::compute(ndf.P22(w.x, w.y));
  fuzz::compute(ndf.slope_cdf(w.x)), fuzz::compute(ndf.P2(w.y));
  std::array<T, 4> xi;
  for (T& u : xi) u = in.number<T>();
  draw(ndf, w, xi, [](std::string_view, const mf::vec3<T>& n) { fuzz::compute(n); });
}

// Roughnesses, directions and uniforms of the domain.
template <class T, class Family>
void ask_sensibly(const Family& family, fuzz::input& in) {
  constexpr double reach = sizeof(T) == 4 ? 13 : 100;
  const T turn = T(2 * mf::pi) * in.uniform<T>();
  const T x = in.between<T>(-reach, reach), y = in.choice(2) ? x : in.between<T>(-reach, reach);
  const mf::anisotropic_shape<T> shape(x, y, std::cos(turn), std::sin(turn));
  const mf::ndf<Family, T> ndf(family, shape);
  const auto direction = [&in] {
    const mf::vec3<T> v{in.number<T>(), in.number<T>(), in.number<T>()};
    const T length = std::sqrt(mf::dot(v, v));
    return mf::vec3<T>{v.x / length, v.y / length, v.z / length};
  };
  const mf::vec3<T> w = direction(), m = direction();
  const auto number = [](const T& value) { return static_cast<double>(value); };
  const double all = 1 + 1e-5;
  fuzz::require_positive("D", number(ndf.D(m)));
  fuzz::require_positive("sigma", number(ndf.sigma(w)));
  fuzz::require_within("G1", number(ndf.G1(w)), 0, all);
  fuzz::require_within("G2", number(ndf.G2(w, m)), 0, all);
  fuzz::require_within("G2_uncorrelated", number(ndf.G2_uncorrelated(w, m)), 0, all);
  fuzz::require_positive("D_visible", number(ndf.D_visible(m, w)));
  fuzz::require_positive("P22", number(ndf.P22(w.x, w.y)));
  fuzz::require_within("slope_cdf", number(ndf.slope_cdf(w.x)), 0, all);
  std::array<T, 4> xi;
  for (T& u : xi) u = in.choice(4) ? in.uniform<T>() : in.number<T>();
  draw(ndf, w, xi, [](std::string_view what, const mf::vec3<T>& n) { require_normal(what, n); });
}

template <class T, class Tag>
void of_family(fuzz::input& in) {
  using family = typename Tag::template type<T>;
  const auto f = fuzz::family_of_numbers<family>(in);
  fuzz::judged = sizeof(T) > 4 || family::float32_arithmetic;
  in.choice(2) ? ask_sensibly<T>(f, in) : ask_anything<T>(f, in);
}

}  // namespace

FUZZ {
  fuzz::in_family(in, in.choice(fuzz::families), [&]<class T, class Tag>() { of_family<T, Tag>(in); });
}
