// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "statics/grid_level.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

/// Where the nodes of a plate, and of a base below it, are on the finest grid of the multigrid.
///
/// The stiffer one of two bodies is the grid's lower one. Then what is fixed or freed by contact, the
/// relative displacement, moves the softer body alone, and point smoothing does well whatever the ratio of
/// the moduli. Where the plate is the lower one the grid is upside down.
class BodiesOnGrid {
 public:
  BodiesOnGrid(const ElasticBody& plate, const std::optional<ElasticBody>& base);

  /// What is on the grid at `n` where the bodies' displacement is u: that of a node, relative to what is
  /// below in the interface row.
  solid::Pair on_grid(const DisplacementOfBodies& u, mesh::Node n) const;
  /// The bodies' displacement where the grid's is u.
  Displacement of_bodies(solid::Field u) const;

  /// Height of the plate's node at `n` over that of the loaded edge; 0 on a base, and where it touches it.
  double share_of_height(mesh::Node n) const;

  bool has_base() const { return base_ != nullptr; }
  /// Grid node with the relative displacement of each of mesh.interface_nodes.
  std::vector<mesh::Node> interface() const;
  /// Sign of the plate's relative displacement, and of the contact's force on it, from the grid's, along x;
  /// along y they are the same.
  double x_sign() const { return plate_is_lower_ ? -1 : 1; }
  /// The plate's u_y from the grid's.
  double y_sign() const { return plate_is_lower_ ? -1 : 1; }
  /// Whether the loaded edge is the grid's last row; a base is held at the other end.
  bool loaded_edge_is_last() const { return !plate_is_lower_; }

 private:
  const mesh::Mesh& upper() const { return plate_is_lower_ ? *base_ : plate_; }
  const mesh::Mesh& lower() const { return plate_is_lower_ ? plate_ : *base_; }
  int interface_row() const { return base_ != nullptr ? lower().grid.rows + 1 : 0; }

  const mesh::Mesh& plate_;
  const mesh::Mesh* base_;  ///< null on the rigid plane
  bool plate_is_lower_;
};

/// The finest grid itself, in the same order.
GridLevel make_level_of_bodies(const ElasticBody& plate, const std::optional<ElasticBody>& base);

}  // namespace slipfront::statics
