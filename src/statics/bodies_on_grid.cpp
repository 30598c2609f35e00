// SPDX-License-Identifier: BSD-3-Clause
#include "statics/bodies_on_grid.hpp"

#include <utility>

namespace slipfront::statics {

namespace {

bool plate_is_stiffer(const ElasticBody& plate, const std::optional<ElasticBody>& base) {
  return base && plate.material.youngs_modulus_Pa > base->material.youngs_modulus_Pa;
}

}  // namespace

BodiesOnGrid::BodiesOnGrid(const ElasticBody& plate, const std::optional<ElasticBody>& base)
    : plate_(plate.mesh),
      base_(base ? &base->mesh : nullptr),
      plate_is_lower_(plate_is_stiffer(plate, base)) {}

GridLevel make_level_of_bodies(const ElasticBody& plate, const std::optional<ElasticBody>& base) {
  if (!base) return make_level(plate);
  return plate_is_stiffer(plate, base) ? make_level(*base, plate) : make_level(plate, *base);
}

std::vector<mesh::Node> BodiesOnGrid::interface() const {
  if (base_ == nullptr) return plate_.interface_nodes;
  std::vector<mesh::Node> nodes;
  for (const auto n : plate_.interface_nodes) nodes.push_back(plate_.grid.node(n, interface_row()));
  return nodes;
}

double BodiesOnGrid::share_of_height(mesh::Node n) const {
  const auto share = [&](mesh::Node in_plate) {
    return plate_.y_m[in_plate] / plate_.y_m[plate_.far_edge_nodes.front()];
  };
  if (base_ == nullptr) return share(n);
  const auto& grid = plate_.grid;
  const int i = n % grid.stride(), j = n / grid.stride() - interface_row();
  if (plate_is_lower_ ? j >= 0 : j <= 0) return 0;
  return share(grid.node(i, plate_is_lower_ ? -1 - j : j));
}

solid::Pair BodiesOnGrid::on_grid(const DisplacementOfBodies& u, mesh::Node n) const {
  if (base_ == nullptr) return {u.above->x[n], u.above->y[n]};
  const auto& u_upper = plate_is_lower_ ? *u.below : *u.above;
  const auto& u_lower = plate_is_lower_ ? *u.above : *u.below;
  const auto& grid = upper().grid;
  const int i = n % grid.stride(), j = n / grid.stride();
  const auto of_upper = [&](int row) {
    return solid::Pair{u_upper.x[grid.node(i, row)], u_upper.y[grid.node(i, row)]};
  };
  const auto of_lower = [&](int row) {
    return solid::Pair{u_lower.x[grid.node(i, row)], -u_lower.y[grid.node(i, row)]};
  };
  if (j < interface_row()) return of_lower(interface_row() - 1 - j);
  auto v = of_upper(j - interface_row());
  if (j > interface_row()) return v;
  const auto w = of_lower(0);
  return {v.x - w.x, v.y - w.y};
}

Displacement BodiesOnGrid::of_bodies(solid::Field u) const {
  if (base_ == nullptr) return {std::move(u), {}};
  solid::Field u_upper(upper().n_nodes()), u_lower(lower().n_nodes());
  const auto& grid = upper().grid;
  for (int i = 0; i < grid.stride(); ++i) {
    for (int j = 0; j <= upper().grid.rows; ++j) {
      const auto n = grid.node(i, j), from = grid.node(i, interface_row() + j);
      u_upper.x[n] = u.x[from];
      u_upper.y[n] = u.y[from];
    }
    for (int j = 0; j < interface_row(); ++j) {
      const auto n = grid.node(i, interface_row() - 1 - j), from = grid.node(i, j);
      u_lower.x[n] = u.x[from];
      u_lower.y[n] = -u.y[from];
    }
    const auto below = grid.node(i, interface_row() - 1);
    u_upper.x[i] += u.x[below];
    u_upper.y[i] += u.y[below];
  }
  if (plate_is_lower_) return {std::move(u_lower), std::move(u_upper)};
  return {std::move(u_upper), std::move(u_lower)};
}

}  // namespace slipfront::statics
