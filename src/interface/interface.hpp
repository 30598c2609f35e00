// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interface/friction/registry.hpp"

namespace slipfront::interface {

/// State of the interface nodes between two (sub-)steps, contiguous and component by component. All arrays
/// [nodes].
///
/// Signs: tractions of the plane on the plate, p >= 0 in compression, t > 0 when it opposes sliding to +x.
struct Interface {
  // Set once.
  std::vector<double> initial_gap_m;          ///< height of the undeformed node above the plane
  std::vector<double> mass_per_length_kg_m2;  ///< lumped mass over tributary length
  // The motion, gathered from and scattered to the plate.
  std::vector<double> v_x_m_per_s, v_y_m_per_s;  ///< trial half-step velocity in, corrected velocity out
  std::vector<double> u_y_m;                     ///< displacement at the start of the (sub-)step
  // The result of the contact update.
  std::vector<double> slip_rate_m_per_s;  ///< last half-step velocity along x; 0 where the node sticks
  std::vector<double> t_Pa, p_Pa;
  std::vector<double> demand_Pa;       ///< |t| that would stop the node
  std::vector<std::uint8_t> slipping;  ///< 1 where the node is in contact and slips

  explicit Interface(std::size_t n);
  std::size_t size() const { return t_Pa.size(); }
};

/// Direct (forward-increment) contact and friction update for lumped mass: closes gaps exactly at the end of
/// the (sub-)step, stops the node where friction can, and lets it slip at mu(|v|) p elsewhere, with |v| the
/// last half-step slip rate. Writes all results of `state`.
/// @return whether a node began or ceased to slip.
bool update_contact(const FrictionLaw& law, double dt_s, Interface& state);

}  // namespace slipfront::interface
