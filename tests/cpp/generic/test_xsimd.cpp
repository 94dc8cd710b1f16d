// The headers on xsimd's batches.

// A batch of float comes from a number by conversion to float.
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"

#include "adapt_xsimd.hpp"
#include "families_on.hpp"

namespace {

template <class T>
void run() {
  using batch = xsimd::batch<T>;
  using load = decltype([](const T* x) { return batch::load_unaligned(x); });
  using store = decltype([](T* y, const batch& b) { b.store_unaligned(y); });
  generic::families_on<batch, generic::fixed_size<batch, batch::size, load, store>>("xsimd");
}

}  // namespace

TEST(families_on_batches) { run<float>(), run<double>(); }
