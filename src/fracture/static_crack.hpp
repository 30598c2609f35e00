// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <vector>

#include "fracture/tip.hpp"

namespace slipfront::fracture {

/// How the tractions of an interface answer slip at rest, its ends and loaded edges held where they are and
/// no contact lost. Changes of t and p at node k by slip at node j are (k, j) of these, Pa/m.
struct SlipResponse {
  std::vector<double> x_m;  ///< [nodes] ascending
  Eigen::MatrixXd t_per_slip, p_per_slip;

  double spacing_m() const { return (x_m.back() - x_m.front()) / static_cast<double>(x_m.size() - 1); }
};

/// Response of bodies without end: slip of a node is uniform between the middles to its neighbours.
/// @pre nodes at equal distances
SlipResponse response_of_half_spaces(const Bodies& bodies, const std::vector<double>& x_m);

/// Response of a sample.
/// @param stiffness_N_per_m  condensed to the interface, x and y of each node in turn: forces on the plate by
///                           relative displacements
SlipResponse response_of_sample(const Eigen::MatrixXd& stiffness_N_per_m, std::vector<double> x_m,
                                const std::vector<double>& tributary_m);

/// What a crack along the interface releases. [nodes]
struct CrackLoads {
  std::vector<double> t_Pa, p_Pa;            ///< before it
  std::vector<double> residual_coefficient;  ///< residual traction: cohesion and this times p
  std::vector<double> cohesion_Pa;
};

/// A crack along an interface that grows node by node, its nodes at the residual traction, the others stuck.
///
/// The energy release rate of a node to be released is half of what t exceeds the residual traction by, times
/// the slip that takes this away, over the node's length: without friction that is what Pi, strain energy and
/// work of the residual tractions, loses; where slip changes p it is the flux into the tip less the heat of
/// friction behind it.
class StaticCrack {
 public:
  StaticCrack(const SlipResponse& response, const CrackLoads& loads);

  /// J/m2 of the node beside the crack on a side, -1 left or +1 right; 0 where its t is below the residual
  /// one. Any node where there is no crack yet. NaN beyond the ends.
  double energy_release_rate_J_per_m2(int side) const;
  /// Pa/m that the traction of the node beside the crack falls by over its slip, the crack's nodes following.
  double stiffness_Pa_per_m(int side) const { return beside_[side > 0].pivot; }
  /// The node beside the crack; -1 or the number of nodes beyond the ends.
  std::ptrdiff_t next(int side) const { return beside_[side > 0].node; }
  bool has_next(int side) const { return is_node(next(side)); }
  /// Begins at a node.
  void begin(std::size_t node);
  /// Releases the node beside the crack. @pre there is one
  void release(int side);

 private:
  /// A node's row and column of the factors, up to those of the crack's nodes, and what is unbalanced there.
  struct Candidate {
    std::ptrdiff_t node = -1;
    Eigen::VectorXd row, column;
    double pivot = 0, unbalanced_Pa = 0;
  };
  double entry(std::size_t k, std::size_t j) const;
  bool is_node(std::ptrdiff_t node) const { return node >= 0 && node < std::ssize(response_.x_m); }
  Candidate candidate(std::ptrdiff_t node) const;
  void extend(Candidate& candidate) const;  ///< by the crack's last node
  void add(const Candidate& candidate);

  const SlipResponse& response_;
  const CrackLoads& loads_;
  std::vector<std::size_t> nodes_;   ///< of the crack, in the order of release
  Eigen::MatrixXd lower_, upper_;    ///< factors of their equations, without pivoting
  Eigen::VectorXd unbalanced_Pa_;    ///< right-hand side after elimination
  std::array<Candidate, 2> beside_;  ///< the crack, on the left and on the right
};

/// Length of a patch about a node over which slip that weakens friction linearly goes on without further load
/// (Uenishi and Rice 2003), to half an element: it grows to both sides, at an end of the contact to the other
/// alone. Not a number where none does, or it is shorter than four elements.
/// @param coefficient         friction before it weakens [nodes]
/// @param weakening_Pa_per_m  fall of the strength over slip [nodes]
double nucleation_length_m(SlipResponse response, const std::vector<double>& coefficient,
                           const std::vector<double>& weakening_Pa_per_m, std::size_t node);

}  // namespace slipfront::fracture
