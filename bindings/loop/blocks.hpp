// Loops over arrays block_length by block_length, whatever their strides and types: one function for all kernels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "bindings/loop/lanes.hpp"
#include "microfacet/smith/shape.hpp"

namespace microfacet::bindings {

// Elements that a loop handles at a time: what is strided, short or of another type passes through a buffer
// of this length, and no other temporary exists.
inline constexpr std::ptrdiff_t block_length = 256;
template <class T>
using buffer = std::array<T, block_length>;
template <class T>
inline constexpr std::ptrdiff_t filled_up = width<lanes<T, most_registers>>;  // numbers come in multiples

// `count` numbers of type From, `stride` bytes apart; the last one fills up the lanes, so that no lane does
// what none asked for.
template <class From, class To>
void gather(const char* source, std::ptrdiff_t stride, std::ptrdiff_t count, buffer<To>& target) {
  const auto* const from = reinterpret_cast<const From*>(source);
  if (stride == sizeof(From)) {
    for (std::ptrdiff_t i = 0; i < count; ++i) target[i] = static_cast<To>(from[i]);
  } else if (stride == 3 * sizeof(From)) {  // a component of directions: compilers have vectors for it
    for (std::ptrdiff_t i = 0; i < count; ++i) target[i] = static_cast<To>(from[3 * i]);
  } else if (stride == 0) {
    std::fill_n(target.begin(), count, static_cast<To>(*from));
  } else {
    for (std::ptrdiff_t i = 0; i < count; ++i)
      target[i] = static_cast<To>(*reinterpret_cast<const From*>(source + i * stride));
  }
  for (std::ptrdiff_t i = count; i % filled_up<To> != 0; ++i) target[i] = target[count - 1];
}
// The same of uniform numbers: one below 1 stays there, where a narrower type would round it to 1.
template <class From, class To>
void gather_uniform(const char* source, std::ptrdiff_t stride, std::ptrdiff_t count, buffer<To>& target) {
  gather<From>(source, stride, count, target);
  if constexpr (sizeof(To) < sizeof(From)) {
    const To most = To(1) - std::numeric_limits<To>::epsilon() / 2;
    for (std::ptrdiff_t i = 0; i < count; ++i)
      if (target[i] == To(1) && *reinterpret_cast<const From*>(source + i * stride) < From(1))
        target[i] = most;
    for (std::ptrdiff_t i = count; i % filled_up<To> != 0; ++i) target[i] = target[count - 1];
  }
}
template <class From, class To>
void scatter(const buffer<From>& source, char* target, std::ptrdiff_t stride, std::ptrdiff_t count) {
  auto* const to = reinterpret_cast<To*>(target);
  if (stride == sizeof(To)) {
    for (std::ptrdiff_t i = 0; i < count; ++i) to[i] = static_cast<To>(source[i]);
  } else if (stride == 3 * sizeof(To)) {
    for (std::ptrdiff_t i = 0; i < count; ++i) to[3 * i] = static_cast<To>(source[i]);
  } else {
    for (std::ptrdiff_t i = 0; i < count; ++i)
      *reinterpret_cast<To*>(target + i * stride) = static_cast<To>(source[i]);
  }
}

// What the arguments of a loop are: values, the last of them perhaps uniform numbers, and parameters, then
// results. Wide parameters are float64 always.
struct block_plan {
  std::size_t values, inputs, outputs;
  bool wide_parameters;
  std::size_t uniforms = 0;
  bool of_cosine = false;  // the first value is a cosine
};

// Cosines that exceed 1 by the rounding of the type From count as 1 in arithmetic that rounds less.
template <class From, class To>
void round_cosines(buffer<To>& cosines, std::ptrdiff_t count) {
  constexpr To most = largest_cosine<From>;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const To c = cosines[i], one = c < To(0) ? To(-1) : To(1);
    cosines[i] = abs(c) > To(1) && abs(c) <= most ? one : c;
  }
}

// Evaluates n elements, a multiple of the lanes or the last ones filled up, of contiguous arrays.
template <class Compute>
using block_kernel = void (*)(const void* context, const Compute* const* in, Compute* const* out,
                              std::ptrdiff_t n);

// Evaluates the n elements from `start` on. Where parameters are constant the kernel knows them by its context.
template <class Compute, class T>
void in_blocks(const block_plan& plan, char* const* args, const std::ptrdiff_t* steps, std::ptrdiff_t start,
               std::ptrdiff_t n, bool constant, block_kernel<Compute> kernel, const void* context) {
  constexpr std::size_t most = 16;
  constexpr std::ptrdiff_t full = filled_up<Compute>;
  std::array<buffer<Compute>, most> buffers;
  std::array<const Compute*, most> in;
  std::array<Compute*, most> out;
  const std::size_t inputs = constant ? plan.values : plan.inputs;
  const auto is_wide = [&](std::size_t a) {
    return plan.wide_parameters && a >= plan.values && a < plan.inputs;
  };
  const auto contiguous = [&](std::size_t a) {
    return std::is_same_v<T, Compute> && steps[a] == sizeof(T) && !is_wide(a);
  };
  bool all = true;
  for (std::size_t a = 0; a < inputs; ++a) all = all && contiguous(a);
  for (std::size_t a = plan.inputs; a < plan.inputs + plan.outputs; ++a) all = all && contiguous(a);
  // Contiguous arrays of the kernel's own type need no blocks, but for what does not fill the lanes.
  for (std::ptrdiff_t first = 0, count; first < n; first += count) {
    const std::ptrdiff_t left = n - first;
    count = all && left >= full ? left / full * full : std::min(block_length, left);
    const auto at = [&](std::size_t a) { return args[a] + (start + first) * steps[a]; };
    const auto direct = [&](std::size_t a) { return contiguous(a) && count % full == 0; };
    for (std::size_t a = 0; a < inputs; ++a) {
      in[a] = direct(a) ? reinterpret_cast<const Compute*>(at(a)) : buffers[a].data();
      if (direct(a)) continue;
      if (is_wide(a))
        gather<double>(at(a), steps[a], count, buffers[a]);
      else if (a < plan.values && a + plan.uniforms >= plan.values)
        gather_uniform<T>(at(a), steps[a], count, buffers[a]);
      else
        gather<T>(at(a), steps[a], count, buffers[a]);
      if (!std::is_same_v<T, Compute> && plan.of_cosine && a == 0)
        round_cosines<T>(buffers[a], (count + full - 1) / full * full);
    }
    for (std::size_t k = 0; k < plan.outputs; ++k) {
      const std::size_t a = plan.inputs + k;
      out[k] = direct(a) ? reinterpret_cast<Compute*>(at(a)) : buffers[a].data();
    }
    kernel(context, in.data(), out.data(), count);
    for (std::size_t a = plan.inputs; a < plan.inputs + plan.outputs; ++a)
      if (!direct(a)) scatter<Compute, T>(buffers[a], at(a), steps[a], count);
  }
}

}  // namespace microfacet::bindings
