// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/problem.hpp"
#include "results/outputs.hpp"
#include "setup/initial_state.hpp"

namespace slipfront::setup {

/// What a run's HDF5 files say of where they come from.
results::Origin origin_of(const Problem& problem);

/// What the outputs of a case's event are made of, as far as the case tells, see results::Output::forecast.
results::OutputSetup output_setup(const Problem& problem, double step_s, double n_interface, double n_nodes);
results::OutputSetup output_setup(const Problem& problem, const InitialState& initial, double step_s);

}  // namespace slipfront::setup
