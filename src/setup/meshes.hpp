// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mesh/mesh.hpp"
#include "motion/probes.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"

namespace slipfront::setup {

/// The plate's mesh, and that of the body below where there is one, upside down.
struct Meshes {
  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;
};

/// Checks what can be checked without solving anything: geometry, rows of the interface layer, loads that do
/// nothing. The meshes are those of the interfaces alone where root_has_interface_only says so.
/// @param processes  the ranks that share the run
/// @throws UserError
Meshes check(const Problem& problem, const Processes& processes = one_process());

/// Checks the interfaces alone.
Meshes check_interfaces(const Problem& problem);

/// Numbers of a body of which the interface may be all that is held.
std::int64_t n_nodes_of(const mesh::Mesh& mesh);
std::int64_t n_cells_of(const mesh::Mesh& mesh);

/// Where a case's probes lie in its bodies, of which the interfaces may be all that is held.
/// @throws UserError where one lies outside
std::vector<motion::Probe> probes_of(const Problem& problem, const mesh::Mesh& plate,
                                     const std::optional<mesh::Mesh>& base);

}  // namespace slipfront::setup
