// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/case.hpp"
#include "mesh/slabs.hpp"
#include "run/initial_state.hpp"

namespace slipfront::run {

/// Nodes of the rows that are made at a time, unless a single row of squares has more.
inline constexpr std::size_t snapshot_nodes_at_once = 1U << 18U;

/// The mesh of a case's fields.vtkhdf: nodes and cells of the plate, then those of the body below, its y
/// turned downwards, as in motion::Snapshot. Where the meshes are those of the interfaces alone, some rows of
/// it are made at a time.
mesh::Slabs snapshot_mesh(const input::Case& config, Meshes meshes);

}  // namespace slipfront::run
