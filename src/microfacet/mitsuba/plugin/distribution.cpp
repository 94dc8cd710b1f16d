#include "distribution.hpp"

#include <mitsuba/core/fresolver.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "domain.hpp"
#include "traced_families.hpp"
#include "traced_tables.hpp"

#include "microfacet/family/all.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/smith/shape.hpp"
#include "microfacet/smith/visible/sample_visible_mixture.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::plugin {

namespace {

template <class... Arguments>
[[noreturn]] void fail(const char* format, const Arguments&... arguments) {
  throw std::runtime_error(tfm::format(format, arguments...));
}

template <class Use>
auto with_shape(const roughness& r, const Use& use) {
  return r.isotropic ? use(isotropic_shape<Float>(r.u))
                     : use(anisotropic_shape<Float>(r.u, r.v, r.cosine, r.sine));
}

void load(const flat_tables& flat, table_storage<Float>& storage) {
  using Int32 = drjit::int32_array_t<Float>;
  storage.floats = drjit::load<buffer<Float>>(flat.floats.data(), flat.floats.size());
  storage.integers = drjit::load<buffer<Int32>>(flat.integers.data(), flat.integers.size());
  for (std::size_t f = 0; f < table_functions; ++f) {
    const float* floats = flat.floats.data() + f * table_layout::floats;
    const std::int32_t* integers = flat.integers.data() + f * table_layout::integers;
    auto& h = storage.headers[f];
    h = {Float(floats[table_layout::lower]), Float(floats[table_layout::last]),
         Int32(integers[table_layout::base]), Int32(integers[table_layout::shift])};
    drjit::make_opaque(h.lower, h.last, h.base, h.shift);
  }
}

// Directions tell no smaller slopes; so the infinite peak of a density stays a number.
vec3<Float> off_peak(const vec3<Float>& m, const Float& resolution) {
  const auto peak = m.x * m.x + m.y * m.y < resolution * resolution;
  return {select(peak, resolution, m.x), select(peak, Float(0), m.y), m.z};
}

// A density of its user's own, whose tables microfacet.mitsuba.table has written down.
class table_distribution final : public distribution {
  using family = tabulated<Float, tables>;

  template <class Use>
  auto on(const roughness& r, const Use& use) const {
    const tables t(storage_, tables::between());
    return with_shape(
        r, [&]<class Shape>(const Shape& shape) { return use(ndf<family, Float, Shape>(family(t), shape)); });
  }

 public:
  static constexpr std::string_view name = "table";

  explicit table_distribution(const mitsuba::Properties& properties) {
    const std::string plugin(properties.plugin_name());
    const bool here = properties.has_property("tables"), elsewhere = properties.has_property("filename");
    if (here == elsewhere)
      fail("%s: \"distribution\" is \"table\", which needs one of \"tables\" and \"filename\"", plugin);
    const std::string written = here ? properties.get<std::string>("tables")
                                     : content(plugin, properties.get<std::string>("filename"));
    flat_tables flat;
    const std::string_view wrong = flat.append_written(written, peak_);
    if (!wrong.empty()) fail("%s: \"%s\" %s", plugin, here ? "tables" : "filename", wrong);
    load(flat, storage_);
  }
  std::string to_string() const override { return std::string(name); }

  Float D(const roughness& r, const vector& m, const Float& resolution) const override {
    return on(r, [&](const auto& ndf) { return ndf.D(peak_ ? off_peak(m, resolution) : m); });
  }
  Float sigma(const roughness& r, const vector& w) const override {
    return on(r, [&](const auto& ndf) { return ndf.sigma(w); });
  }
  vector sample_visible(const roughness& r, const vector& w, const std::array<Float, 4>& xi) const override {
    return on(r, [&](const auto& ndf) { return sample_visible_mixture(ndf, w, xi[0], xi[1], xi[2], xi[3]); });
  }

 private:
  static std::string content(const std::string& plugin, const std::string& path) {
    constexpr std::size_t most = 1 << 20;  // of text; tables take a tenth
    const auto found = mitsuba::file_resolver()->resolve(path);
    std::ifstream stream(found.string(), std::ios::binary);
    std::string text(most + 1, '\0');
    if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!stream && stream.gcount() == 0)
      fail("%s: \"filename\" is \"%s\", which cannot be read", plugin, path);
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return text;
  }

  table_storage<Float> storage_;
  bool peak_ = false;

  MI_TRAVERSE_CB(distribution, storage_.floats, storage_.integers)
};

template <class Family>
class family_distribution final : public distribution {
  static constexpr bool has_shape = std::tuple_size_v<decltype(Family::parameters)> > 0;

 public:
  explicit family_distribution(const mitsuba::Properties& properties) : plugin_(properties.plugin_name()) {
    if constexpr (has_shape) {
      const std::string name(Family::parameters[0].name);
      if (!properties.has_property(name))
        fail("%s: \"%s\" is missing, which %s needs", plugin_, name, Family::name);
      shape_ = Float(properties.get<float>(name));
      drjit::make_opaque(shape_);
    }
    if (stretches()) build();
  }

  void traverse(mitsuba::TraversalCallback* callback) override {
    if constexpr (has_shape)
      callback->put(Family::parameters[0].name, shape_, mitsuba::ParamFlags::Differentiable);
  }
  void parameters_changed(const std::vector<std::string>& = {}) override {
    if (stretches()) build();
  }
  std::string to_string() const override {
    if constexpr (has_shape) {
      return tfm::format("%s[%s = %g]", Family::name, Family::parameters[0].name, number(shape_));
    } else {
      return std::string(Family::name);
    }
  }
  bool stretches() const override { return Family::shape_invariant; }
  void set_roughness(const Float& alpha, bool varies) override {
    alpha_ = alpha, varies_ = varies;
    build();
  }
  bool differentiated() const override { return drjit::grad_enabled(shape_) || drjit::grad_enabled(alpha_); }

  Float D(const roughness& r, const vector& m, const Float& resolution) const override {
    if (!peak_) return on(r, [&](const auto& ndf) { return ndf.D(m); });
    return on(r, [&](const auto& ndf) { return ndf.D(off_peak(m, resolution)); });
  }
  Float sigma(const roughness& r, const vector& w) const override {
    return on(r, [&](const auto& ndf) { return ndf.sigma(w); });
  }
  vector sample_visible(const roughness& r, const vector& w, const std::array<Float, 4>& xi) const override {
    return on(r, [&](const auto& ndf) { return sample_visible_mixture(ndf, w, xi[0], xi[1], xi[2], xi[3]); });
  }

 private:
  template <class Use>
  auto on(const roughness& r, const Use& use) const {
    const Float alpha = varies_ ? on_grid(r.u) : alpha_;
    const auto under_shape = [&](const auto& family) {
      using traced_family = std::remove_cvref_t<decltype(family)>;
      const auto under = [&]<class Shape>(const Shape& shape) {
        return use(ndf<traced_family, Float, Shape>(family, shape));
      };
      if constexpr (Family::shape_invariant) {
        return with_shape(r, under);
      } else {
        return under(isotropic_shape<Float>(Float(1)));
      }
    };
    if constexpr (has_tables<Family>) {
      if constexpr (has_shape) {
        if (varies_ && drjit::grad_enabled(shape_))
          fail("%s: \"%s\" cannot be differentiated where alpha is a texture that varies", plugin_,
               Family::parameters[0].name);
      }
      const tables t(storage_, varies_ ? tables::between(alpha_between<Float>(alpha)) : tables::between());
      // The closed density of a roughness that does not vary costs more than its table.
      if constexpr (!Family::shape_invariant) {
        if (!varies_) return under_shape(tabulated<Float, tables>(t));
      }
      return under_shape(traced<Family>(&t, alpha, shape_));
    } else {
      return under_shape(traced<Family>(nullptr, alpha, shape_));
    }
  }
  static Float on_grid(const Float& alpha) {
    return minimum(maximum(alpha, Float(alpha_grid::least)), Float(alpha_grid::most));
  }

  void build() {
    check();
    peak_ = has_peak({Family::name, number(alpha_), number(shape_)});
    if constexpr (has_tables<Family>) {
      flat_tables flat;
      storage_.parameters = 0;
      if (varies_) {
        for (std::uint32_t i = 0; i < alpha_grid::nodes; ++i)
          flat.append({Family::name, alpha_grid::alpha(i), number(shape_)}, table_use::all);
      } else {
        append(flat);
      }
      if (!flat.samples)
        fail("%s: \"alpha\" is %g, where %s has visible normals only if its slopes are densest at zero",
             plugin_, number(alpha_), to_string());
      load(flat, storage_);
    }
  }
  void append(flat_tables& flat) {
    const double alpha = number(alpha_), shape = number(shape_);
    flat.append({Family::name, alpha, shape}, table_use::all);
    const auto differences = [&](const Float& parameter, double step, double of_alpha, double of_shape) {
      for (const int k : {-2, -1, 1, 2})
        flat.append({Family::name, alpha + k * step * of_alpha, shape + k * step * of_shape},
                    table_use::directions);
      storage_.parameter[storage_.parameters] = parameter;
      Float& inverse = storage_.inverse_of_steps[storage_.parameters++];
      inverse = Float(static_cast<float>(1 / (12 * step)));
      drjit::make_opaque(inverse);
    };
    if constexpr (has_shape) {
      if (drjit::grad_enabled(shape_)) differences(shape_, 0.02 * room(shape), 0, 1);
    }
    if constexpr (!Family::shape_invariant) {
      if (drjit::grad_enabled(alpha_)) differences(alpha_, 0.02 * alpha, 1, 0);
    }
  }
  // To the nearer end of the interval.
  static double room(double shape) {
    constexpr parameter p = Family::parameters[0];
    return std::min(shape - p.lower, p.upper - shape);
  }
  // Also after an optimiser's step.
  void check() const {
    if constexpr (has_shape) {
      constexpr parameter p = Family::parameters[0];
      const float value = number(shape_);
      if (!(value > p.lower && value < p.upper))
        fail("%s: \"%s\" is %g, %s needs one in (%g, %g)", plugin_, p.name, value, Family::name, p.lower,
             p.upper);
    }
  }

  std::string plugin_;
  table_storage<Float> storage_;
  bool varies_ = false, peak_ = false;
  Float alpha_ = Float(1), shape_ = Float(0);

  MI_TRAVERSE_CB(distribution, storage_.floats, storage_.integers, alpha_, shape_)
};

template <class Tag>
mitsuba::ref<distribution> make_if(const mitsuba::Properties& properties, std::string_view name) {
  using Family = typename Tag::template type<Float>;
  return name == Family::name ? new family_distribution<Family>(properties) : nullptr;
}

}  // namespace

mitsuba::ref<distribution> make_distribution(const mitsuba::Properties& properties) {
  const std::string name = properties.get<std::string>("distribution", std::string("ggx"));
  mitsuba::ref<distribution> result;
  std::string names;
  const auto attempt = [&]<class Tag>(Tag) {
    if (!result) result = make_if<Tag>(properties, name);
    names += (names.empty() ? "" : ", ") + std::string(Tag::template type<Float>::name);
  };
  std::apply([&](auto... tags) { (attempt(tags), ...); }, all_families{});
  if (name == table_distribution::name) result = new table_distribution(properties);
  names += ", " + std::string(table_distribution::name);
  if (!result)
    fail("%s: \"distribution\" is \"%s\", which is none of %s", properties.plugin_name(), name, names);
  return result;
}

}  // namespace microfacet::plugin
