// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "record/column.hpp"

namespace slipfront::record {

/// Energies of the plate, and the work done on it since the start; J per unit thickness.
///
/// Each term is computed by itself from the discrete scheme: with v' = (v- + v+)/2 a node's mean velocity
/// over a (sub-)step's kick, a force f does the work dt f v'; the kinetic energy is that of the last half
/// step, the strain energy 1/2 u K u' with the displacements on either side of it. The sum of the changes is
/// then zero but for rounding.
struct Energies {
  double time_s = 0;
  double kinetic = 0, strain = 0;
  double machine = 0;  ///< in its springs, and of constant forces what they can still do; since the start
  double far_edge_work = 0;
  double trigger_work = 0;
  double prestress_work = 0;
  double friction_work = 0;  ///< negative where it dissipates
  /// Predictor-corrector contact also shifts landing nodes onto the plane, against the plate's forces.
  double contact_work = 0;
  double damping_work = 0;
  double boundary_work = 0;
  double coupling_work = 0;  ///< bounded where nothing dissipates

  template <class Archive>
  void serialize(Archive& archive);
  bool operator==(const Energies&) const = default;
  double stored() const;
  double work() const;
};

enum class EnergyKind { stored, work };

/// A term of the balance: its change is a change of what is stored, or work done.
struct EnergyTerm : Column<Energies, double> {
  EnergyKind kind;
};

inline constexpr Column<Energies, double> energy_time = {"time_s", "s", "time since the start of the event",
                                                         &Energies::time_s};
/// All terms, in the order of the files.
inline constexpr std::array<EnergyTerm, 11> energy_terms = {{
    {{"strain_J_per_m", "J/m", "strain energy", &Energies::strain}, EnergyKind::stored},
    {{"kinetic_J_per_m", "J/m", "kinetic energy", &Energies::kinetic}, EnergyKind::stored},
    {{"machine_J_per_m", "J/m",
      "energy in the springs of the loading machine, less the work of constant forces", &Energies::machine},
     EnergyKind::stored},
    {{"top_work_J_per_m", "J/m", "work of the moving top edge or machine", &Energies::far_edge_work},
     EnergyKind::work},
    {{"trigger_work_J_per_m", "J/m", "work of the trigger's forces", &Energies::trigger_work},
     EnergyKind::work},
    {{"prestress_work_J_per_m", "J/m", "work of the prescribed tractions", &Energies::prestress_work},
     EnergyKind::work},
    {{"friction_work_J_per_m", "J/m", "work of the tangential traction", &Energies::friction_work},
     EnergyKind::work},
    {{"contact_work_J_per_m", "J/m", "work of the pressure: kinetic energy lost where a gap closes",
      &Energies::contact_work},
     EnergyKind::work},
    {{"damping_work_J_per_m", "J/m", "work of the stiffness damping", &Energies::damping_work},
     EnergyKind::work},
    {{"boundary_work_J_per_m", "J/m", "work of the absorbing edges' dashpots", &Energies::boundary_work},
     EnergyKind::work},
    {{"coupling_work_J_per_m", "J/m",
      "work of the coarse cells' force on nodes that move in sub-steps, beyond what these cells store",
      &Energies::coupling_work},
     EnergyKind::work},
}};
/// The column behind them: what they leave open, see imbalance_J_per_m.
inline constexpr const char* imbalance_name = "imbalance_J_per_m";

template <class Archive>
void Energies::serialize(Archive& archive) {
  archive(time_s);
  for (const auto& term : energy_terms) archive(this->*term.member);
}

inline double sum_of(EnergyKind kind, const Energies& energies) {
  double sum = 0;
  for (const auto& term : energy_terms)
    if (term.kind == kind) sum += energies.*term.member;
  return sum;
}

inline double Energies::stored() const {
  return sum_of(EnergyKind::stored, *this);
}

inline double Energies::work() const {
  return sum_of(EnergyKind::work, *this);
}

/// Adds all terms of `more` to those of `sum`, which keeps its time.
inline void add_terms(Energies& sum, const Energies& more) {
  for (const auto& term : energy_terms) sum.*term.member += more.*term.member;
}

/// What the terms leave open: the change of stored energy since the start less the work done.
inline double imbalance_J_per_m(const Energies& now, const Energies& start) {
  return now.stored() - start.stored() - now.work();
}

}  // namespace slipfront::record
