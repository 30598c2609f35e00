// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "boundary/boundary.hpp"
#include "mesh/mesh.hpp"
#include "record/record.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "statics/plate_solver.hpp"
#include "statics/settings.hpp"
#include "statics/sliding_interface.hpp"

namespace slipfront::statics {

/// Contact of the interface nodes and where they have been. [interface nodes]
struct ContactStates {
  Support support;
  std::vector<std::uint8_t> has_touched;  ///< whether the node has been in contact
};

/// Equilibrium of the plate with its interface, and how it changes with the shear.
///
/// What limits the shear inside is the largest t/(mu_s p); peak_ratio and peak_x_m belong to its node.
///
/// Without displacements nothing is strained, and with the loaded edge nothing else moves.
struct Equilibrium {
  solid::Field u_m;          ///< [nodes] displacement
  solid::Field u_per_shear;  ///< [nodes] change of u per unit displacement of the loaded edge along x
  /// Displacements of a base, described upside down; empty for the rigid plane.
  solid::Field below_u_m, below_u_per_shear;
  double shear_m = 0;  ///< displacement of what loads along x since normal loading: the edge, or the machine
  std::vector<Contact> contact;               ///< [interface nodes]
  record::StaticState tractions;              ///< [interface nodes]
  double peak_ratio = 0;                      ///< t/p where t/(mu_s p) is largest inside, along the load
  double peak_x_m = 0;                        ///< where that is
  double inside_from_m = 0, inside_to_m = 0;  ///< the part of the contact that counts as inside
  bool is_inside(double x_m) const { return x_m >= inside_from_m && x_m <= inside_to_m; }
  std::array<solid::Field*, 4> displacements() {
    return {&u_m, &u_per_shear, &below_u_m, &below_u_per_shear};
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(u_m, u_per_shear, below_u_m, below_u_per_shear, shear_m, contact, tractions, peak_ratio, peak_x_m,
            inside_from_m, inside_to_m);
  }
};

/// Whether an equilibrium that was kept can be one of these interface nodes, with finite numbers, and with
/// displacements, if any, of so many nodes of the plate and of the base.
bool is_possible(const Equilibrium& state, const std::vector<double>& x_m, std::size_t n_nodes,
                 std::size_t n_below);

/// Sums of the tractions over the interface, per unit thickness, with their signs.
struct ContactForce {
  double normal_N_per_m = 0, shear_N_per_m = 0;
};
/// Lists [interface nodes].
ContactForce contact_force(std::span<const double> p_Pa, std::span<const double> t_Pa,
                           std::span<const double> tributary_m);
ContactForce contact_force(const Equilibrium& state, std::span<const double> tributary_m);

/// Whether a ratio t/p is a larger share of its mu_s than another one of its own.
bool is_nearer_to_slip(double ratio, double mu_s, double other_ratio, double other_mu_s);

/// Loading of the plate at rest: tilt, then shear until t/p reaches a given share of mu_s somewhere inside
/// the interface, or until the tractions add up to a given force.
///
/// Where `loading` gives the normal force, the tilt is the one that it takes: with the contact as it is the
/// force is linear in how far the edge is pressed down, and both are corrected in turn until they agree.
///
/// Nodes stick where they touch; a node whose pressure would be tensile is released; a node beyond mu_s slips
/// at mu_s p, but inside only sticking is possible since the shear ends where mu_s is reached there.
class Statics {
 public:
  /// Asked before each linear solution; where it says no, Interrupted is thrown.
  using MayContinue = std::function<bool()>;

  /// @param base      what the plate stands on; nothing for the rigid plane
  /// @param mu_s      coefficient at rest of each interface node. [interface nodes]
  /// @param mu_s_key  key of mu_s in the case file, for messages
  /// @param may_continue of all solutions, those of later calls included
  /// @throws UserError where the tilt leaves the plate without contact, or where `loading` asks for an
  /// iterative solution on a base; Interrupted.
  Statics(
      const ElasticBody& plate, const std::optional<ElasticBody>& base, const Loading& loading,
      std::vector<double> mu_s, std::string mu_s_key = "friction.mu_s",
      MayContinue may_continue = [] { return true; });
  /// On the rigid plane, with one coefficient everywhere.
  Statics(
      const mesh::Mesh& mesh, const solid::Material& material, const Loading& loading, double mu_s,
      std::string mu_s_key = "friction.mu_s", MayContinue may_continue = [] { return true; });
  ~Statics();

  /// The tilted plate before any shear.
  const Equilibrium& tilted() const { return tilted_; }

  /// From here on nodes in contact stick where they have come to rest after slip, not where the tilt has put
  /// them. The shear of the loaded edge still counts from the tilt.
  /// @param u_x_m  displacements along x relative to those of a base [interface nodes]
  void hold(std::vector<Contact> contact, std::vector<double> u_x_m);

  /// Other coefficients at rest, from here on. [interface nodes]
  /// @param key  of the case file, which decides on it
  void set_mu_s(std::vector<double> mu_s, std::string key);

  /// Equilibrium at the shear at which the largest t/(mu_s p) inside equals `share`.
  /// @throws UserError where no shear does it.
  Equilibrium shear_to(double share) const;

  /// The largest t/(mu_s p) inside.
  double share_of_strength(const Equilibrium& state) const;

  /// Equilibrium at a given shear since normal loading.
  Equilibrium shear_by(double shear_m) const;

  /// Equilibrium with the nodes that stick anywhere along x, whatever friction bears. Others slip without it.
  /// @param u_x_m  displacements along x relative to those of a base [interface nodes]
  /// @param u_x_per_shear  how they move on with the shear
  /// @pre the statics are solved by a factorisation
  Equilibrium slid_to(std::vector<Contact> contact, std::vector<double> u_x_m,
                      std::vector<double> u_x_per_shear, double shear_m) const;
  /// Tractions of such equilibria.
  /// @pre as above
  std::unique_ptr<SlidingInterface> sliding(const std::vector<Contact>& contact) const;

  /// Equilibrium at the shear at which the shear tractions add up to a force, per unit thickness.
  /// @throws UserError where the tilt alone has a larger one, or no shear gives it.
  Equilibrium shear_to_force(double force_N_per_m) const;

  /// Energy in the machine's springs less the work of its constant forces, since normal loading.
  double machine_energy_J_per_m(const Equilibrium& state) const;

  /// Where the force along x acts on the plate: at the height of the loaded edge, or amid a pusher's forces;
  /// nan where that does not push.
  double shear_height_m(const Equilibrium& state) const;

  /// The loading with the displacements that give its normal force.
  const Loading& loading() const { return loading_; }

  const PlateSolver& solver() const { return *solver_; }

 private:
  /// Presses the plate down by displacements of its loaded edge, or by the pressure on it.
  void press_down(const ElasticBody& plate, const std::optional<ElasticBody>& base);
  template <class Problem>
  Equilibrium equilibrium(const Problem& problem, double shear_m) const;
  /// What the machine's springs bear in the tilted plate.
  solid::Field tilt_force_N(const solid::Material& material) const;
  /// @param sticks_inside  slip there is none, but of a guess
  template <class FindShear>
  Equilibrium shear(FindShear&& find_shear, bool sticks_inside) const;
  /// The share of mu_s where `state` has its peak.
  double ratio_at_peak(const Equilibrium& state, double share) const;
  /// That in messages; a number where mu_s is uniform.
  std::string name_of_ratio(double share) const;

  const mesh::Mesh& mesh_;
  boundary::Boundary boundary_;
  const mesh::Mesh* base_mesh_;  ///< null on the rigid plane
  Loading loading_;
  std::vector<double> mu_s_;  ///< [interface nodes]
  std::string mu_s_key_;
  MayContinue may_continue_;
  std::unique_ptr<PlateSolver> solver_;
  solid::BlockRows pushed_rows_;  ///< of K
  TopDisplacement tilted_top_;    ///< the loaded edge after the tilt
  std::unique_ptr<LoadCase>
      sheared_;  ///< the loaded edge where it stands after normal loading, then moved along x
  Equilibrium tilted_;
  /// What nodes in contact hold before the shear: the tilted plate's, or after slip.
  std::vector<Contact> held_contact_;
  std::vector<double> held_u_x_m_;  ///< [interface nodes] relative to a base
  /// Contact states of the last shear, where beginning with them pays.
  mutable std::optional<ContactStates> last_;
};

}  // namespace slipfront::statics
