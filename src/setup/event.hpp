// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "motion/event.hpp"
#include "motion/plain_stepper.hpp"
#include "motion/stepper.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "results/outputs.hpp"
#include "setup/initial_state.hpp"

// A case's event, about to begin: the bodies in their initial state, and what is observed of their motion.
namespace slipfront::setup {

/// The bodies without their motion.
std::unique_ptr<motion::Stepper> new_stepper(const Problem& problem, const mesh::Mesh& plate,
                                             const std::optional<mesh::Mesh>& base,
                                             const std::vector<double>& healed = {},
                                             const motion::Execution& execution = {});
std::unique_ptr<motion::PlainStepper> new_plain_stepper(const Problem& problem, const mesh::Mesh& plate,
                                                        const std::optional<mesh::Mesh>& base,
                                                        const std::vector<double>& healed = {});
/// The bodies of a case without their motion, by one process, and their probes.
std::unique_ptr<motion::TimeStepper> whole_stepper(const Problem& problem, const InitialState& initial,
                                                   const motion::Execution& execution = {});

/// The bodies in a case's initial state, about to move. Takes what only this needs out of the initial state:
/// displacements, nodes and cells, near 100 bytes a node. The initial state then serves for this event alone.
/// @param processes  the ranks that share it
std::unique_ptr<motion::TimeStepper> start_event(const Problem& problem, InitialState& initial,
                                                 const motion::Execution& execution = {},
                                                 Processes& processes = one_process());

/// Stepper of the same plate without its motion, which is to be read from where it was kept.
std::unique_ptr<motion::TimeStepper> make_stepper(const Problem& problem, InitialState& initial,
                                                  const motion::Execution& execution = {},
                                                  Processes& processes = one_process());

/// The event of a case, about to begin with a started stepper; see motion::EventRun.
/// @param sinks  of its outputs
motion::EventRun begin_event(const Problem& problem, const InitialState& initial,
                             motion::TimeStepper& stepper, const motion::Monitor& monitor,
                             const results::Sinks& sinks, motion::Observers more = {});

}  // namespace slipfront::setup
