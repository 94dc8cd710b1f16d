#include "bindings/graph/recording.hpp"

template microfacet::record::graph microfacet::bindings::record_graph<float>(const density_source&,
                                                                             const record::request&, bool);
