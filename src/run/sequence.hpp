// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "advice/prediction.hpp"
#include "motion/quasi_dynamic.hpp"
#include "record/sequence.hpp"
#include "run/creep.hpp"
#include "run/run.hpp"
#include "setup/initial_state.hpp"
#include "solid/operator.hpp"

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

  using SlowRows = std::function<void(const record::History& row)>;

  /// Why no event follows, in words; empty where one does.
  std::string end() const;
  /// Loads the sample to the state in which the next event begins: the first one where t/p inside passes
  /// mu_s, by loading.critical_margin, or where the last event has left it if it does so there.
  /// @return null where that is beyond sequence.end_s, to which the sample is loaded then
  /// @throws UserError where no shear does it
  /// Under a law with a state: the first one in which a node slips at sequence.inertia_slip_rate_m_per_s.
  /// @param slow_rows  takes rows of slow slip, their time since normal loading
  const InitialState* next(const SlowRows& slow_rows = [](const record::History&) {});
  /// Finds the equilibrium behind the event that has begun so, and has come to rest.
  void record_event(const Result& result);

  const std::vector<record::SequenceEvent>& events() const { return events_; }
  const std::vector<record::LoadingRow>& loading() const { return loading_; }

  /// Whether slow slip is under way; the monitor is asked after each of its steps.
  bool is_creeping() const { return creep_.has_value(); }
  /// Rows of it so far.
  std::size_t n_slow_rows() const { return creep_->n_rows(); }
  /// Places of the interface nodes.
  const std::vector<double>& x_m() const { return at_rest_.tractions.x_m; }
  /// Whether an event has begun that has not been recorded.
  bool is_in_event() const { return !u_begins_x_m_.empty(); }
  /// After serialize in an event: the state in which it has begun, whose displacements are not needed.
  void resume_event(const InitialState& initial);
  /// Where an event has begun, in slow slip, or where the last event has ended: what followed it without one
  /// is left out.
  void serialize(StateArchive& archive);

 private:
  /// Where nodes in contact stick. The plate is where its mean slip has moved it: that strains nothing, and
  /// would take digits from what does.
  struct RestState {
    double time_s = 0;  ///< since normal loading
    double moved_m = 0;
    double shear_m = 0;  ///< of the top edge beyond that
    std::vector<statics::Contact> contact;
    std::vector<double> u_x_m;  ///< [interface nodes] relative to a base, beyond that
    interface::LawStates law_states;
    std::vector<double> rests_since_s;  ///< [interface nodes] where mu_s grows at rest
  };

  void begin_slow_slip();
  /// Loads by equilibria to the next event. @return whether it begins before sequence.end_s
  bool stick_to_next();
  /// Gives nodes the mu_s that they have at a time.
  void heal_until(double time_s);
  /// The same at the first shear since normal loading, at most that of sequence.end_s, at which t/p inside
  /// reaches mu_s, which grows.
  void heal_to_critical();
  void begin_creep();
  bool slip_to_next(const SlowRows& slow_rows);
  /// @param u_x_per_shear  see statics::Statics::slid_to
  statics::Equilibrium slid_to(const motion::QuasiDynamicState& state,
                               std::vector<double> u_x_per_shear) const;
  /// The row of slow slip after another one from which it has begun.
  record::LoadingRow slow_row(record::LoadingPhase phase, const record::LoadingRow& from) const;

  /// Refuses a state in which the plate tips over or no event comes, however far it is loaded.
  /// @param shear_m  since normal loading
  void require_stands(double time_s, double shear_m, const std::vector<double>& t_Pa,
                      const std::vector<double>& p_Pa) const;
  /// Finds the equilibrium of rest_.
  void equilibrate();
  /// At which the loading brings about a shear beyond rest_.moved_m.
  double time_s(double shear_m) const { return path_.time_s(shear_m + rest_.moved_m, rest_.time_s); }
  /// Adds the row of an equilibrium after the last one.
  void load_to(record::LoadingPhase phase, const statics::Equilibrium& state);
  /// What the tractions do not tell. @param state  as found: without what the events have moved the plate
  void add_state(const statics::Equilibrium& state, record::LoadingRow& row) const;
  /// With the works so far. @param shear_m  since normal loading
  record::LoadingRow row(record::LoadingPhase phase, double time_s, double shear_m,
                         const record::StaticState& tractions) const;
  /// By the state in which it begins.
  void predict(record::SequenceEvent& event);
  void add_event(const Result& result, const record::LoadingRow& before, const record::LoadingRow& after,
                 const record::StaticState& tractions_after);

  Problem problem_;
  problem::LoadingPath path_;
  InitialState initial_;
  statics::Statics statics_;
  solid::Operator plate_;
  std::optional<solid::Operator> base_;
  std::optional<advice::FrontPredictor> predictor_;  ///< of laws with a fracture energy
  motion::Monitor monitor_;
  std::unique_ptr<motion::QuasiDynamicSlip> slow_;  ///< of a law that never sticks
  std::optional<Creep> creep_;                      ///< slow slip under way
  statics::Equilibrium at_rest_;                    ///< before the next event
  RestState rest_;                                  ///< of a law without a state empty before the first event
  std::vector<double>
      u_begins_x_m_;  ///< [interface nodes] relative to a base where the event under way has begun
  std::vector<record::LoadingRow> loading_;
  std::size_t n_rows_at_rest_ = 0;  ///< of loading_, until the last event has ended
  std::vector<record::SequenceEvent> events_;
};

}  // namespace slipfront::run
