// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "boundary/boundary.hpp"
#include "mesh/mesh.hpp"
#include "solid/operator.hpp"
#include "statics/elastic_body.hpp"
#include "statics/settings.hpp"

namespace slipfront::statics {

/// Contact state of an interface node at rest.
enum class Contact : std::uint8_t { stick, slip, open };

/// Which displacements of the loaded edge are prescribed; machine: those that a rigid machine moves, at that
/// edge and under the pusher.
enum class TopConstraint { both, vertical, machine };
/// What holds a plate that is sheared.
inline TopConstraint constraint_under_shear(const boundary::Boundary& boundary) {
  return boundary.driven.empty() ? TopConstraint::machine : TopConstraint::both;
}

/// How the loaded edge, or what is pushed, moves on from its prescribed displacements, by a length that
/// LoadCase calls the shear.
enum class EdgeMotion : std::uint8_t { none, along_x, down };

/// Prescribed displacements of the loaded edge, in the order of mesh.far_edge_nodes (u_x is ignored where
/// only the vertical is prescribed), and of the nodes under the pusher, where they are; with a machine's
/// spring in between, those at which it bears its force of the tilt.
struct TopDisplacement {
  std::vector<double> u_x_m, u_y_m, pushed_u_x_m = {};
  solid::Field tilt_force_N = {};  ///< of springs [nodes]; empty: none

  void add(double share, const TopDisplacement& more);
};
/// Moved on by 1 m.
TopDisplacement unit_motion(const mesh::Mesh& mesh, const boundary::Boundary& boundary, EdgeMotion motion);

/// What the contact does to each node of mesh.interface_nodes: u_y = -gap unless open, u_x = anchor where it
/// sticks, f_x = -slip_sign mu_s f_y where it slips. u is the displacement relative to the rigid plane, or to
/// a base.
struct Support {
  std::vector<Contact> contact;
  std::vector<double> slip_sign;   ///< of t where the node slips
  std::vector<double> anchor_x_m;  ///< u_x where the node sticks, or began to slip
  std::vector<double> mu_s;
  std::vector<double> anchor_x_per_shear = {};  ///< how it moves on where the node sticks; empty: it stays
  bool operator==(const Support&) const = default;
};

/// How far the interface of the undeformed bodies is open. [interface nodes]
std::vector<double> gaps_m(const mesh::Mesh& plate, const mesh::Mesh* base);

class LoadCase;          // load_case.hpp
class SlidingInterface;  // sliding_interface.hpp

/// Displacements of all nodes that are kept elsewhere: of the plate, and of the base where there is one.
struct DisplacementOfBodies {
  const solid::Field* above;
  const solid::Field* below = nullptr;
};

/// Solves the linear equilibria of one plate on the rigid plane or on a base.
class PlateSolver {
 public:
  virtual ~PlateSolver() = default;
  /// The loaded edge at `top`, and moved on by `motion`. `start`: a guess of the displacement at `top` on the
  /// finest level, or null.
  virtual std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top,
                                              EdgeMotion motion, const DisplacementOfBodies* start,
                                              int level) = 0;
  virtual int n_levels() const { return 1; }
  /// Interface nodes of a level, as places in mesh.interface_nodes.
  virtual std::vector<std::size_t> interface_of(int level) const = 0;
  virtual std::int64_t n_unknowns() const = 0;
  /// Bytes it holds.
  virtual double bytes() const = 0;
  /// Whether each solution only costs what it has to change of the last one, so that beginning with the
  /// states of a similar case pays.
  virtual bool iterates() const { return false; }
  /// Multigrid cycles on the finest level so far; 0 where there are none.
  virtual int n_cycles() const { return 0; }
  /// Sliding of a plate held as under shear.
  /// @pre it solves directly
  virtual std::unique_ptr<SlidingInterface> sliding(const TopDisplacement& top,
                                                    const std::vector<Contact>& contact) const;
};

/// Up to here a factorisation is chosen by StaticSolver::automatic: elements of 0.333 mm on the paper's plate
/// are the finest ones for which it takes seconds.
inline constexpr double max_direct_unknowns = 400e3;
/// `wanted`, or what suits the number of unknowns.
StaticSolver choose_solver(StaticSolver wanted, double n_unknowns);

/// What matters of a body's mesh for the choice of a solver: elements along x, and along y where all are
/// squares of one size.
struct Shape {
  double columns = 0, rows = 0;
  bool is_graded = false;
};

/// What the shapes of a plate and of a base leave of `wanted`. Graded plates are solved directly. Multigrid
/// cannot follow a plate far higher than wide, nor make two bodies coarser of which one is far thinner; there
/// a factorisation is cheap. On a long interface its dense part is not.
StaticSolver solver_for_shapes(StaticSolver wanted, const Shape& plate,
                               const std::optional<Shape>& base = std::nullopt);

/// Rows over columns, and of one body over the other's, up to which automatic takes multigrid, and columns up
/// to which it takes a factorisation.
inline constexpr double max_iterative_slenderness = 10, max_iterative_height_ratio = 16,
                        max_direct_columns = 1500;

std::string_view name_of(StaticSolver solver);

/// By the solver that the bodies' shapes leave of `solver`.
std::unique_ptr<PlateSolver> make_plate_solver(const ElasticBody& plate, StaticSolver solver,
                                               const std::optional<ElasticBody>& base = std::nullopt);

}  // namespace slipfront::statics
