// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "advice/outlook.hpp"

namespace slipfront::advice {

/// A mesh for a case's process zone.
struct MeshChoice {
  double element_size_m = 0;
  int coarsenings = 0;  ///< of the plate, and of a base
  double process_zone_elements = 0;
  std::int64_t n_nodes = 0;
};

/// The cheapest mesh that gives arrivals to about 1 %, by docs/mesh.md: six elements in the process zone at
/// rest; 16 where S says that fronts may pass c_S between equal bodies; as many as let both bounds of damping
/// hold where friction follows the pressure at once between others. Two coarsenings, or as many as fit.
/// Empty where there is no process zone, and where no such mesh fits the plate.
std::optional<MeshChoice> cheapest_mesh(const Problem& problem, const RuptureOutlook& rupture);

}  // namespace slipfront::advice
