// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/boundary.hpp"

#include <cstddef>

namespace slipfront::boundary {

solid::EdgeSets Boundary::edge_sets() const {
  solid::EdgeSets sets{driven, {}};
  for (const auto& node : nodes) sets.with_forces.push_back(node.node);
  return sets;
}

Boundary make_boundary(const mesh::Mesh& mesh, const Machine& machine) {
  Boundary all;
  for (const auto& [node, side_m, top_m] : mesh.absorbing_nodes) all.nodes.push_back({node, side_m, top_m});
  if (machine.prescribes_far_edge()) {
    all.driven = mesh.far_edge_nodes;
    return all;
  }
  all.pushed = pushed_nodes(mesh, machine.pusher);
  const auto shares = shares_of_pushed(mesh, all.pushed);
  const double pusher_m = machine.pusher.to_m - machine.pusher.from_m;
  for (std::size_t k = 0; k < all.pushed.size(); ++k)
    all.nodes.push_back({.node = all.pushed[k],
                         .spring_x_N_per_m = shares[k] * pusher_m * machine.shear_stiffness_Pa_per_m,
                         .machine_kg = shares[k] * pusher_m * machine.mass_kg_per_m2});
  const auto n_below = all.nodes.size();
  for (std::size_t k = 0; k < mesh.far_edge_nodes.size(); ++k) {
    const auto n = mesh.far_edge_nodes[k];
    const double length_m = mesh.far_edge_lengths_m[k];
    const bool is_pushed_corner = !all.pushed.empty() && all.pushed.back() == n;
    auto& node = is_pushed_corner ? all.nodes[n_below - 1] : all.nodes.emplace_back();
    node.node = n;
    if (!machine.pusher.is_there()) {
      node.spring_x_N_per_m = length_m * machine.shear_stiffness_Pa_per_m;
      node.machine_kg = length_m * machine.mass_kg_per_m2;
    }
    node.spring_y_N_per_m = length_m * machine.normal_stiffness_Pa_per_m;
  }
  return all;
}

}  // namespace slipfront::boundary
