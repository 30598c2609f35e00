// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/per_node.hpp"
#include "base/state.hpp"
#include "interface/interface.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Sees every contact update of an interface.
class UpdateObserver {
 public:
  UpdateObserver() = default;
  UpdateObserver(const UpdateObserver&) = default;
  UpdateObserver(UpdateObserver&&) = default;
  UpdateObserver& operator=(const UpdateObserver&) = default;
  UpdateObserver& operator=(UpdateObserver&&) = default;
  virtual ~UpdateObserver() = default;
  /// After a contact update whose tractions belong to time_s. `changed` is update_contact's answer.
  virtual void observe(double time_s, const interface::Interface& state, bool changed) = 0;
};

/// A node begins or ceases to slip.
struct SlipChange {
  std::int32_t node = 0;
  bool begins = false;
  double time_s = 0;  ///< of a beginning located inside the (sub-)step
  double share = 1;   ///< of the (sub-)step that has passed then
};

/// Changes of slip in one contact update.
struct SlipUpdate {
  double time_s = 0;                     ///< to which its tractions belong
  bool moves = false;                    ///< whether a node slips faster than creep
  std::vector<SlipChange> changes;       ///< nodes ascending
  std::vector<record::Traction> around;  ///< at the beginnings among them, [beginnings x (2 halo + 1)]
};

/// At an onset, from those of the updates before and after it. @param share  see SlipChange
inline record::Traction traction_between(const record::Traction& before, const record::Traction& after,
                                         double share) {
  return {before.t_Pa + share * (after.t_Pa - before.t_Pa), before.p_Pa + share * (after.p_Pa - before.p_Pa)};
}

/// Finds beginnings and ends of slip between successive contact updates.
class SlipFinder {
 public:
  /// What it knows of the last update, [nodes] each.
  struct Memory {
    double time_s = 0;
    std::vector<double> t_Pa, p_Pa, strength_Pa;
    std::vector<std::uint8_t> slipping;
  };

  /// @param before  the state at time 0, before the first (sub-)step
  /// @param mu_s    coefficient at rest in that state
  SlipFinder(const statics::Equilibrium& before, const PerNode& mu_s, int halo, double creep_m_per_s);
  /// @param first, end  nodes that it looks at; around onsets tractions of others are not numbers
  SlipFinder(Memory memory, std::size_t first, std::size_t end, int halo, double creep_m_per_s);

  void find(double time_s, const interface::Interface& state, bool changed, SlipUpdate& seen);

  const Memory& memory() const { return memory_; }
  Memory& memory() { return memory_; }
  double creep_m_per_s() const { return creep_m_per_s_; }
  std::size_t n_around() const { return 2 * static_cast<std::size_t>(halo_) + 1; }
  /// Counts anew what slips in the memory.
  void count_slipping();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(memory_.time_s);
    for (auto* values : {&memory_.t_Pa, &memory_.p_Pa, &memory_.strength_Pa})
      archive_vector(archive, *values);
    archive_vector(archive, memory_.slipping);
    if constexpr (Archive::is_loading::value) count_slipping();
  }

 private:
  /// Finds the time of an onset and the tractions around it.
  void locate_onset(SlipChange& onset, double time_s, const interface::Interface& state,
                    std::span<record::Traction> around) const;

  Memory memory_;
  std::size_t first_ = 0, end_ = 0;
  int halo_;
  double creep_m_per_s_;
  std::size_t n_slipping_ = 0;  ///< of the nodes that it looks at
};

/// Records beginnings and ends of slip while the run goes, located inside the (sub-)step.
///
/// Fronts are found from the first onset of each node, and from whether other nodes slip at these times. A
/// node's end of slip and its next onset, or a later onset and the end after it, are left out where no node
/// began to slip for the first time between the two: so the record stays bounded however often nodes slip
/// again.
class Recorder : public UpdateObserver {
 public:
  /// @param before  the state at time 0, before the first (sub-)step; nodes that slip in it have no onset
  /// @param mu_s    coefficient at rest in that state
  /// @param creep_m_per_s  slip no faster than this does not count in last_motion_s
  /// @param halo    nodes on each side whose tractions are kept at an onset
  Recorder(const statics::Equilibrium& before, const PerNode& mu_s, int halo, double creep_m_per_s = 0);

  void observe(double time_s, const interface::Interface& state, bool changed) override;
  /// The same where what the update shows has been found elsewhere.
  void consume(const SlipUpdate& seen);
  SlipFinder& finder() { return finder_; }
  std::size_t n_slipping() const { return n_slipping_; }

  /// Last time at which a node slipped faster than creep; 0 before that.
  double last_motion_s() const { return last_motion_s_; }
  /// Last contact update in which a node began to slip, whether for the first time or not; 0 before that.
  double last_onset_s() const { return last_onset_s_; }

  /// Without the last change of each node, which may yet be left out.
  const record::SlipRecord& record() const { return record_; }
  /// The whole record up to now.
  record::SlipRecord record_until(double end_time_s) const;

  /// Whether all that it knows can be known at a time.
  bool is_possible_at(double time_s) const;

  /// All that changes while a run goes.
  /// @throws UserError where what is read is of another interface
  template <class Archive>
  void serialize(Archive& archive) {
    const auto x_m = record_.x_m;
    const int halo = record_.halo;
    archive(last_motion_s_, last_onset_s_, record_, previous_time_s_, n_slipping_, last_first_onset_s_,
            finder_);
    archive_vector(archive, has_slipped_);
    archive_vector(archive, waiting_);
    archive_vector(archive, around_waiting_);
    if constexpr (Archive::is_loading::value)
      require_possible(record_.x_m == x_m && record_.halo == halo && is_possible_at(finder_.memory().time_s),
                       "a slip record");
  }

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
  std::size_t n_around() const { return finder_.n_around(); }

  SlipFinder finder_;
  SlipUpdate seen_;                     ///< of the last update
  std::vector<std::uint8_t> is_first_;  ///< its changes that are a node's first onset
  double last_motion_s_ = 0, last_onset_s_ = 0;
  record::SlipRecord record_;
  double previous_time_s_ = 0;
  std::size_t n_slipping_ = 0;
  double last_first_onset_s_ = -1;                ///< the latest first onset of any node
  std::vector<std::uint8_t> has_slipped_;         ///< since the start. [nodes]
  std::vector<Waiting> waiting_;                  ///< [nodes]
  std::vector<record::Traction> around_waiting_;  ///< [nodes x (2 halo + 1)]
};

}  // namespace slipfront::motion
