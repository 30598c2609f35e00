// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "advice/mesh_choice.hpp"
#include "advice/needs.hpp"
#include "advice/outlook.hpp"
#include "base/diagnostic.hpp"
#include "base/numbers.hpp"
#include "motion/partition.hpp"
#include "problem/problem.hpp"
#include "setup/loads.hpp"
#include "solid/material.hpp"
#include "stability/verdict.hpp"
#include "statics/settings.hpp"

namespace slipfront::advice {

/// Derived quantities of a case, found without solving anything but the statics of loads given as forces.
struct Info {
  /// A division among ranks, and what a run by them takes.
  struct Shared {
    motion::Partition partition;
    double bytes_per_step = 0;     ///< that the rank with most neighbours sends in exchanges
    double expected_s = 0;         ///< as if messages took no time
    double efficiency = 0;         ///< share of the event's time that goes into own columns
    double root_memory_bytes = 0;  ///< of rank 0
    double memory_bytes = 0;       ///< of each other one
  };

  solid::WaveSpeeds speeds;                                  ///< of the plate
  std::optional<solid::WaveSpeeds> base_speeds;              ///< of the body below
  std::optional<double> generalised_rayleigh_speed_m_per_s;  ///< of the two, where it exists
  std::int64_t n_nodes = 0, n_cells = 0, n_interface = 0;
  std::optional<std::int64_t> n_irregular;  ///< none where not all of the bodies was made
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  std::vector<int> substeps_of_bodies;  ///< in a step of each, the plate first
  Needs needs;
  std::int64_t n_steps = 0;                                         ///< of the event, to time.end_s
  double node_updates = 0;                                          ///< of the event and of the ramp
  double memory_bytes = 0;                                          ///< the largest of statics and event
  statics::StaticSolver solver = statics::StaticSolver::automatic;  ///< of the statics, auto without any
  double solver_bytes = 0;                                          ///< of the statics, estimated
  double expected_s = 0;          ///< at the kernel rate measured on the spot, statics estimated
  double node_updates_per_s = 0;  ///< measured on the spot
  RuptureOutlook rupture;
  std::optional<MeshChoice> cheapest_mesh;
  stability::WellPosedness well_posedness;  ///< at the plate's nominal pressure; see its has_verdict
  /// Where friction varies along x the node of which that is, with the fastest growth; else not a number.
  double well_posedness_x_m = nan;
  std::optional<Shared> shared;
  std::optional<setup::ResolvedLoads> loads;  ///< see loaded_state
  Diagnostics notes;                          ///< see notes_of_case
};

/// What a run takes. Of a case that root_has_interface_only only columns of one rank are made.
/// @param n_processes  ranks that are to share the run, each with a processor
/// @throws UserError where the plate cannot be divided among so many
Info info(const Problem& problem, const std::optional<int>& n_processes = {});

}  // namespace slipfront::advice
