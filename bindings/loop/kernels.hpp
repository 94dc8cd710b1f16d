// One operation of one distribution over contiguous arrays.
#pragma once

#include <array>
#include <cstddef>

#include "bindings/loop/lanes.hpp"

namespace microfacet::bindings {

// One step of lanes, from element i on.
template <class Operation, class Lanes, class Distribution>
MICROFACET_INLINE void evaluate(const Distribution& d, const lane_of<Lanes>* const* in,
                                lane_of<Lanes>* const* out, std::ptrdiff_t i) {
  std::array<Lanes, Operation::shape.inputs> x;
  std::array<Lanes, Operation::shape.outputs> y;
  for (std::size_t a = 0; a < x.size(); ++a) x[a] = load<Lanes>(in[a] + i);
  Operation::apply(d, x.data(), y.data());
  for (std::size_t a = 0; a < y.size(); ++a) store(y[a], out[a] + i);
}

template <class Operation, class Lanes, class Distribution>
void evaluate_constant(const void* distribution, const lane_of<Lanes>* const* in, lane_of<Lanes>* const* out,
                       std::ptrdiff_t n) {
  // A copy, which no store to an array can change.
  const Distribution d = *static_cast<const Distribution*>(distribution);
  for (std::ptrdiff_t i = 0; i < n; i += width<Lanes>) evaluate<Operation, Lanes>(d, in, out, i);
}

// The same without a call inside: for what is one chain of operations, a table or a short closed form.
template <class Operation, class Lanes, class Distribution>
[[gnu::flatten]] void evaluate_flat(const void* distribution, const lane_of<Lanes>* const* in,
                                    lane_of<Lanes>* const* out, std::ptrdiff_t n) {
  evaluate_constant<Operation, Lanes, Distribution>(distribution, in, out, n);
}

}  // namespace microfacet::bindings
