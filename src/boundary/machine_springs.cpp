// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/machine_springs.hpp"

#include <algorithm>
#include <cmath>

#include "solid/element.hpp"

namespace slipfront::boundary {

namespace {

/// The nodes with springs, ascending.
std::vector<EdgeNode> sprung_nodes(const Boundary& boundary) {
  std::vector<EdgeNode> nodes;
  for (const auto& a : boundary.nodes)
    if (is_spring(a.spring_x_N_per_m) || is_spring(a.spring_y_N_per_m)) nodes.push_back(a);
  std::ranges::sort(nodes, {}, &EdgeNode::node);
  return nodes;
}

double stiffness_of(const std::optional<double>& spring_N_per_m) {
  return is_spring(spring_N_per_m) ? *spring_N_per_m : 0;
}

}  // namespace

MachineSprings::MachineSprings(const mesh::Mesh& mesh, const solid::Material& material,
                               const Boundary& boundary) {
  for (const auto& a : sprung_nodes(boundary)) {
    node_.push_back(a.node);
    has_spring_.x.push_back(is_spring(a.spring_x_N_per_m));
    has_spring_.y.push_back(is_spring(a.spring_y_N_per_m));
    stiffness_.x.push_back(stiffness_of(a.spring_x_N_per_m));
    stiffness_.y.push_back(stiffness_of(a.spring_y_N_per_m));
    mass_kg_.push_back(a.machine_kg);
  }
  if (node_.empty()) return;
  rows_ = solid::assemble_rows(mesh, material, node_);
  force_N_ = solid::Field(node_.size());
  speed_x_m_per_s_.resize(node_.size());
}

std::size_t MachineSprings::place(mesh::Node n) const {
  const auto found = std::ranges::lower_bound(node_, n);
  return found != node_.end() && *found == n ? static_cast<std::size_t>(found - node_.begin()) : none;
}

void MachineSprings::start(const solid::Field& u_m, double speed_m_per_s) {
  if (empty()) return;
  solid::for_each_row_product(rows_, u_m, [&](std::size_t k, double x, double y) {
    const auto n = node_[k];
    force_N_.x[k] = has_spring_.x[k] * (x + stiffness_.x[k] * u_m.x[n]);
    force_N_.y[k] = has_spring_.y[k] * (y + stiffness_.y[k] * u_m.y[n]);
    speed_x_m_per_s_[k] = has_spring_.x[k] * speed_m_per_s;
  });
}

void MachineSprings::move(std::size_t k, double dt_s, solid::Pair force_N, solid::Pair before,
                          solid::Pair after, record::Energies& works) {
  const double of_machine = dt_s * force_N.x * speed_x_m_per_s_[k];
  works.far_edge_work += of_machine;
  works.machine += of_machine -
                   0.5 * dt_s * (force_N.x * (before.x + after.x) + force_N.y * (before.y + after.y)) +
                   0.5 * mass_kg_[k] * (after.x * after.x - before.x * before.x);
  force_N_.x[k] += dt_s * stiffness_.x[k] * speed_x_m_per_s_[k];
}

void MachineSprings::reverse() {
  for (double& speed : speed_x_m_per_s_) speed = -speed;
}

double largest_spring_frequency_rad_per_s(const mesh::Mesh& mesh, const solid::Material& material,
                                          const Boundary& boundary, const std::vector<bool>& of_node) {
  const auto nodes = sprung_nodes(boundary);
  if (nodes.empty()) return 0;
  const auto mass_kg = solid::lumped_mass(mesh, material);
  double largest = 0;
  for (const auto& a : nodes) {
    if (mass_kg[a.node] == 0 || (!of_node.empty() && !of_node[a.node])) continue;
    largest = std::max({largest, stiffness_of(a.spring_x_N_per_m) / (mass_kg[a.node] + a.machine_kg),
                        stiffness_of(a.spring_y_N_per_m) / mass_kg[a.node]});
  }
  return std::sqrt(largest);
}

}  // namespace slipfront::boundary
