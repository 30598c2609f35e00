// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fronts/front.hpp"
#include "motion/event.hpp"
#include "solid/material.hpp"

namespace slipfront::verification {

/// A rupture of a prestressed interface, its fronts tracked with one length scale.
struct Rupture {
  motion::Event event;
  std::vector<fronts::Front> fronts;
  record::History history;  ///< without places
};

/// Runs a stepper that has been started to the end of its time.
/// @param state     from which it was started
/// @param material  of the body above
Rupture run_rupture(motion::TimeStepper& stepper, const statics::Equilibrium& state,
                    const motion::TimeStepping& time, const solid::Material& material, double mu_s,
                    double history_interval_s, double energy_interval_s);

double mean(const std::vector<double>& values);

}  // namespace slipfront::verification
