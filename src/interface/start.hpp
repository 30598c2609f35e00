// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "interface/nucleation.hpp"
#include "interface/trigger.hpp"

namespace slipfront::interface {

/// How an event begins. What the kind does not name does not count.
struct Start {
  EventKind kind = EventKind::spontaneous;
  Trigger trigger;
  Nucleation nucleation;

  /// Whether a tangential traction is added next to an edge of contact.
  bool pushes_edge() const {
    return is_at_edge(kind) && (trigger.form == TriggerForm::added || trigger.form == TriggerForm::raised);
  }
  /// Whether pressure is taken away next to an edge of contact.
  bool unloads_edge() const { return is_at_edge(kind) && trigger.form == TriggerForm::unloaded; }
  /// Whether it is over a patch.
  bool unloads_patch() const {
    return kind == EventKind::nucleation && nucleation.form == NucleationForm::unloaded;
  }
  /// Whether a traction is added over a patch.
  bool overstresses() const {
    return kind == EventKind::nucleation && nucleation.form == NucleationForm::overstress;
  }
  /// Whether a patch is weakened.
  bool weakens_patch() const { return kind == EventKind::nucleation && !overstresses() && !unloads_patch(); }
  /// Whether it is weakened over a time.
  bool is_forced() const { return weakens_patch() && nucleation.form == NucleationForm::forced; }
  /// Whether a force begins it, with the trigger's ramp and duration.
  bool is_by_force() const { return pushes_edge() || overstresses() || unloads_edge() || unloads_patch(); }
  /// The key in the case file of trigger.amount, where that is pushed.
  const char* trigger_key() const {
    return trigger.form == TriggerForm::raised ? "event.trigger_over_strength" : "event.trigger_over_missing";
  }
  /// nucleation.form, of a patch that is weakened.
  const char* weakening_form() const { return is_forced() ? "forced" : "weakened"; }
};

}  // namespace slipfront::interface
