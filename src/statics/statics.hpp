// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "record/record.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "statics/plate_solver.hpp"
#include "statics/settings.hpp"

namespace slipfront::statics {

/// Contact of the interface nodes and where they have been. [lower]
struct ContactStates {
  Support support;
  std::vector<std::uint8_t> has_touched;  ///< whether the node has been in contact
};

/// Equilibrium of the plate with its interface, and how it changes with the shear.
struct Equilibrium {
  solid::Field u_m;          ///< [nodes] displacement
  solid::Field u_per_shear;  ///< [nodes] change of u per unit displacement of the loaded edge along x
  /// The same of a deformable body below, described upside down; empty for the rigid plane.
  solid::Field below_u_m, below_u_per_shear;
  double shear_m = 0;                         ///< displacement of the loaded edge along x since the tilt
  std::vector<Contact> contact;               ///< [lower]
  record::StaticState tractions;              ///< [lower]
  double peak_ratio = 0;                      ///< largest t/p inside
  double peak_x_m = 0;                        ///< where it is
  double inside_from_m = 0, inside_to_m = 0;  ///< the part of the contact that counts as inside

  template <class Archive>
  void serialize(Archive& archive) {
    archive(u_m, u_per_shear, below_u_m, below_u_per_shear, shear_m, contact, tractions, peak_ratio, peak_x_m,
            inside_from_m, inside_to_m);
  }
};

/// Whether an equilibrium has a contact and tractions at each of so many interface nodes.
bool has_nodes(const Equilibrium& state, std::size_t n_lower);

/// Loading of the plate at rest: tilt, then shear until t/p inside the interface reaches a given value.
///
/// Nodes stick where they touch; a node whose pressure would be tensile is released; a node beyond mu_s slips
/// at mu_s p, but inside only sticking is possible since the shear ends where mu_s is reached there.
class Statics {
 public:
  /// Asked before each linear solution; where it says no, Interrupted is thrown.
  using GoOn = std::function<bool()>;

  /// @param mu_s_key  key of mu_s in the case file, for messages
  /// @param go_on     of all solutions, those of later calls included
  /// @throws UserError where the tilt presses no node against the plane; Interrupted.
  Statics(
      const mesh::Mesh& mesh, const solid::Material& material, const Loading& loading, double mu_s,
      std::string mu_s_key = "friction.mu_s", GoOn go_on = [] { return true; });
  ~Statics();

  /// The tilted plate before any shear.
  const Equilibrium& tilted() const { return tilted_; }

  /// Equilibrium at the shear at which the largest t/p inside equals `ratio`.
  /// @throws UserError where no shear does it.
  Equilibrium shear_to(double ratio) const;

  /// Equilibrium at a given shear since the tilt.
  Equilibrium shear_by(double shear_m) const;

  const PlateSolver& solver() const { return *solver_; }

 private:
  template <class FindShear>
  Equilibrium shear(FindShear&& find_shear) const;

  const mesh::Mesh& mesh_;
  Loading loading_;
  double mu_s_;
  std::string mu_s_key_;
  GoOn go_on_;
  std::unique_ptr<PlateSolver> solver_;
  TopDisplacement tilted_top_;         ///< the loaded edge after the tilt
  std::unique_ptr<LoadCase> sheared_;  ///< the loaded edge where it stands after the tilt, then moved along x
  Equilibrium tilted_;
  /// Contact states of the last shear, where beginning with them pays.
  mutable std::optional<ContactStates> last_;
};

}  // namespace slipfront::statics
