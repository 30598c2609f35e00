// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "mesh/slabs.hpp"
#include "problem/problem.hpp"
#include "setup/meshes.hpp"

namespace slipfront::setup {

/// Nodes of the rows that are made at a time, unless a single row of squares has more.
inline constexpr std::size_t snapshot_nodes_at_once = 1U << 18U;

/// The mesh of a case's fields.vtkhdf: nodes and cells of the plate, then those of the body below, its y
/// turned downwards, as in motion::Snapshot.
struct SnapshotMesh {
  mesh::Slabs slabs;
  std::size_t n_plate_cells = 0;
};

/// The mesh, some rows at a time.
/// @param n_writers  each of which may have a slab at least, as far as there are rows enough
SnapshotMesh snapshot_mesh_in_rows(const Problem& problem, int n_writers = 1);

/// The mesh in one slab.
SnapshotMesh whole_snapshot_mesh(Meshes meshes);

}  // namespace slipfront::setup
