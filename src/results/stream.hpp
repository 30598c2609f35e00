// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "motion/observers/event_output.hpp"
#include "results/rows.hpp"
#include "results/snapshots.hpp"
#include "results/table.hpp"
#include "threads/writer.hpp"

namespace slipfront::results {

inline constexpr const char* history_file = "interface.h5";
inline constexpr const char* snapshot_file = "fields.vtkhdf";
inline constexpr const char* probe_file = "probes.h5";

/// What the files of a run hold.
struct RunFiles {
  Table history;
  SnapshotRows snapshots;
  std::optional<Table> probes = {};
};

/// Appends what a run gives to its files of rows while it goes. Another thread writes them
/// (threads::Writer), and the steps wait for it only where more than a bounded amount would be waiting: the
/// memory does not grow with the run. There is a file of snapshots with the first of them.
class ResultStream : public motion::EventOutput {
 public:
  /// What the writer may hold at a time of blocks and snapshots that are not in their files yet; before more
  /// is handed to it, the steps wait. A snapshot that is larger by itself is handed over when the writer has
  /// nothing else.
  static constexpr std::size_t max_bytes_waiting = 16U << 20U;

  /// What the files hold so far.
  struct Extents {
    Extent history, snapshots, probes;
    template <class Archive>
    void serialize(Archive& archive) {
      archive(history, snapshots, probes);
    }
  };

  /// Makes the files in place of earlier ones.
  ResultStream(std::filesystem::path dir, RunFiles files);
  /// Goes on in files that hold at least so much; what they hold beyond is cut off.
  /// @throws UserError where one is missing, shorter, or another
  ResultStream(std::filesystem::path dir, RunFiles files, const Extents& extents);

  // Each throws WriteError where a file could not be written, perhaps long before.
  void sample(const record::History& rows) override;
  /// Takes each piece of the motion when there is room for a copy of it.
  void snapshot(motion::TimeStepper& stepper) override;
  void snapshot(const motion::Snapshot& snapshot);
  void probe(const record::ProbeRecord& rows) override;
  /// Hands rows that are not yet a whole block to the writer, for those who look into the files.
  void hand_over();
  /// Waits until all that was given is on the device.
  Extents keep();
  /// The same, compares the files with what was given, and finishes them but for that of snapshots.
  /// @throws BlowUp where a number is not finite that has to be
  void finish(Numbers numbers = Numbers::finite);

 private:
  void begin_snapshot(double time_s);
  /// @param place  of the values in the snapshot
  void put_motion(std::vector<double> values, std::size_t place);

  std::filesystem::path dir_;
  RunFiles files_;
  std::optional<RowFile> history_, snapshots_, probes_;  ///< the writer's
  std::vector<double> block_, probe_block_;              ///< rows that the writer does not have yet
  threads::Writer writer_;
};

}  // namespace slipfront::results
