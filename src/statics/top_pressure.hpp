// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace slipfront::statics {

/// Pressure on the loaded edge along x: linear between its places, constant beyond the first and the last.
struct TopPressure {
  std::vector<double> x_m, p_Pa;  ///< as many of each, ascending along x; none: displacements press

  bool is_there() const { return !p_Pa.empty(); }
  /// Forces downwards of an edge's nodes, linear between them, that do the work of the pressure.
  /// @param nodes_x_m  ascending
  /// @pre is_there()
  std::vector<double> forces_N_per_m(const std::vector<double>& nodes_x_m) const;
  /// Its integral over an edge from 0 to a width, per unit thickness.
  double force_N_per_m(double width_m) const;
};

}  // namespace slipfront::statics
