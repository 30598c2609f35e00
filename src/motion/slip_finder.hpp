// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/per_node.hpp"
#include "base/state.hpp"
#include "interface/interface.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// A node begins or ceases to slip.
struct SlipChange {
  std::int32_t node = 0;
  bool begins = false;
  double time_s = 0;  ///< of a beginning located inside the (sub-)step
  double share = 1;   ///< of the (sub-)step that has passed then
  template <class Archive>
  void serialize(Archive& archive) {
    archive(node, begins, time_s, share);
  }
};

/// Changes of slip in one contact update.
struct SlipUpdate {
  double time_s = 0;                     ///< to which its tractions belong
  bool moves = false;                    ///< whether a node slips faster than creep
  std::vector<SlipChange> changes;       ///< nodes ascending
  std::vector<record::Traction> around;  ///< at the beginnings among them, [beginnings x (2 halo + 1)]
};

/// Finds beginnings and ends of slip between successive contact updates.
class SlipFinder {
 public:
  /// What it knows of the last update, [nodes] each.
  struct Memory {
    double time_s = 0;
    std::vector<double> t_Pa, p_Pa, strength_Pa, onset_ratio;
    std::vector<std::uint8_t> slipping;
    template <class Archive>
    void serialize(Archive& archive) {
      archive(time_s, t_Pa, p_Pa, strength_Pa, onset_ratio, slipping);
    }
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
  int halo() const { return halo_; }
  std::size_t n_slipping() const { return n_slipping_; }
  std::size_t n_around() const { return 2 * static_cast<std::size_t>(halo_) + 1; }
  /// All that changes while a run goes.
  void archive(StateArchive& archive);

 private:
  /// Counts anew what slips in the memory.
  void count_slipping();
  /// Finds the time of an onset and the tractions around it.
  void locate_onset(SlipChange& onset, double time_s, const interface::Interface& state,
                    std::span<record::Traction> around) const;

  Memory memory_;
  std::size_t first_ = 0, end_ = 0;
  int halo_;
  double creep_m_per_s_;
  std::size_t n_slipping_ = 0;  ///< of the nodes that it looks at
};

}  // namespace slipfront::motion
