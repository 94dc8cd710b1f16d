// Tables in float64 of every family.
#include "bindings/density/table_kernels.hpp"

namespace microfacet::bindings {

template void build_tables(radial_tables<double>&, const any_density&, unsigned);
template struct table_kernels<double>;

}  // namespace microfacet::bindings
