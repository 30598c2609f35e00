// SPDX-License-Identifier: BSD-3-Clause
#include "statics/distributed_field.hpp"

#include <algorithm>

namespace slipfront::statics {

std::vector<std::vector<mesh::Node>> Partition::nodes_of_subdomain(std::span<const mesh::NodeColumns> bodies,
                                                                   int subdomain) const {
  const auto k = static_cast<std::size_t>(subdomain);
  std::vector<std::vector<mesh::Node>> nodes(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int r = 0; r < bodies[b].n_rows(); ++r) {
      const auto of_row = bodies[b].nodes(r, {first_column[k], first_column[k + 1]});
      for (auto n = of_row.first; n < of_row.end(); ++n)
        if (!std::ranges::binary_search(orphans[b], n)) nodes[b].push_back(static_cast<mesh::Node>(n));
    }
  return nodes;
}

}  // namespace slipfront::statics
