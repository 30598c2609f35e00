// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "interface/interface.hpp"
#include "record/breakdown.hpp"
#include "record/record.hpp"

namespace slipfront::interface {

/// Follows the breakdown of friction at nodes that have begun to slip, see record::Breakdown; after a contact
/// update of length dt_s.
/// @param v_before_m_per_s  relative half-step velocities along x before it [nodes]
/// @param changed           update_contact's answer
void follow_breakdown(const ContactModel& model, double dt_s, std::span<const double> v_before_m_per_s,
                      bool changed, Interface& state);

/// What has been found so far at the nodes [first, end).
record::Breakdown breakdown_of(const ContactModel& model, const Interface& state, std::size_t first,
                               std::size_t end);

/// Breakdown by the samples of a history, its integrals by trapezoids. A node slips while |slip rate| is
/// above threshold_m_per_s; slip begins with the sample before.
/// @pre numbers are finite, matrices of matching sizes
record::Breakdown breakdown_from_history(const record::History& history, double threshold_m_per_s,
                                         double cohesion_Pa);

}  // namespace slipfront::interface
