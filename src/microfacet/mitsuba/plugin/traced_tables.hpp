// The flat tables as functions of traced numbers, differentiable in their argument and in the parameters of
// the density.
#pragma once

#include <drjit/dynamic.h>
#include <drjit/math.h>

#include <array>
#include <cstdint>
#include <optional>

#include "alpha_grid.hpp"
#include "drjit_scalar.hpp"
#include "microfacet/approx/log_ratio.hpp"
#include "microfacet/core/double_double.hpp"
#include "microfacet/core/math.hpp"
#include "tables.hpp"

namespace microfacet::plugin {

namespace dr = drjit;

template <class R>
using buffer = std::conditional_t<dr::is_jit_v<R>, R, dr::DynamicArray<R>>;

// The numbers. The first block is of the parameters as they are, and four more for each parameter that may be
// differentiated: at parameter - 2 h, - h, + h, + 2 h. Or there is a block for each node of an alpha_grid.
template <class R>
struct table_storage {
  using Int32 = dr::int32_array_t<R>;
  static constexpr std::size_t most_parameters = 2;

  // How a function finds its piece.
  struct header {
    R lower, last;
    Int32 base, shift;
  };

  buffer<R> floats;
  buffer<Int32> integers;
  std::array<header, table_functions> headers{};  // of the first block: numbers, which cost no gathers
  std::size_t parameters = 0;
  std::array<R, most_parameters> parameter{}, inverse_of_steps{};  // 1/(12 h)
};

// One function of x > 0.
template <class R>
class traced_table {
  using Int32 = dr::int32_array_t<R>;
  using UInt32 = dr::uint32_array_t<R>;
  using layout = table_layout;
  using between = std::optional<alpha_between<R>>;

 public:
  traced_table(const table_storage<R>& storage, table_function function, const between& alpha)
      : storage_(&storage), function_(function), alpha_(&alpha) {}

  R operator()(const double_double<R>& x) const { return (*this)(x.high); }
  R operator()(const R& x) const { return *alpha_ ? between_nodes(x) : here(x); }
  R of_root(const R& x) const { return (*this)(R(x * x)); }
  R constant() const {
    const auto at = [&](const UInt32& block) {
      return number(row_of(block) * layout::row + (layout::constant));
    };
    if (!*alpha_) return at(UInt32(function_));
    R sum(0);
    for (std::uint32_t i = 0; i < 4; ++i) sum = sum + (*alpha_)->weight[i] * log(at(node(i)));
    return exp(sum);
  }

 private:
  // How x and the function grow with alpha where the density is nearly a stretch: what is left to interpolate
  // is smooth.
  static constexpr std::array<float, table_functions> growth_of_argument{2, 0, 1, 2, 1, 0, 1, 0};
  static constexpr std::array<float, table_functions> growth{-1, 1, -0.5F, 1, 1, 1, 1, 1};

  R here(const R& x) const {
    const R value = in_block(UInt32(function_), storage_->headers[function_], x);
    R change(0);
    for (std::uint32_t j = 0; j < storage_->parameters; ++j) {
      if (!dr::grad_enabled(storage_->parameter[j])) continue;
      // Zero, with the slope of central differences.
      const auto at = [&](std::uint32_t k) {
        const UInt32 block((1 + 4 * j + k) * table_functions + function_);
        return in_block(block, header_of(block), x);
      };
      const R slope = (R(8) * (at(2) - at(1)) - (at(3) - at(0))) * storage_->inverse_of_steps[j];
      change = change + (storage_->parameter[j] - dr::detach(storage_->parameter[j])) * dr::detach(slope);
    }
    return value + change;
  }
  R between_nodes(const R& x) const {
    const alpha_between<R>& alpha = **alpha_;
    R sum = R(growth[function_]) * alpha.log_alpha;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const R log_node = alpha.log_of_node(i);
      const R scale = exp(R(growth_of_argument[function_]) * (log_node - alpha.log_alpha));
      const R value = maximum(in_block(node(i), header_of(node(i)), R(x * scale)), smallest<R>());
      sum = sum + alpha.weight[i] * (log(value) - R(growth[function_]) * log_node);
    }
    return exp(sum);
  }
  UInt32 node(std::uint32_t i) const {
    return ((*alpha_)->first + UInt32(i)) * UInt32(std::uint32_t{table_functions}) + UInt32(function_);
  }

  R number(const UInt32& at) const { return dr::gather<R>(storage_->floats, at); }
  Int32 integer(const UInt32& at) const { return dr::gather<Int32>(storage_->integers, at); }
  static UInt32 row_of(const UInt32& block) { return block * UInt32(layout::floats / layout::row); }

  using header = typename table_storage<R>::header;
  header header_of(const UInt32& block) const {
    const UInt32 floats = row_of(block) * layout::row, integers = block * UInt32(layout::integers);
    return {number(floats + layout::lower), number(floats + layout::last), integer(integers + layout::base),
            integer(integers + layout::shift)};
  }
  R in_block(const UInt32& block, const header& h, const R& x) const {
    const R inside = minimum(maximum(x, h.lower), R(0x1p126));
    const UInt32 piece = piece_of(dr::detach(minimum(inside, h.last)), h, block);
    const std::array<R, layout::row> at = row(piece + row_of(block));
    const R v = log(inside) - at[layout::centre];
    const R slope = interleaved<layout::terms>([&](std::size_t k) { return at[layout::coefficient + k]; }, v);
    return at[layout::value] * exp(R(v * slope));
  }

  std::array<R, layout::row> row(const UInt32& index) const {
    std::array<R, layout::row> result;
    if constexpr (dr::is_jit_v<R>) {
      const auto packet = dr::gather<dr::Array<R, layout::row>>(storage_->floats, index);
      for (std::size_t k = 0; k < layout::row; ++k) result[k] = packet.entry(k);
    } else {
      for (std::uint32_t k = 0; k < layout::row; ++k)
        result[k] = dr::gather<R>(storage_->floats, index * layout::row + k);
    }
    return result;
  }

  // approx/locate.hpp: the piece follows from the leading bits.
  UInt32 piece_of(const R& x, const header& h, const UInt32& block) const {
    const Int32 fine = dr::reinterpret_array<Int32>(x) - h.base;
    const Int32 cell = (dr::maximum(fine, fine >> 6) >> h.shift) & Int32(layout::cells - 1);
    return UInt32(integer(UInt32(cell) + block * UInt32(layout::integers)));
  }

  const table_storage<R>* storage_;
  std::uint32_t function_;
  const between* alpha_;
};

// For tabulated/tabulated.hpp: the tables at one roughness, or at a varying one where they are on a grid.
template <class R>
struct traced_tables {
  static constexpr bool single = true, searches = false, always_composes = true;
  using between = std::optional<alpha_between<R>>;

  struct visible_tables {
    traced_table<R> moment, moment_radius, marginal_radius, excess_radius;
    R first_moment, inverse_P2;

    visible_tables(const table_storage<R>& storage, const between& alpha)
        : moment(storage, table_moment, alpha),
          moment_radius(storage, table_moment_radius, alpha),
          marginal_radius(storage, table_marginal_radius, alpha),
          excess_radius(storage, table_excess_radius, alpha),
          first_moment(moment.constant()),
          inverse_P2(marginal_radius.constant()) {}
  };

  between alpha;
  traced_table<R> root_D, radius, root_P2, mean_excess;
  visible_tables visible;

  traced_tables(const table_storage<R>& storage, const between& where)
      : alpha(where),
        root_D(storage, table_root_D, alpha),
        radius(storage, table_radius, alpha),
        root_P2(storage, table_root_P2, alpha),
        mean_excess(storage, table_mean_excess, alpha),
        visible(storage, alpha) {}
  traced_tables(const traced_tables&) = delete;
};

}  // namespace microfacet::plugin
