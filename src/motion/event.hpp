// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "motion/blow_up_monitor.hpp"
#include "motion/recorder.hpp"
#include "motion/rest_criterion.hpp"
#include "motion/stepper.hpp"
#include "motion/time_stepper.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Asked once in a while during long work with the steps done and their total, which are 0 before the first
/// step; returns false to interrupt it.
using Monitor = std::function<bool(std::int64_t step, std::int64_t total)>;

/// What to keep of an event besides its onsets.
struct Sampling {
  double history_interval_s = 0.5e-6;
  double energy_interval_s = 20e-6;
  std::vector<double> snapshot_times_s;  ///< ascending
  double probe_interval_s = 0.5e-6;      ///< of the stepper's probes; one step where that is longer
};

/// Observes an event under way.
class EventObserver {
 public:
  virtual ~EventObserver() = default;
  /// One row of the history; x_m is empty.
  virtual void sample(const record::History& row) = 0;
  /// It is time for a snapshot.
  virtual void snapshot(TimeStepper& stepper) = 0;
  /// Rows of what the stepper's probes record; not asked without probes.
  virtual void probe(const record::ProbeRecord& rows) = 0;
};

/// Why an event ended.
enum class EventEnd { end_time, quiet, interrupted, blow_up };

/// A slip event as it was computed.
struct Event {
  EventEnd end = EventEnd::end_time;
  std::string blow_up;  ///< which step, and why
  std::int64_t steps = 0;
  double time_s = 0;
  double quiet_slip_rate_m_per_s = 0;  ///< slower slip that does not grow counts as none, see RestCriterion
  record::SlipRecord record;
  record::History history;                 ///< without an observer
  std::vector<Snapshot> snapshots;         ///< without an observer
  record::ProbeRecord probes;              ///< without an observer
  std::vector<record::Energies> energies;  ///< at the start, at the given interval, and at the end

  /// Without what an observer would take.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(end, blow_up, steps, time_s, quiet_slip_rate_m_per_s, record, energies);
  }
};

/// Interface nodes in contact that lie within zone_m of the outermost one of the event's edge.
std::vector<std::size_t> trigger_zone(const statics::Equilibrium& state, interface::EventKind kind,
                                      double zone_m);

/// Sign of the tangential force on a zone before the event; 1 where that is 0.
double load_direction(const statics::Equilibrium& state, std::span<const double> tributary_m,
                      std::span<const std::size_t> zone);

/// Forces on the interface nodes that the trigger adds, see TriggerForm, N per unit thickness. [interface
/// nodes]
std::vector<double> trigger_forces(const statics::Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger,
                                   const PerNode& mu_s);

/// Halo of the slip record that t_d, p_d at a distance l_star_m ahead of the tip need.
int halo_for(const mesh::Mesh& mesh, double l_star_m);

/// An event under way: steps a started stepper until the end time, or until nothing has moved for
/// time.quiet_s (see RestCriterion) after the trigger's loads last changed. The motion is checked: in every
/// step numbers finite and slip rates below c_L, with each of the energies and at least every 100 steps
/// energy not above what there was at the start plus what the loaded edge and the trigger have added, by more
/// than 1 %.
class EventRun {
 public:
  /// @param state  tractions and contact before the event; its displacements are not needed
  EventRun(TimeStepper& stepper, const statics::Equilibrium& state, const PerNode& mu_s, const Waves& waves,
           const interface::Trigger& trigger, const TimeStepping& time, const Sampling& sampling, int halo);

  /// To the end, or until the monitor interrupts it, which it may do for good.
  /// @param observer  takes samples and snapshots; without one the event keeps them all
  Event run(const Monitor& monitor, EventObserver* observer = nullptr);

  std::int64_t n_steps() const { return n_steps_; }  ///< to the end time
  const std::vector<record::Energies>& energies() const { return event_.energies; }
  /// Of what has happened so far.
  record::SlipRecord record() { return recorder_.record_until(stepper_.time_s()); }

  /// All that changes while the monitor is asked, but for the stepper and what an observer would take.
  template <class Archive>
  void serialize(Archive& archive) {
    auto start = blow_up_monitor_->start();
    auto checked_step = blow_up_monitor_->checked_step();
    archive(recorder_, rest_criterion_, start, checked_step, event_.energies, n_samples_, n_energies_,
            next_snapshot_);
    if (probes_) archive(*probes_);
    if constexpr (Archive::is_loading::value) {
      blow_up_monitor_.emplace(stepper_, waves_.c_L_m_per_s, start, checked_step);
      require_possible();
    }
  }

 private:
  /// Refuses what no event comes to at the stepper's time.
  void require_possible();
  void take_snapshots(EventObserver* observer);
  void take_probe_rows(EventObserver* observer);
  /// When something has last moved, as far as the interface tells.
  double moved_s() const;
  /// As far as the interface tells.
  bool is_at_rest() const;
  /// As far as the energies that are known tell as well; where they are not, they are computed.
  bool is_at_rest_everywhere();
  StepCallbacks callbacks(EventObserver* observer, record::History& row);
  std::int64_t steps_to_next_check() const;
  double energy_time_s() const;
  /// Checks the motion. @return whether the event continues
  bool check_motion();

  TimeStepper& stepper_;
  Waves waves_;
  TimeStepping time_;
  std::vector<double> snapshot_times_s_;
  double sample_interval_s_, energy_interval_s_;
  std::int64_t n_steps_ = 0;
  Recorder recorder_;
  RestCriterion rest_criterion_;
  std::optional<BlowUpMonitor> blow_up_monitor_;  ///< always there
  std::optional<ProbeRecorder> probes_;
  Event event_;
  std::int64_t n_samples_ = 0, n_energies_ = 1;
  std::size_t next_snapshot_ = 0;
};
Event run_event(TimeStepper& stepper, const statics::Equilibrium& state, const PerNode& mu_s,
                const Waves& waves, const interface::Trigger& trigger, const TimeStepping& time,
                const Sampling& sampling, int halo, const Monitor& monitor,
                EventObserver* observer = nullptr);

/// States that the explicit ramp reaches, and what happened on the way.
struct Ramp {
  statics::Equilibrium common;       ///< at (1 - critical_margin) mu_s inside
  statics::Equilibrium spontaneous;  ///< just before mu_s is reached inside
  record::SlipRecord record;         ///< of all slip during the ramp
  std::int64_t steps = 0;
  bool interrupted = false;

  /// Beginnings of slip inside: where it came within a step before t/p was seen near mu_s.
  std::uint64_t n_onsets_inside() const;
  /// Whether t/p passed from less than (1 - critical_margin) mu_s to slip within a step.
  bool passed_margin_in_a_step() const { return common.shear_m == spontaneous.shear_m; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(common, spontaneous, record, steps, interrupted);
  }
};

/// Relative distance to mu_s at which the ramp hands over to the spontaneous event.
inline constexpr double ramp_handover = 1e-5;

/// A ramp under way: moves the loaded edge of the tilted plate at top_speed_m_per_s by explicit steps until
/// t/p inside the interface reaches mu_s.
class RampRun {
 public:
  /// @param stepper  started from `tilted` at the top's speed
  /// @param mu_s     of the interface nodes
  RampRun(Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
          const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m);

  /// @throws BlowUp, and UserError where mu_s is not reached within twice the shear `expected_shear_m`.
  Ramp run(const Monitor& monitor);

  std::int64_t expected_steps() const { return max_steps_ / 2; }

  /// All that changes while the monitor is asked, but for the stepper.
  template <class Archive>
  void serialize(Archive& archive) {
    auto start = blow_up_monitor_->start();
    auto checked_step = blow_up_monitor_->checked_step();
    archive(recorder_, start, checked_step, ramp_, has_common_, from_m_, to_m_);
    if constexpr (Archive::is_loading::value) {
      blow_up_monitor_.emplace(stepper_, c_L_m_per_s_, start, checked_step);
      require_possible();
    }
  }

 private:
  /// Refuses what no ramp comes to at the stepper's time.
  void require_possible();
  statics::Equilibrium state_now() const;
  /// Whether t/p is so large a share of mu_s anywhere inside, or a node there slips.
  bool reaches(double share) const;

  Stepper& stepper_;
  const statics::Equilibrium& tilted_;
  const statics::Loading& loading_;
  PerNode mu_s_;
  double top_speed_m_per_s_, c_L_m_per_s_, expected_shear_m_;
  std::int64_t max_steps_;
  Recorder recorder_;
  std::optional<BlowUpMonitor> blow_up_monitor_;  ///< always there
  Ramp ramp_;
  bool has_common_ = false;
  /// The contact's extent changes slowly; the peak is looked for between bounds that are renewed at times.
  double from_m_, to_m_;
};
Ramp run_ramp(Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
              const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m,
              const Monitor& monitor);

}  // namespace slipfront::motion
