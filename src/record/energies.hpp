// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>

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
  double top_work = 0;  ///< of the moving edge
  double trigger_work = 0;
  double prestress_work = 0;  ///< of the uniform tractions on the interface nodes
  double friction_work = 0;   ///< of the tangential traction; negative where it dissipates
  /// Of the pressure: kinetic energy lost where a gap closes, negative. Predictor-corrector contact also
  /// shifts landing nodes onto the plane, against the plate's forces.
  double contact_work = 0;
  double damping_work = 0;   ///< of the stiffness damping
  double boundary_work = 0;  ///< of the absorbing boundaries' dashpots, negative
  /// Of the coarse cells' force on nodes that move in sub-steps, beyond what these cells store. Bounded where
  /// nothing dissipates.
  double coupling_work = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time_s, kinetic, strain, top_work, trigger_work, prestress_work, friction_work, contact_work,
            damping_work, boundary_work, coupling_work);
  }

  double stored() const { return kinetic + strain; }
  double work() const {
    return top_work + trigger_work + prestress_work + friction_work + contact_work + damping_work +
           boundary_work + coupling_work;
  }
};

/// Adds the works of `step` to those of `sum`.
inline void add_works(Energies& sum, const Energies& step) {
  for (const auto work :
       {&Energies::top_work, &Energies::trigger_work, &Energies::prestress_work, &Energies::friction_work,
        &Energies::contact_work, &Energies::damping_work, &Energies::boundary_work, &Energies::coupling_work})
    sum.*work += step.*work;
}

/// What the terms leave open: the change of stored energy since the start less the work done.
inline double imbalance_J_per_m(const Energies& now, const Energies& start) {
  return now.stored() - start.stored() - now.work();
}

}  // namespace slipfront::record
