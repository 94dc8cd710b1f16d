// The headers on Dr.Jit's packets.

#include <drjit/array.h>
#include <drjit/packet.h>

#include "../../../src/microfacet/mitsuba/plugin/drjit_scalar.hpp"
#include "families_on.hpp"

namespace {

template <class T>
void run() {
  using packet = drjit::Packet<T, 64 / sizeof(T)>;
  using load = decltype([](const T* x) { return drjit::load<packet>(x); });
  using store = decltype([](T* y, const packet& p) { drjit::store(y, p); });
  generic::families_on<packet, generic::fixed_size<packet, packet::Size, load, store>>("packet");
}

}  // namespace

TEST(families_on_packets) { run<float>(), run<double>(); }
