// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "input/case.hpp"
#include "run/initial_state.hpp"
#include "stability/rupture.hpp"

namespace slipfront::run {

/// What is to be expected of a case's rupture, from the tractions before it.
struct RuptureOutlook {
  /// Of the nodes inside; before statics are solved, of one node at the critical state under the nominal
  /// pressure.
  stability::Outlook of_nodes;
  bool nominal = false;                    ///< tractions are not known yet
  std::optional<double> trigger_length_m;  ///< of the zone at an edge, or of the patch
  std::optional<double> process_zone_elements;
  std::vector<std::string> doubts;  ///< why nothing may rupture, a line each
  /// Empty, or that the mesh is too coarse for a process zone.
  std::string unresolved;
};

/// Of a case that has its initial state.
RuptureOutlook rupture_outlook(const input::Case& config, const InitialState& initial);
/// Of a case alone.
RuptureOutlook rupture_outlook(const input::Case& config, const Meshes& meshes);

}  // namespace slipfront::run
