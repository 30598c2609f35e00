// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "base/state.hpp"
#include "interface/friction.hpp"
#include "motion/quasi_dynamic.hpp"
#include "record/record.hpp"
#include "run/sample.hpp"

namespace slipfront::run {

/// Finds where a quantity turns: where it has come back from an extreme by some amount.
class TurnFinder {
 public:
  /// Follows a quantity that rises at first.
  TurnFinder(double start, double amount) : extreme_(start), amount_(amount) {}

  /// @return whether it has turned since the last value
  bool see(double value);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(extreme_, amount_, direction_);
  }

 private:
  double extreme_, amount_, direction_ = 1;
};

/// What is known of slow slip under way: which of its steps get a row, and whether it is steady.
class CreepRows {
 public:
  /// @param slow         started
  /// @param tributary_m  [interface nodes]
  CreepRows(const motion::QuasiDynamicSlip& slow, const std::vector<double>& tributary_m);

  /// Rows of the interface so far.
  std::size_t n_rows() const { return n_rows_; }
  /// After a step: whether the interface gets a row, by the number of steps, and when there are many rows
  /// where rates or states have changed, too.
  bool is_row_due(const motion::QuasiDynamicSlip& slow) const;
  /// Takes a state as the last row's. @return false where it is already
  bool takes_row(const motion::QuasiDynamicState& state);
  /// After a step: whether the loading gets a row, where the fastest slip rate has doubled or halved and
  /// where F_S/F_N turns.
  bool is_loading_row_due(const motion::QuasiDynamicState& state, const std::vector<double>& tributary_m);
  /// After a step: whether slip is steady: while all nodes that stick by friction slip by many d_c, their
  /// states stay as they are.
  bool is_steady(const motion::QuasiDynamicSlip& slow);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(turns_, loading_rate_m_per_s_, last_row_s_, n_rows_, row_V_m_per_s_, row_states_, steady_u_x_m_,
            steady_states_);
  }

 private:
  TurnFinder turns_;                 ///< of F_S/F_N
  double loading_rate_m_per_s_ = 0;  ///< fastest slip rate of the last row of the loading
  double last_row_s_ = 0;            ///< of the interface
  std::size_t n_rows_ = 0;
  std::vector<double> row_V_m_per_s_;  ///< of that row
  interface::LawStates row_states_;
  std::vector<double> steady_u_x_m_;  ///< when the states changed last
  interface::LawStates steady_states_;
};

/// The phase in which the interface slips slowly, under a law that never sticks, by quasi-dynamic slip. It
/// ends in the state in which the next event begins: where a node slips at
/// sequence.inertia_slip_rate_m_per_s.
class Creep {
 public:
  /// @param sample  has to stay where it is; its rest state becomes that after normal loading
  explicit Creep(Sample& sample);

  /// Takes rows of slow slip, their time since normal loading.
  using Rows = std::function<void(const record::History& row)>;

  /// Goes on to the next event; the monitor is asked after each step.
  /// @return false where that is beyond sequence.end_s, to which the sample is loaded then
  /// @throws UserError where no event comes; Interrupted
  bool slip_to_next(const Rows& rows);

  bool is_under_way() const { return rows_.has_value(); }
  /// Rows so far of slow slip under way.
  std::size_t n_rows() const { return rows_->n_rows(); }
  /// Slow slip under way.
  void serialize(StateArchive& archive);

 private:
  void begin();
  /// Sets the edge's speed to that which reaches the path at the end of the part that begins.
  /// @param shear_m  beyond rest.moved_m
  void begin_part(double time_s, double shear_m);
  /// @param u_x_per_shear  see statics::Statics::slid_to
  statics::Equilibrium slid_to(std::vector<double> u_x_per_shear) const;
  /// The row of the loading after another one from which slow slip has begun.
  record::LoadingRow loading_row(record::LoadingPhase phase, const record::LoadingRow& from) const;

  Sample& sample_;
  motion::QuasiDynamicSlip slow_;
  std::optional<CreepRows> rows_;  ///< under way
  double part_end_s_ = 0;          ///< of the part of the path under way
};

}  // namespace slipfront::run
