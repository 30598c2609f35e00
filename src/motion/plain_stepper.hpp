// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/coupling.hpp"
#include "motion/probes.hpp"
#include "motion/settings.hpp"
#include "motion/step.hpp"
#include "motion/step_plan.hpp"
#include "motion/time_stepper.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// The scheme of step.hpp as it is written: cell by cell, on one thread, some hundred times slower than
/// Stepper, which computes the same. For experiments with the scheme, and to test Stepper against.
class PlainStepper : public TimeStepper {
 public:
  /// @param sources  one whole body or two, the one above first
  /// @throws UserError where the interface rows do not fit into the mesh.
  PlainStepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
               const TimeStepping& time);
  PlainStepper(const PlainStepper&) = delete;
  PlainStepper& operator=(const PlainStepper&) = delete;

  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads = {}) override;

  double stable_step_s() const override { return plan_.stable_step_s; }
  double step_s() const override { return plan_.step_s; }
  double lowest_step_s() const override { return plan_.lowest_step_s; }
  double substep_s() const override { return plan_.substep_s(); }
  double node_updates_per_step() const override;
  std::int64_t n_nodes() const override;
  std::int64_t step() const override { return step_; }

  void set_probes(std::vector<Probe> probes) override { probes_ = std::move(probes); }
  const std::vector<Probe>& probes() const override { return probes_; }
  std::vector<double> probed_u_m() const override;
  std::vector<double> probed_v_m_per_s() const override;

  std::int64_t advance(SlipObserver& observer, std::int64_t max_steps) override;

  std::span<const PlainBody> bodies() const { return bodies_; }
  const interface::Interface& interface_state() const { return coupling_.state(); }
  record::Energies energies() override;
  record::Breakdown breakdown() const override { return coupling_.breakdown(); }
  record::History interface_row() const override { return coupling_.interface_row(time_s()); }
  double kinetic_energy_J_per_m() const override;
  double mass_kg_per_m() const override;
  double energy_of_tractions_J_per_m() const override;

  int n_snapshot_chunks() const override { return 1; }
  std::size_t snapshot_chunk_bytes() const override;
  std::vector<double> snapshot_chunk(int k) const override;

  void keep(const std::function<void(const StateByNode& chunk)>& take) override {
    keep_in_chunks(state(), step_, n_nodes(), take);
  }
  void restore(const Loads& loads, const std::function<StateByNode()>& next) override {
    coupling_.set_loads(loads);
    step_ = restore_chunks(state(), next);
  }

 private:
  StateView state();

  StepPlan plan_;
  std::vector<PlainBody> bodies_;
  Coupling coupling_;
  std::vector<Probe> probes_;
  std::int64_t step_ = 0;
};

}  // namespace slipfront::motion
