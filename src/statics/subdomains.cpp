// SPDX-License-Identifier: BSD-3-Clause
#include "statics/subdomains.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/error.hpp"

namespace slipfront::statics {

void Subdomain::put(MessageBuffer& to) const {
  to.put(first).put(count).put(n_pairs).put(static_cast<std::uint64_t>(bodies.size()));
  for (const auto& body : bodies) to.put(body.material).put(body.is_base).put(body.nodes).put(body.cells);
  to.put(interface_nodes).put(gap_m).put(top).put(held);
}

Subdomain Subdomain::take(MessageBuffer& from) {
  Subdomain subdomain;
  subdomain.first = from.take<std::int32_t>();
  subdomain.count = from.take<std::int32_t>();
  subdomain.n_pairs = from.take<std::int32_t>();
  subdomain.bodies.resize(from.take<std::uint64_t>());
  for (auto& body : subdomain.bodies) {
    body.material = from.take<solid::Material>();
    body.is_base = from.take<bool>();
    body.nodes = from.take_all<Node>();
    body.cells = from.take_all<mesh::Cell>();
  }
  subdomain.interface_nodes = from.take_all<Place>();
  subdomain.gap_m = from.take_all<double>();
  subdomain.top = from.take_all<Place>();
  subdomain.held = from.take_all<std::int32_t>();
  return subdomain;
}

// With D = diag(-1, 1) the relative displacement is v = u_plate + D u_base; so u_plate = v - D u_base, or
// u_base = D v - D u_plate.
Terms terms_of(bool is_relative, bool is_base) {
  if (!is_relative) return {};
  return {{is_base ? -1.0 : 1.0, 1}, {1, -1}};
}

void make_absolute(solid::Field& plate, std::span<const mesh::Node> plate_lower, solid::Field& base,
                   std::span<const mesh::Node> base_lower, bool base_is_relative) {
  auto& relative = base_is_relative ? base : plate;
  const auto& other = base_is_relative ? plate : base;
  const auto lower = base_is_relative ? base_lower : plate_lower;
  const auto other_lower = base_is_relative ? plate_lower : base_lower;
  const auto [own, opposite] = terms_of(true, base_is_relative);
  for (std::size_t k = 0; k < lower.size(); ++k) {
    double &x = relative.x[lower[k]], &y = relative.y[lower[k]];
    x = own[0] * x + opposite[0] * other.x[other_lower[k]];
    y = own[1] * y + opposite[1] * other.y[other_lower[k]];
  }
}

namespace {

/// The first column of each subdomain, and the number of columns.
std::vector<int> first_columns(const std::vector<std::int64_t>& nodes_of_column, int n_subdomains) {
  const auto n_nodes = std::reduce(nodes_of_column.begin(), nodes_of_column.end());
  SLIPFRONT_ASSERT(n_nodes <= max_petsc_nodes, "too many unknowns");
  std::vector<int> first = {0};
  std::int64_t before = 0;
  for (std::size_t column = 0; column < nodes_of_column.size(); ++column) {
    while (std::ssize(first) < n_subdomains && before * n_subdomains >= n_nodes * std::ssize(first))
      first.push_back(static_cast<int>(column));
    before += nodes_of_column[column];
  }
  first.resize(static_cast<std::size_t>(n_subdomains) + 1, static_cast<int>(nodes_of_column.size()));
  return first;
}

/// A body, or some columns of it, with the pairs of its nodes.
struct NumberedBody {
  const mesh::Mesh& mesh;
  const solid::Material& material;
  std::span<const std::int32_t> pair;  ///< [nodes] -1 where there is no cell
};

/// [nodes] The other body's pair at the nodes of the body whose pairs are relative.
std::vector<std::int32_t> opposites(const NumberedBody& relative, const NumberedBody& other) {
  std::vector<std::int32_t> opposite(relative.pair.size(), -1);
  const auto& lower = relative.mesh.interface_nodes;
  for (std::size_t k = 0; k < lower.size(); ++k)
    opposite[lower[k]] = other.pair[other.mesh.interface_nodes[k]];
  return opposite;
}

/// @param before  columns of the whole bodies to the left of these: so many places along their edges
Subdomain piece_of(std::span<const NumberedBody> bodies, bool base_is_relative, std::int32_t first,
                   std::int32_t end, std::int32_t n_pairs, int before) {
  Subdomain subdomain;
  subdomain.first = first;
  subdomain.count = end - first;
  subdomain.n_pairs = n_pairs;
  const std::size_t of_relative = base_is_relative ? 1 : 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& mesh = bodies[b].mesh;
    const auto pair = bodies[b].pair;
    const bool is_relative = bodies.size() > 1 && b == of_relative;
    const auto opposite =
        is_relative ? opposites(bodies[b], bodies[1 - b]) : std::vector<std::int32_t>(pair.size(), -1);
    auto& body = subdomain.bodies.emplace_back(Subdomain::Body{bodies[b].material, b > 0, {}, {}});
    std::vector<mesh::Node> local(pair.size(), -1);
    for (const auto& cell : mesh.cells) {
      const auto is_own = [&](mesh::Node n) { return subdomain.has(pair[n]) || subdomain.has(opposite[n]); };
      if (std::ranges::none_of(cell, is_own)) continue;
      auto& own = body.cells.emplace_back(cell);
      for (auto& n : own) {
        const auto whole = n;
        n = local[whole];
        if (n >= 0) continue;
        n = local[whole] = static_cast<mesh::Node>(body.nodes.size());
        body.nodes.push_back({mesh.x_m[whole], mesh.y_m[whole], pair[whole], opposite[whole]});
      }
    }
  }
  const auto for_own = [&](const NumberedBody& body, const std::vector<mesh::Node>& edge, auto&& take) {
    for (std::size_t k = 0; k < edge.size(); ++k)
      if (const auto pair = body.pair[edge[k]]; subdomain.has(pair))
        take(Subdomain::Place{pair, static_cast<std::int32_t>(k) + before}, k);
  };
  const auto& relative = bodies[of_relative];
  const auto gap_m = gaps_m(bodies.front().mesh, bodies.size() > 1 ? &bodies.back().mesh : nullptr);
  for_own(relative, relative.mesh.interface_nodes, [&](const Subdomain::Place& place, std::size_t k) {
    subdomain.interface_nodes.push_back(place);
    subdomain.gap_m.push_back(gap_m[k]);
  });
  for_own(bodies.front(), bodies.front().mesh.far_edge_nodes,
          [&](const Subdomain::Place& place, std::size_t) { subdomain.top.push_back(place); });
  if (bodies.size() > 1)
    for_own(bodies.back(), bodies.back().mesh.far_edge_nodes,
            [&](const Subdomain::Place& place, std::size_t) { subdomain.held.push_back(place.pair); });
  return subdomain;
}

}  // namespace

void SubdomainPlan::put(MessageBuffer& to) const {
  to.put(bodies).put(base_is_relative).put(first_column).put(first).put(number);
}

SubdomainPlan SubdomainPlan::take(MessageBuffer& from) {
  SubdomainPlan plan;
  plan.bodies = from.take_all<Body>();
  plan.base_is_relative = from.take<bool>();
  plan.first_column = from.take_all<int>();
  plan.first = from.take_all<std::int32_t>();
  plan.number = from.take<std::int32_t>();
  return plan;
}

Subdomain SubdomainPlan::make() const {
  const auto k = static_cast<std::size_t>(number);
  // Cells join neighbouring columns.
  const int begin = std::max(first_column[k] - 1, 0);
  const int end = std::min(first_column[k + 1] + 1, first_column.back());
  std::vector<mesh::Mesh> meshes;
  for (const auto& body : bodies)
    meshes.push_back(mesh::make_columns(body.plate, mesh::Subset({{begin, end}})));
  // A subdomain has the rows of one body after those of the other one, each from left to right.
  struct Column {
    std::int32_t lowest = 0, width = 0;  // pair of the lowest node, and columns of the subdomain
  };
  std::vector<Column> columns;
  for (int i = begin; i < end; ++i) {
    const auto p = std::ranges::upper_bound(first_column, i) - first_column.begin() - 1;
    columns.push_back({first[p] + i - first_column[p], first_column[p + 1] - first_column[p]});
  }
  std::vector<std::vector<std::int32_t>> pairs(meshes.size());
  std::vector<NumberedBody> numbered;
  std::int32_t row = 0;
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    for (const auto end_row = row + meshes[b].grid.rows + 1; row < end_row; ++row)
      for (const auto& [lowest, width] : columns) pairs[b].push_back(lowest + row * width);
    numbered.push_back({meshes[b], bodies[b].material, pairs[b]});
  }
  return piece_of(numbered, base_is_relative, first[k], first[k + 1], first.back(), begin);
}

PartitionedBodies::PartitionedBodies(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                                     int n_subdomains, std::span<const mesh::Plate> plates)
    : bodies_{plate}, plates_(plates.begin(), plates.end()) {
  Partition partition;
  if (base) {
    bodies_.push_back(*base);
    partition.base_is_relative = plate.material.youngs_modulus_Pa > base->material.youngs_modulus_Pa;
  }
  std::vector<mesh::NodeColumns> columns;
  for (const auto& body : bodies_) columns.emplace_back(body.mesh);
  std::vector<std::int64_t> nodes_of_column(static_cast<std::size_t>(columns.front().n_columns()));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& orphans = partition.orphans.emplace_back();
    if (!are_held()) {
      for (auto& n : nodes_of_column) n += columns[b].n_rows();
      continue;
    }
    const auto is_orphan = mesh::orphans(bodies_[b].mesh);
    for (mesh::Node n = 0; n < bodies_[b].mesh.n_nodes(); ++n)
      if (is_orphan[n])
        orphans.push_back(n);
      else
        ++nodes_of_column[columns[b].column_of(n)];
  }
  partition.first_column = first_columns(nodes_of_column, n_subdomains);
  first_ = {0};
  for (int k = 0; k < n_subdomains; ++k) {
    const auto begin = nodes_of_column.begin() + partition.first_column[k];
    const auto end = nodes_of_column.begin() + partition.first_column[k + 1];
    first_.push_back(first_.back() + static_cast<std::int32_t>(std::reduce(begin, end)));
  }
  if (are_held()) {
    for (const auto& body : bodies_) pair_.emplace_back(static_cast<std::size_t>(body.mesh.n_nodes()), -1);
    for (int k = 0; k < n_subdomains; ++k) {
      std::int32_t next = first_[k];
      const auto nodes = partition.nodes_of_subdomain(columns, k);
      for (std::size_t b = 0; b < bodies_.size(); ++b)
        for (const auto n : nodes[b]) pair_[b][n] = next++;
    }
  }
  partition_ = std::make_shared<const Partition>(std::move(partition));
}

Subdomain PartitionedBodies::subdomain(int number) const {
  SLIPFRONT_ASSERT(are_held(), "bodies to cut");
  std::vector<NumberedBody> numbered;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    numbered.push_back({bodies_[b].mesh, bodies_[b].material, pair_[b]});
  return piece_of(numbered, partition_->base_is_relative, first_[number], first_[number + 1], n_pairs(), 0);
}

SubdomainPlan PartitionedBodies::plan(int number) const {
  SubdomainPlan plan{{}, partition_->base_is_relative, partition_->first_column, first_, number};
  for (std::size_t b = 0; b < bodies_.size(); ++b) plan.bodies.push_back({plates_[b], bodies_[b].material});
  return plan;
}

Displacement PartitionedBodies::displacement(const std::vector<double>& unknowns) const {
  Displacement u;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& field = b == 0 ? u.above : u.below;
    field = solid::Field(pair_[b].size());
    for (std::size_t n = 0; n < field.size(); ++n) {
      const auto pair = pair_[b][n];
      if (pair < 0) continue;
      field.x[n] = unknowns[2 * pair];
      field.y[n] = unknowns[2 * pair + 1];
    }
  }
  if (bodies_.size() > 1)
    make_absolute(u.above, bodies_[0].mesh.interface_nodes, u.below, bodies_[1].mesh.interface_nodes,
                  partition_->base_is_relative);
  return u;
}

}  // namespace slipfront::statics
