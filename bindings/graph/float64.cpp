#include "bindings/graph/recording.hpp"

template microfacet::record::graph microfacet::bindings::record_graph<double>(const density_source&,
                                                                              const record::request&, bool);
