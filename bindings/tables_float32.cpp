// Tables in float32 of every family.
#include "bindings/density/table_kernels.hpp"

namespace microfacet::bindings {

template void build_tables(radial_tables<float>&, const any_density&, unsigned);
template struct table_kernels<float>;

}  // namespace microfacet::bindings
