// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "input/table_along_x.hpp"
#include "interface/interface.hpp"
#include "mesh/node_columns.hpp"
#include "problem/problem.hpp"

// Friction at the nodes of the interface, and the slip rates that divide its regimes.
namespace slipfront::problem {

using input::position_tolerance;

/// The law of each interface node at x_m; none where all have the same.
/// @param healed  by how much mu_s of each has grown at rest; empty where it has not
/// @throws UserError where the table does not reach from the first to the last of them, or a node's
/// parameters are not allowed.
std::vector<interface::FrictionLaw> friction_at(const Problem& problem, const std::vector<double>& x_m,
                                                const std::vector<double>& healed = {});

/// Slip rate at which the direct effect a p/V is as steep as the bodies' radiation damping: inertia limits
/// faster slip.
/// @pre the law has a state
double radiation_slip_rate_m_per_s(const Problem& problem);
/// That of radiation, at least 10 V_i.
double default_tip_slip_rate_m_per_s(const Problem& problem);
/// Slip rate beyond which a node under a law that never sticks counts as slipping: the given one, or the
/// default.
/// @pre the law has a state
double tip_slip_rate_m_per_s(const Problem& problem);
/// Slip rate of the fastest node at which an event begins in a sequence of a law with a state, the given one
/// or a tenth of both of these, and up to which equilibria follow it: half of that.
double inertia_slip_rate_m_per_s(const Problem& problem);
double slow_slip_rate_m_per_s(const Problem& problem);

/// Contact and friction of some of the interface nodes at x_m.
/// @throws UserError as friction_at
interface::ContactModel contact_model(const Problem& problem, const std::vector<double>& x_m,
                                      const std::vector<double>& healed = {},
                                      const mesh::Subset& places = {});

}  // namespace slipfront::problem
