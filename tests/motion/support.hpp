// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "interface/friction/velocity_weakening.hpp"
#include "motion/event.hpp"
#include "motion/stepper.hpp"
#include "motion/trigger_zone.hpp"
#include "support/plate.hpp"

namespace slipfront::motion::support {

using namespace slipfront::test;

inline constexpr double mu_s = 1.3;  ///< of the laws below

inline record::StaticState uniform_tractions(const mesh::Mesh& mesh, double t_Pa, double p_Pa) {
  record::StaticState tractions;
  for (const auto node : mesh.interface_nodes) tractions.x_m.push_back(mesh.x_m[node]);
  tractions.t_s_Pa.assign(tractions.x_m.size(), t_Pa);
  tractions.p_s_Pa.assign(tractions.x_m.size(), p_Pa);
  return tractions;
}

/// A state of motion that is no equilibrium: displacement u, velocity v at a top speed of 1, no contact.
inline statics::Equilibrium in_flight(const mesh::Mesh& mesh, solid::Field u, solid::Field v) {
  statics::Equilibrium e;
  e.u_m = std::move(u);
  e.u_per_shear = std::move(v);
  e.contact.assign(mesh.interface_nodes.size(), statics::Contact::open);
  e.tractions = uniform_tractions(mesh, 0, 0);
  return e;
}

/// The same with random velocities and displacements around a lift; the loaded edge rests.
inline statics::Equilibrium random_flight(const mesh::Mesh& mesh, std::uint64_t seed, double amplitude_m,
                                          double speed_m_per_s, double lift_m) {
  Random random(seed);
  solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    u.x[n] = amplitude_m * random();
    u.y[n] = amplitude_m * random();
    v.x[n] = speed_m_per_s * random();
    v.y[n] = speed_m_per_s * random();
  }
  for (const auto n : mesh.far_edge_nodes) u.x[n] = u.y[n] = v.x[n] = v.y[n] = 0;
  for (double& y : u.y) y += lift_m;
  return in_flight(mesh, u, v);
}

/// Plain scheme: the interface layer in step with the rest.
inline TimeStepping one_substep(double step_factor = 0.9) {
  return {.step_factor = step_factor, .interface_rows = 1, .interface_substeps = 1};
}

inline constexpr std::array algorithms = {interface::ContactAlgorithm::direct,
                                          interface::ContactAlgorithm::predictor_corrector};

inline interface::ContactModel with_algorithm(interface::ContactModel model,
                                              interface::ContactAlgorithm algorithm) {
  model.algorithm = algorithm;
  return model;
}

inline const interface::ContactModel paper_law {
  interface::VelocityWeakening {
    .mu_s = 1.3, .mu_k = 0.6, .alpha_m2_per_s2 = 0.1
  }
};

/// Weakens with the slip rate, but so slowly that rounding is not amplified: the paper's law lets differences
/// between two runs grow tenfold a step.
inline const interface::ContactModel gentle_law {
  interface::VelocityWeakening {
    .mu_s = 1.3, .mu_k = 1.0, .alpha_m2_per_s2 = 100
  }
};

/// Of tiny plates.
inline const statics::Loading tilted{.tilt_left_m = 0.05e-3, .tilt_right_m = 0.02e-3, .edge_margin_m = 2e-3};

/// A trigger at the left edge of the state.
inline Loads left_trigger(const statics::Equilibrium& state, const mesh::Mesh& mesh, double mu_at_rest) {
  const interface::Trigger trigger { .zone_m = 3e-3, .ramp_s = 1e-6 };
  return {.trigger_force_N_per_m = trigger_forces(state, mesh::tributary_lengths_m(mesh),
                                                  interface::EventKind::left, trigger, mu_at_rest),
          .trigger = trigger};
}

inline bool touches(const Stepper& stepper) {
  return std::ranges::any_of(stepper.interface_state().p_Pa, [](double p) { return p > 0; });
}

/// The balance of energies since the start, step by step.
struct Balance {
  record::Energies start, last = start;
  double worst_J = 0;    ///< largest imbalance
  double largest_J = 0;  ///< largest single term

  void look(const record::Energies& now) {
    last = now;
    worst_J = std::max(worst_J, std::abs(record::imbalance_J_per_m(now, start)));
    for (const double term : {now.kinetic, now.strain, now.far_edge_work, now.trigger_work,
                              now.prestress_work, now.friction_work})
      largest_J = std::max(largest_J, std::abs(term));
  }
};

/// Records rows of the history and displacements of the probes, too.
class RowRecorder final : public Recorder {
 public:
  using Recorder::Recorder;
  record::History* row() override { return to_row(); }
  double* displacements(std::int64_t step) override {
    return probes != nullptr ? probes->room_for(step) : nullptr;
  }
  std::int64_t guaranteed_steps() override { return n_guaranteed; }

  std::function<record::History*()> to_row = [] { return nullptr; };
  ProbeRecorder* probes = nullptr;
  std::int64_t n_guaranteed = 1;
};

/// A stepper on its way from a state, whose energies are looked at after each step where that is asked for.
struct UnderWay {
  Stepper stepper;
  Recorder recorder;

  UnderWay(Stepper of, const statics::Equilibrium& from, double top_speed_m_per_s, Loads loads = {})
      : stepper(std::move(of)), recorder(from, mu_s, 0) {
    stepper.start(from, top_speed_m_per_s, std::move(loads));
  }
  void advance(int n_steps) {
    for (int step = 0; step < n_steps; ++step) stepper.advance(recorder);
  }
  void advance_to(double time_s) {
    while (stepper.time_s() < time_s) stepper.advance(recorder);
  }
  Balance balance_of(int n_steps) {
    Balance balance{stepper.energies()};
    for (int step = 0; step < n_steps; ++step) {
      stepper.advance(recorder);
      balance.look(stepper.energies());
    }
    return balance;
  }
  std::size_t n_onsets() { return recorder.record_until(stepper.time_s()).onsets.size(); }
};

}  // namespace slipfront::motion::support
