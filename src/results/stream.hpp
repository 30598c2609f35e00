// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/checksum.hpp"
#include "files/files.hpp"
#include "motion/observers/event_output.hpp"
#include "record/probes.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"
#include "results/snapshots.hpp"
#include "threads/writer.hpp"

namespace slipfront::results {

/// Appends history and snapshots of a run to files while it goes. Another thread writes them
/// (threads::Writer), and the steps wait for it only where more than a bounded amount would be waiting: the
/// memory does not grow with the run. The files hold nothing but numbers, one record after the other, so that
/// they can be read whenever the run ends, and cut to where a run that goes on begins; interface.h5 and
/// fields.vtkhdf are made of them at the end.
///
/// history.raw: per row time_s and each of record::history_fields [nodes];
/// snapshots.raw: per snapshot time_s and u_x, u_y, v_x, v_y [nodes of the plate]; probes.raw, where there
/// are probes: per row time_s and each of record::probe_fields [probes]; doubles as in memory.
class ResultStream : public motion::EventOutput {
 public:
  /// What the writer may hold at a time of blocks and snapshots that are not in their files yet; before more
  /// is handed to it, the steps wait. A snapshot that is larger by itself is handed over when the writer has
  /// nothing else.
  static constexpr std::size_t max_bytes_waiting = 16U << 20U;

  /// What a file of the stream holds so far.
  struct Extent {
    std::uint64_t bytes = 0;
    std::string checksum;
    template <class Archive>
    void serialize(Archive& archive) {
      archive(bytes, checksum);
    }
  };
  struct Extents {
    Extent history, snapshots, probes;  ///< the last one empty without probes
    template <class Archive>
    void serialize(Archive& archive) {
      archive(history, snapshots, probes);
    }
  };

  /// Makes the files.
  explicit ResultStream(const std::filesystem::path& dir, bool with_probes = false);
  /// Goes on in files that hold at least so much; what they hold beyond is cut off.
  /// @throws UserError where one is missing, shorter, or another
  ResultStream(const std::filesystem::path& dir, const Extents& extents, bool with_probes = false);

  // Each throws WriteError where a file could not be written, perhaps long before.
  void sample(const record::History& row) override;
  /// Takes each piece of the motion when there is room for a copy of it.
  void snapshot(motion::TimeStepper& stepper) override;
  void probe(const record::ProbeRecord& rows) override;
  /// Hands rows that are not yet a whole block to the writer, for those who look into the files.
  void hand_over();
  /// Waits until all that was given is on the device.
  Extents keep();

  /// Compares files that are complete. @throws WriteError where one is not what was written.
  static void require_unchanged(const std::filesystem::path& dir, const Extents& extents);

  static std::filesystem::path history_file(const std::filesystem::path& dir);
  static std::filesystem::path snapshot_file(const std::filesystem::path& dir);
  static std::filesystem::path probe_file(const std::filesystem::path& dir);

 private:
  /// A file and the checksum of what was written to it.
  struct Summed {
    files::OutputFile file;
    files::Sha256 sum;

    /// Of a new file.
    explicit Summed(const std::filesystem::path& path) : file(files::OutputFile::create(path)) {}
    /// Of one that goes on.
    Summed(const std::filesystem::path& path, const Extent& extent);
    void write(std::span<const double> values);
    Extent sync();
  };

  Summed history_, snapshots_;               ///< the writer's
  std::optional<Summed> probes_;             ///< the writer's
  std::vector<double> block_, probe_block_;  ///< rows that the writer does not have yet
  threads::Writer writer_;
};

/// Makes interface.h5 of a stream's file. A record that was cut off at its end is left out.
/// @throws WriteError, UserError where the file is missing
void write_history(const std::filesystem::path& file, const std::filesystem::path& raw,
                   std::span<const double> x_m, const Origin& origin = {});

/// Makes probes.h5 of a stream's file. @throws as write_history
void write_probes(const std::filesystem::path& file, const std::filesystem::path& raw,
                  std::span<const record::ProbePlace> places, const Origin& origin);

/// The snapshots of a stream's file over the nodes of a mesh, read where they are wanted. One that was cut
/// off at its end is left out. @throws UserError where the file is missing
SnapshotSeries read_snapshots(const std::filesystem::path& raw, std::size_t n_nodes);

}  // namespace slipfront::results
