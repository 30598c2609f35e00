// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "input/case.hpp"
#include "mesh/node_columns.hpp"

namespace slipfront::input {

/// Reads a CSV file with a header of x_m and any of the law's parameters, and a row per position, x
/// ascending. Lines that are empty or begin with # are passed over. The file is read once: it may be a pipe.
/// @param law  the case's; parameters without a column keep its values
/// @throws UserError with file, line and what to do.
FrictionTable read_friction_table(const std::filesystem::path& file, const interface::FrictionLaw& law);

/// The law of each interface node at x_m; none where all have the case's.
/// @throws UserError where the table does not reach from the first to the last of them, or a node's
/// parameters are not allowed.
std::vector<interface::FrictionLaw> friction_at(const Case& config, const std::vector<double>& x_m);

/// The same case with these laws at the nodes of the interface, as a table.
Case with_friction_at(Case config, const std::vector<double>& x_m,
                      const std::vector<interface::FrictionLaw>& laws);

/// Slip rate at which the direct effect a p/V is as steep as the bodies' radiation damping: inertia limits
/// faster slip.
/// @pre the law has a state
double radiation_slip_rate_m_per_s(const Case& config);
/// Slip rate beyond which a node under a law that never sticks counts as slipping: the case's, or that of
/// radiation, at least 10 V_i.
/// @pre the law has a state
double tip_slip_rate_m_per_s(const Case& config);
/// Slip rate of the fastest node at which an event begins in a sequence of a law with a state, the case's or
/// a tenth of both of these, and up to which equilibria follow it: half of that.
double inertia_slip_rate_m_per_s(const Case& config);
double slow_slip_rate_m_per_s(const Case& config);

/// Contact and friction of some of the interface nodes at x_m.
/// @throws UserError as friction_at
interface::ContactModel contact_model(const Case& config, const std::vector<double>& x_m,
                                      const mesh::Subset& places = {});

}  // namespace slipfront::input
