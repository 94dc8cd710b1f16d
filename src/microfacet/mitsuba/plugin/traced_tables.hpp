// The flat tables as functions of traced numbers, differentiable in their argument and in the parameters of
// the density.
#pragma once

#include <drjit/dynamic.h>
#include <drjit/math.h>

#include <array>
#include <cstdint>

#include "drjit_scalar.hpp"
#include "microfacet/core/log_ratio.hpp"
#include "microfacet/core/math.hpp"
#include "microfacet/core/twofold.hpp"
#include "tables.hpp"

namespace microfacet::plugin {

namespace dr = drjit;

template <class R>
using buffer = std::conditional_t<dr::is_jit_v<R>, R, dr::DynamicArray<R>>;

// The numbers. The first block is of the parameters as they are; of parameter j there may be two more, at
// parameter -+ step, for central differences.
template <class R>
struct table_storage {
  using Int32 = dr::int32_array_t<R>;
  static constexpr std::size_t most_parameters = 2;

  buffer<R> floats;
  buffer<Int32> integers;
  std::size_t parameters = 0;
  std::array<R, most_parameters> parameter{}, inverse_of_two_steps{};
};

// One function of x > 0.
template <class R>
class traced_table {
  using Int32 = dr::int32_array_t<R>;
  using UInt32 = dr::uint32_array_t<R>;
  using layout = table_layout;

 public:
  traced_table(const table_storage<R>& storage, table_function function)
      : storage_(&storage), function_(function) {}

  R operator()(const twofold<R>& x) const { return (*this)(x.high); }
  R operator()(const R& x) const {
    const R value = in_block(0, x);
    R change(0);
    for (std::size_t j = 0; j < storage_->parameters; ++j) {
      if (!dr::grad_enabled(storage_->parameter[j])) continue;
      // Zero, with the slope of a central difference.
      const R less = in_block(1 + 2 * j, x), more = in_block(2 + 2 * j, x);
      const R step = storage_->parameter[j] - dr::detach(storage_->parameter[j]);
      change = change + step * dr::detach((more - less) * storage_->inverse_of_two_steps[j]);
    }
    return value + change;
  }
  R of_root(const R& x) const { return (*this)(R(x * x)); }

 private:
  R number(std::uint32_t at) const { return dr::gather<R>(storage_->floats, UInt32(at)); }
  Int32 integer(std::uint32_t at) const { return dr::gather<Int32>(storage_->integers, UInt32(at)); }

  R in_block(std::size_t block_index, const R& x) const {
    const auto block = static_cast<std::uint32_t>(block_index) * table_functions + function_;
    const std::uint32_t floats = block * layout::floats, integers = block * layout::integers;
    const R lower = number(floats + layout::lower);
    const R inside = minimum(maximum(x, lower), R(0x1p126));
    const UInt32 piece = piece_of(dr::detach(minimum(inside, number(floats + layout::last))), integers);
    const std::array<R, layout::row> at = row(piece + floats / layout::row);
    const R v = log(inside) - at[layout::centre];
    const R slope = interleaved<layout::terms>([&](std::size_t k) { return at[layout::coefficient + k]; }, v);
    const R value = at[layout::value] * exp(R(v * slope));
    return select(x >= lower, value, number(floats + layout::at_zero));
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

  // core/piecewise.hpp: the piece follows from the leading bits.
  UInt32 piece_of(const R& x, std::uint32_t integers) const {
    const Int32 fine = dr::reinterpret_array<Int32>(x) - integer(integers + layout::base);
    const Int32 k = dr::maximum(fine, fine >> 6);
    const Int32 cell = (k >> integer(integers + layout::shift)) & integer(integers + layout::mask);
    return UInt32(dr::gather<Int32>(storage_->integers, UInt32(cell) + integers));
  }

  const table_storage<R>* storage_;
  table_function function_;
};

// For family/prepared.hpp.
template <class R>
struct traced_tables {
  static constexpr bool single = true, always_composes = true;

  struct visible_tables {
    traced_table<R> moment, moment_radius, marginal_radius, excess_radius;
    R first_moment, inverse_P2;
  };

  table_storage<R> storage;
  traced_table<R> root_D{storage, table_root_D}, radius{storage, table_radius},
      root_P2{storage, table_root_P2}, slope_excess{storage, table_slope_excess};
  visible_tables visible{{storage, table_moment},
                         {storage, table_moment_radius},
                         {storage, table_marginal_radius},
                         {storage, table_excess_radius},
                         R(0),
                         R(0)};

  traced_tables() = default;
  traced_tables(const traced_tables&) = delete;
};

}  // namespace microfacet::plugin
