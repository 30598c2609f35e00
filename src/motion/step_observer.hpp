// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "interface/interface.hpp"
#include "motion/slip_finder.hpp"
#include "record/record.hpp"

namespace slipfront::motion {

/// How fast the nodes of an interface slip.
struct SlipRates {
  bool finite = true;
  double fastest_m_per_s = 0;
  double fastest_in_contact_m_per_s = 0;
  double fastest_slipping_m_per_s = 0;  ///< of nodes in contact that count as slipping

  template <class Archive>
  void serialize(Archive& archive) {
    archive(finite, fastest_m_per_s, fastest_in_contact_m_per_s, fastest_slipping_m_per_s);
  }
  /// Those of other nodes.
  void add(const SlipRates& more) {
    finite &= more.finite;
    fastest_m_per_s = std::max(fastest_m_per_s, more.fastest_m_per_s);
    fastest_in_contact_m_per_s = std::max(fastest_in_contact_m_per_s, more.fastest_in_contact_m_per_s);
    fastest_slipping_m_per_s = std::max(fastest_slipping_m_per_s, more.fastest_slipping_m_per_s);
  }
};

/// Sees the steps that a stepper takes. Its functions are called in the order of steps, not always by the
/// same thread, and may read only the stepper's time and step.
class StepObserver {
 public:
  virtual ~StepObserver() = default;

  /// After a contact update whose tractions belong to time_s. `changed` is update_contact's answer.
  virtual void observe(double time_s, const interface::Interface& state, bool changed) = 0;
  /// Where to append the state of the interface at the beginning of the step that follows; null for nowhere.
  virtual record::History* row() { return nullptr; }
  /// Where to put the displacements of the nodes of the stepper's probes at a step, see displacement_values;
  /// null for nowhere. Asked for in each part of the step, from the thread that takes it.
  virtual double* displacements(std::int64_t /*step*/) { return nullptr; }
  /// After the interface's part of a step. @return whether another one may follow
  virtual bool after_step(const SlipRates& /*rates*/) { return true; }
  /// After a step: whether no more are wanted. Steps that are guaranteed may follow.
  virtual bool is_interrupted() { return false; }
  /// Steps, at least one, after which after_step may first refuse a motion that is physical.
  virtual std::int64_t guaranteed_steps() { return 1; }

 protected:
  StepObserver() = default;
  StepObserver(const StepObserver&) = default;
  StepObserver(StepObserver&&) = default;
  StepObserver& operator=(const StepObserver&) = default;
  StepObserver& operator=(StepObserver&&) = default;
};

/// Sees the changes of slip in every contact update.
class SlipObserver : public StepObserver {
 public:
  explicit SlipObserver(SlipFinder finder) : finder_(std::move(finder)) {}
  void observe(double time_s, const interface::Interface& state, bool changed) final {
    finder_.find(time_s, state, changed, seen_);
    at_update(seen_);
  }
  /// Updates come in the order of time.
  virtual void at_update(const SlipUpdate& seen) = 0;

  SlipFinder& finder() { return finder_; }
  /// What the last update has shown, where it was found here.
  const SlipUpdate& seen() const { return seen_; }

 private:
  SlipFinder finder_;
  SlipUpdate seen_;
};

}  // namespace slipfront::motion
