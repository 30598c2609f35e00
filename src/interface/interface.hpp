// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

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
  NodeLaws law_per_node = {};  ///< instead of `law`, and of its type; empty where all nodes have that one
  /// Under a law that never sticks a node counts as slipping beyond this slip rate.
  double tip_slip_rate_m_per_s = 0.1;

  const FrictionLaw& law_at(std::size_t node) const {
    return law_per_node.empty() ? law : law_per_node[node];
  }
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
  /// 1 is the full law, 0 a node weakened for good: mu = mu_k + intact (mu_law - mu_k); is_time_weakening: mu
  /// is that of the law, but at most mu_k + intact (mu_s - mu_k).
  std::vector<double> strength_fraction;
  // The motion, gathered from and scattered to the plate.
  std::vector<double> v_x_m_per_s, v_y_m_per_s;  ///< trial half-step velocity in, corrected velocity out
  /// Displacement at the start of the (sub-)step, to which the corrected velocity adds. The
  /// predictor-corrector algorithm puts nodes that land onto the plane here.
  std::vector<double> u_y_m;
  // The result of the contact update.
  std::vector<double> slip_rate_m_per_s;  ///< last half-step velocity along x; 0 where the node sticks
  std::vector<double> t_Pa, p_Pa;
  /// Passes 1 where a node begins to slip: |t| that would stop it over its strength; under a law that never
  /// sticks its slip rate over ContactModel::tip_slip_rate_m_per_s. 0 of a node without strength.
  std::vector<double> onset_ratio;
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
  /// State variables of the friction law, see FrictionLaw::states.
  LawStates law_states;
  bool is_time_weakening = false;
  bool begun = false;  ///< whether there was an update since start_contact

  explicit Interface(std::size_t n, std::span<const LawState> states_of_law = {});
  std::size_t size() const { return t_Pa.size(); }
};

/// Where the values of a field come from; halos and checkpoints follow from it.
enum class FieldKind {
  body,    ///< from the bodies
  load,    ///< from the event's loads; a checkpoint is compared with them
  trial,   ///< made anew in each update, and read by nobody between two of them
  result,  ///< of the last update, read between two of them: in checkpoints
  memory,  ///< from one update to the next: in halos and checkpoints
};

/// An array of Interface.
struct InterfaceField {
  const char *name, *unit;
  FieldKind kind;
  std::variant<std::vector<double> Interface::*, std::vector<std::uint8_t> Interface::*> array;
  std::uint8_t initial = 0;
};

/// All arrays but those of the friction law. One that is added here is allocated, sent in halos, kept in
/// checkpoints and restored.
inline constexpr std::array<InterfaceField, 18> interface_fields = {{
    {"initial_gap", "m", FieldKind::body, &Interface::initial_gap_m},
    {"mass_per_length", "kg/m2", FieldKind::body, &Interface::mass_per_length_kg_m2},
    {"tangential_mass_ratio", "1", FieldKind::body, &Interface::tangential_mass_ratio, 1},
    {"strength_fraction", "1", FieldKind::load, &Interface::strength_fraction, 1},
    {"v_x", "m/s", FieldKind::memory, &Interface::v_x_m_per_s},
    {"v_y", "m/s", FieldKind::memory, &Interface::v_y_m_per_s},
    {"u_y", "m", FieldKind::trial, &Interface::u_y_m},
    {"slip_rate", "m/s", FieldKind::memory, &Interface::slip_rate_m_per_s},
    {"t", "Pa", FieldKind::result, &Interface::t_Pa},
    {"p", "Pa", FieldKind::result, &Interface::p_Pa},
    {"onset_ratio", "1", FieldKind::trial, &Interface::onset_ratio},
    {"strength", "Pa", FieldKind::trial, &Interface::strength_Pa},
    {"slipping", "1", FieldKind::memory, &Interface::slipping},
    {"slip", "m", FieldKind::memory, &Interface::slip_m},
    {"relaxed", "Pa", FieldKind::memory, &Interface::relaxed_Pa},
    {"target", "Pa", FieldKind::memory, &Interface::target_Pa},
    {"acceleration", "m/s2", FieldKind::memory, &Interface::acceleration_m_per_s2},
    {"locked", "1", FieldKind::memory, &Interface::locked},
}};

/// Calls f(kind, values) for each array, those of the friction law last.
template <class State, class F>
void for_each_field(State& state, F&& f) {
  for (const auto& field : interface_fields)
    std::visit([&](auto array) { f(field.kind, state.*array); }, field.array);
  for (auto& values : state.law_states) f(FieldKind::memory, values);
}

/// Begins the memory of friction in a state of given p: no slip yet, strength mu(0) p, relaxed strength or
/// pressure in equilibrium with it, nodes under pressure in contact. `strength_fraction` is taken as it is: a
/// patch that is weakened after this call loses its strength at the rate of the regularisation.
void start_contact(const ContactModel& model, Interface& state);

/// States with which nodes begin that have t and p, of a law that has some. [nodes]
void set_initial_states(const ContactModel& model, std::span<const double> t_Pa, std::span<const double> p_Pa,
                        LawStates& states);

/// Contact and friction update for lumped mass. Reads the trial motion and the memory, writes all results and
/// the memory of `state`.
/// @return whether a node began or ceased to slip.
bool update_contact(const ContactModel& model, double dt_s, Interface& state);

}  // namespace slipfront::interface
