// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// What elastic bodies in equilibrium do at their interface when those of its nodes that stick are given
/// places along x. Nodes that slip do so without friction. All spans [interface nodes].
class SlidingInterface {
 public:
  /// An affine map of the places of the nodes that stick and of the shear, to a value at each of some nodes.
  struct Map {
    std::vector<std::size_t> nodes;
    std::vector<double> matrix;  ///< by columns, [nodes x nodes that stick]
    std::vector<double> at_0, per_shear;
  };

  /// @param t_Pa   of the nodes that stick
  /// @param u_x_m  of the others, relative to a base
  /// @param p_Pa   of the nodes in contact
  /// @param gap_m  what lies between the surfaces at open nodes
  SlidingInterface(std::vector<Contact> contact, Map t_Pa, Map u_x_m, Map p_Pa, Map gap_m);

  /// @param u_x_m  relative to a base; of nodes that do not stick it becomes that of the equilibrium
  /// @param t_Pa, p_Pa  0 of open nodes, and of those that slip t
  /// @param gap_m       what lies between the surfaces, negative where they overlap; 0 in contact
  void equilibrate(double shear_m, std::span<double> u_x_m, std::span<double> t_Pa, std::span<double> p_Pa,
                   std::span<double> gap_m) const;
  const std::vector<Contact>& contact() const { return contact_; }

 private:
  std::vector<Contact> contact_;
  Map t_Pa_, u_x_m_, p_Pa_, gap_m_;
  mutable std::vector<double> u_stuck_m_, values_;
};

}  // namespace slipfront::statics
