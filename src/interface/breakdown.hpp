// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "interface/interface.hpp"
#include "record/breakdown.hpp"

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

}  // namespace slipfront::interface
