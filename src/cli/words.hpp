// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "input/schema.hpp"
#include "problem/problem.hpp"
#include "record/sequence.hpp"
#include "run/run.hpp"
#include "solid/material.hpp"

namespace slipfront::cli {

/// A number with the prefix of its unit that leaves 1 to 1000 before the point: "71.9 us", "2.6 GPa".
std::string engineering(double value, const char* unit, int digits = 4);

/// What a case is of: bodies, material, mean pressure, law, event.
std::string set_up(const Problem& problem);

/// "1080 m/s (0.68 c_L, 1.21 c_S)"
std::string speed(double m_per_s, const solid::WaveSpeeds& speeds);

/// What has become of a run: how far its longest front went, how fast, and where it ended.
std::string outcome(const run::Result& result);

/// What has become of a sequence: how many events, and how far they slipped.
std::string outcome(const std::vector<record::SequenceEvent>& events);

/// Median speed of a front; none where all of it is undefined.
double median_speed_m_per_s(const fronts::Front& front);
/// Whether all of a front's speeds are the trigger's.
bool is_of_trigger(const fronts::Front& front);
/// Median of the breakdown work that came to its end along a front.
double fracture_energy_J_per_m2(const run::Result& result, const fronts::Front& front);

/// Notes, a line each: what the case file says in vain, and of the case.
std::string lines_of(const input::CaseFile& given, const Diagnostics& notes);

}  // namespace slipfront::cli
