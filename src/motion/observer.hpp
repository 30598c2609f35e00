// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/state.hpp"
#include "motion/every.hpp"
#include "motion/step_observer.hpp"
#include "motion/time_stepper.hpp"
#include "record/energies.hpp"
#include "record/record.hpp"

namespace slipfront::motion {

/// Why a run of steps ended; observer: one of another kind has ended it.
enum class EventEnd { end_time, quiet, interrupted, blow_up, observer };

struct End {
  EventEnd why = EventEnd::end_time;
  std::string reason = {};  ///< of a blow-up or an observer, in words
};

/// The motion between two steps, all of it in reach.
class Pause {
 public:
  /// @param known  its energies, if they are
  explicit Pause(TimeStepper& stepper, std::optional<record::Energies> known = {})
      : stepper_(stepper), energies_(known) {}

  TimeStepper& stepper() const { return stepper_; }
  Now now() const { return stepper_.now(); }
  /// Computed once, when first asked for.
  const record::Energies& energies() {
    if (!energies_) energies_ = stepper_.energies();
    return *energies_;
  }
  /// Those that an observer has asked for already.
  const std::optional<record::Energies>& known_energies() const { return energies_; }

 private:
  TimeStepper& stepper_;
  std::optional<record::Energies> energies_;
};

/// Observes a run of steps: what is recorded of it, and what ends it. ObservedRun calls the observers of its
/// list in their order.
///
/// Several steps are taken in one sweep through memory. Those functions that are called meanwhile see the
/// steps in their order, perhaps in another thread, and may look only at what they are given; of several
/// ranks each shows the same of the whole interface, some steps at once when they have been taken. Whoever
/// needs more asks for a pause. What an observer throws ends the run: from the first kind for good, in a
/// pause the motion is whole.
class Observer {
 public:
  virtual ~Observer() = default;

  // While steps are taken.

  /// A contact update.
  virtual void at_update(const SlipUpdate& /*seen*/) {}
  /// Whether it wants the interface's state of that time, of which a step begins; always the same answer.
  virtual bool wants_row(const Now& /*now*/) const { return false; }
  /// One row of the history, with its places x_m.
  virtual void take_row(const record::History& /*row*/) {}
  /// Where to put the displacements of the nodes of the stepper's probes at a step, see displacement_values;
  /// null for nowhere. Of all observers one may want them. Asked for in each part of the step, from the
  /// thread that takes it.
  virtual double* displacements(std::int64_t /*step*/) { return nullptr; }
  /// After the interface's part of a step. @return whether another one may follow before the next pause
  virtual bool after_step(const Now& /*now*/, const SlipRates& /*rates*/) { return true; }
  /// Steps, at least one, after which after_step may first refuse a motion that is physical.
  virtual std::int64_t guaranteed_steps(const Now& /*now*/) const { return many_steps; }

  // Between steps.

  /// Most steps, at least one, before the next pause.
  virtual std::int64_t steps_to_pause(const Now& /*now*/) const { return many_steps; }
  /// Before at most n steps are taken.
  virtual void expect(const Now& /*now*/, std::int64_t /*n*/) {}
  /// Before the first step, after each sweep, and where a run goes on.
  virtual void at_pause(Pause& /*pause*/) {}
  /// Whether, and why, the run ends now. Asked after all observers have had their pause, and none before in
  /// the list has ended the run.
  virtual std::optional<End> end(Pause& /*pause*/) { return {}; }
  /// When the run has ended.
  virtual void at_end(Pause& /*pause*/) {}

  // In checkpoints, which are kept in a pause.

  /// Under which its state is kept; null for one without state.
  virtual const char* name() const { return nullptr; }
  /// All that changes during a run.
  virtual void archive(StateArchive& /*archive*/) {}
  /// After a restore, with the stepper's motion back in place. @throws StateError where no run comes to that
  virtual void restored(Pause& /*pause*/) {}

 protected:
  Observer() = default;
  Observer(const Observer&) = default;
  Observer& operator=(const Observer&) = default;
};

using Observers = std::vector<std::unique_ptr<Observer>>;

}  // namespace slipfront::motion
