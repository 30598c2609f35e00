// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Records beginnings and ends of slip while the run goes, located inside the (sub-)step.
///
/// Fronts are found from the first onset of each node, and from whether other nodes slip at these times. A
/// node's end of slip and its next onset, or a later onset and the end after it, are left out where no node
/// began to slip for the first time between the two: so the record stays bounded however often nodes slip
/// again.
class Onsets final : public Observer {
 public:
  /// @param x_m   of the interface nodes; those that slip from the start have no onset
  /// @param halo  nodes on each side whose tractions are kept at an onset
  Onsets(const std::vector<double>& x_m, int halo);

  void at_update(const SlipUpdate& seen) override;

  /// Without the last change of each node, which may yet be left out.
  const record::SlipRecord& record() const { return record_; }
  /// The whole record up to now.
  record::SlipRecord record_until(double end_time_s) const;

  const char* name() const override { return "onsets"; }
  void archive(StateArchive& archive) override;
  void restored(Pause& pause) override;

 private:
  /// Last change of a node, not in the record yet.
  struct Waiting {
    double time_s = 0;
    std::uint8_t change = 0;  ///< a Change
    template <class Archive>
    void serialize(Archive& archive) {
      archive(time_s, change);
    }
  };
  enum Change : std::uint8_t { none, onset, stop };

  /// A node's change but for its first onset: it waits, or goes together with the change that waited.
  void take_change(std::size_t node, const Waiting& change, std::span<const record::Traction> around);
  /// Adds the change of a node that waits, if there is one, to a record.
  void add_waiting(std::size_t node, record::SlipRecord& record) const;
  std::size_t n_around() const { return 2 * static_cast<std::size_t>(record_.halo) + 1; }

  record::SlipRecord record_;
  std::vector<std::uint8_t> is_first_;  ///< of the last update's changes those that are a node's first onset
  double previous_time_s_ = 0;
  double last_first_onset_s_ = -1;                ///< the latest first onset of any node
  std::vector<std::uint8_t> has_slipped_;         ///< since the start. [nodes]
  std::vector<Waiting> waiting_;                  ///< [nodes]
  std::vector<record::Traction> around_waiting_;  ///< [nodes x (2 halo + 1)]
};

/// Shows the changes of slip to a record alone, for steps that no one else observes.
class Recorder : public SlipObserver {
 public:
  /// @param before  the state at time 0, before the first (sub-)step
  /// @param mu_s    coefficient at rest in that state
  /// @param creep_m_per_s  see SlipUpdate::moves
  Recorder(const statics::Equilibrium& before, const PerNode& mu_s, int halo, double creep_m_per_s = 0)
      : SlipObserver({before, mu_s, halo, creep_m_per_s}), onsets_(before.tractions.x_m, halo) {}
  void at_update(const SlipUpdate& seen) override { onsets_.at_update(seen); }
  const record::SlipRecord& record() const { return onsets_.record(); }
  record::SlipRecord record_until(double end_time_s) const { return onsets_.record_until(end_time_s); }
  /// All that changes while a run goes.
  void archive(StateArchive& archive) {
    finder().archive(archive);
    onsets_.archive(archive);
  }

 private:
  Onsets onsets_;
};

}  // namespace slipfront::motion
