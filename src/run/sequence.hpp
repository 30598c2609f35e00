// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "advice/prediction.hpp"
#include "record/sequence.hpp"
#include "run/creep.hpp"
#include "run/run.hpp"
#include "run/sample.hpp"

namespace slipfront::run {

/// A sample that is loaded from one spontaneous event to the next. Under a law without a state by static
/// equilibria: where an event has left its interface, it sticks and has its static strength again; the
/// tractions that it carries there are those of the equilibrium with the slip so far. Under a law with a
/// state by quasi-dynamic slip. The statics are factorised once.
class Sequence {
 public:
  /// @param monitor  asked between linear solutions
  /// @throws UserError, Interrupted as make_initial_state
  Sequence(const Problem& problem, const motion::Monitor& monitor,
           const Processes& processes = one_process());
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// Why no event follows, in words; empty where one does.
  std::string end() const;
  /// Loads the sample to the state in which the next event begins: the first one where t/p inside passes
  /// mu_s, by loading.critical_margin, or where the last event has left it if it does so there.
  /// @return null where that is beyond sequence.end_s, to which the sample is loaded then
  /// @throws UserError where no shear does it
  /// Under a law with a state: the first one in which a node slips at sequence.inertia_slip_rate_m_per_s.
  /// @param rows  takes rows of slow slip, their time since normal loading
  const InitialState* next(const Creep::Rows& rows = [](const record::History&) {});
  /// Finds the equilibrium behind the event that has begun so, and has come to rest.
  void record_event(const Result& result);

  const std::vector<record::SequenceEvent>& events() const { return sample_.events; }
  const std::vector<record::LoadingRow>& loading() const { return sample_.loading; }

  /// Whether slow slip is under way; the monitor is asked after each of its steps.
  bool is_creeping() const { return creep_ && creep_->is_under_way(); }
  /// Rows of it so far.
  std::size_t n_slow_rows() const { return creep_->n_rows(); }
  /// Places of the interface nodes.
  const std::vector<double>& x_m() const { return sample_.at_rest.tractions.x_m; }
  /// Whether an event has begun that has not been recorded.
  bool is_in_event() const { return !u_begins_x_m_.empty(); }
  /// After serialize in an event: the state in which it has begun, whose displacements are not needed.
  void resume_event(const InitialState& initial);
  /// Where an event has begun, in slow slip, or where the last event has ended: what followed it without one
  /// is left out.
  void serialize(StateArchive& archive);

 private:
  /// Predicts the ends of an event, by the state in which it begins.
  void predict(record::SequenceEvent& event);

  Sample sample_;
  std::optional<advice::FrontPredictor> predictor_;  ///< of laws with a fracture energy
  std::optional<Creep> creep_;                       ///< of a law that never sticks
  /// Where the event under way has begun. [interface nodes] relative to a base
  std::vector<double> u_begins_x_m_;
};

}  // namespace slipfront::run
