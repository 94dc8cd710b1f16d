// The rows of tables that a graph looks up.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "microfacet/record/graph.hpp"

namespace microfacet::record::detail {

// Rows that are looked up together end together.
class table_rows {
 public:
  table_rows(const graph& g, const std::vector<int>& uses) : graph_(g), rows_(g.tables.size()) {
    std::vector<std::size_t> by_index(g.nodes.size());
    for (int round = 0; round < 2; ++round)
      for (std::size_t i = 0; i < g.nodes.size(); ++i) {
        const node& n = g.nodes[i];
        if (uses[i] == 0 || !n.is(operation::table)) continue;
        const auto index = static_cast<std::size_t>(n.arguments[0]), t = static_cast<std::size_t>(n.index);
        by_index[index] = rows_[t] = (std::max)({by_index[index], rows_[t], g.tables[t].rows});
      }
  }

  table kept(int t) const {
    const auto i = static_cast<std::size_t>(t);
    table kept = graph_.tables[i];
    if (kept.type == kind::real)
      kept.values.resize(rows_[i]);
    else
      kept.wholes.resize(rows_[i]);
    kept.rows = rows_[i];
    return kept;
  }

 private:
  const graph& graph_;
  std::vector<std::size_t> rows_;
};

}  // namespace microfacet::record::detail
