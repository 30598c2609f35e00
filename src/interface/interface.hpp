// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/state.hpp"
#include "interface/friction.hpp"
#include "interface/node_laws.hpp"
#include "interface/regularisation.hpp"

namespace slipfront::interface {

/// How contact is resolved within a (sub-)step.
enum class ContactAlgorithm {
  /// Closes gaps exactly at the step's end by a pressure; mu at the mean slip rate of the step; friction
  /// opposes the motion that the forces would give.
  direct,
  /// Locks the normal velocity in contact; a node that would pass the plane is put onto it, its normal
  /// velocity
  /// lost without a pressure; mu at the slip rate predicted for the step's beginning, which friction opposes.
  predictor_corrector,
};

/// All that decides on the tractions of the plane.
struct ContactModel {
  FrictionLaw law;
  Regularisation regularisation = {};
  ContactAlgorithm algorithm = ContactAlgorithm::direct;
  NodeLaws of_nodes = {};  ///< instead of `law`, and of its type; empty where all nodes have that one

  const FrictionLaw& law_at(std::size_t node) const { return of_nodes.empty() ? law : of_nodes[node]; }
};

/// State of the interface nodes between two (sub-)steps, contiguous and component by component. All arrays
/// [nodes].
///
/// Signs: tractions of the plane on the plate, p >= 0 in compression, t > 0 when it opposes sliding to +x.
struct Interface {
  // Set once.
  std::vector<double> initial_gap_m;          ///< height of the undeformed node above the plane
  std::vector<double> mass_per_length_kg_m2;  ///< lumped mass over tributary length
  /// Effective mass along x over that along y, mass_per_length_kg_m2: 1 but for nodes with dashpots.
  std::vector<double> tangential_mass_ratio;
  /// 1 is the full law; mu = mu_k + intact (mu_law - mu_k), so that 0 is a node weakened for good.
  std::vector<double> intact;
  // The motion, gathered from and scattered to the plate.
  std::vector<double> v_x_m_per_s, v_y_m_per_s;  ///< trial half-step velocity in, corrected velocity out
  /// Displacement at the start of the (sub-)step, to which the corrected velocity adds. The
  /// predictor-corrector algorithm puts nodes that land onto the plane here.
  std::vector<double> u_y_m;
  // The result of the contact update.
  std::vector<double> slip_rate_m_per_s;  ///< last half-step velocity along x; 0 where the node sticks
  std::vector<double> t_Pa, p_Pa;
  std::vector<double> trial_traction_Pa;  ///< |t| that would stop the node
  /// Strength in the last update; of a node that begins to slip the one that it has overcome, of a node that
  /// sticks the one at rest, of an open node 0.
  std::vector<double> strength_Pa;
  std::vector<std::uint8_t> slipping;  ///< 1 where the node is in contact and slips
  // Memory of friction and contact.
  std::vector<double> slip_m;  ///< slip path, the sum of |slip rate| dt in contact; see SlipMemory
  /// Strength or pressure by the regularisation, and what it follows; else 0.
  std::vector<double> relaxed_Pa, target_Pa;
  std::vector<double> acceleration_m_per_s2;  ///< along x, of the last update; predictor-corrector only
  std::vector<std::uint8_t> locked;  ///< 1 where the normal velocity is locked; predictor-corrector only
  bool begun = false;                ///< whether there was an update since start_contact

  explicit Interface(std::size_t n);
  std::size_t size() const { return t_Pa.size(); }

  /// All that changes.
  template <class Archive>
  void serialize(Archive& archive) {
    for (auto* values :
         {&intact, &v_x_m_per_s, &v_y_m_per_s, &u_y_m, &slip_rate_m_per_s, &t_Pa, &p_Pa, &trial_traction_Pa,
          &strength_Pa, &slip_m, &relaxed_Pa, &target_Pa, &acceleration_m_per_s2})
      archive_vector(archive, *values);
    archive_vector(archive, slipping);
    archive_vector(archive, locked);
    archive(begun);
  }
};

/// Begins the memory of friction in a state of given p: no slip yet, strength mu(0) p, relaxed strength or
/// pressure in equilibrium with it, nodes under pressure in contact. `intact` is taken as it is: a patch that
/// is weakened after this call loses its strength at the rate of the regularisation.
void start_contact(const ContactModel& model, Interface& state);

/// Contact and friction update for lumped mass. Reads the trial motion and the memory, writes all results and
/// the memory of `state`.
/// @return whether a node began or ceased to slip.
bool update_contact(const ContactModel& model, double dt_s, Interface& state);

}  // namespace slipfront::interface
