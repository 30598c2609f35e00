// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "io/history.hpp"
#include "io/snapshots.hpp"
#include "io/writer.hpp"
#include "solve/event.hpp"

namespace slipfront::io {

/// Writes history and snapshots of a run to its folder while it goes, behind the computation, in memory that
/// does not grow with the run. Results of an earlier run stay until `publish`: so long the files are called
/// interface.h5.part and fields.vtkhdf.part. Every function throws UserError where a file cannot be written.
class ResultStream : public solve::Sink {
 public:
  /// @param x_m            nodes of the interface
  /// @param with_snapshots whether there may be any; then the mesh is written now, and is not needed later
  ResultStream(std::filesystem::path dir, std::span<const double> x_m, const mesh::Mesh& mesh,
               bool with_snapshots);
  void sample(const fronts::History& row) override;
  /// Copies the motion once there is room for it.
  void snapshot(const solve::Stepper& stepper) override;

  /// Waits until all is written, removes the results of an earlier run, and gives the files their names.
  void publish();

 private:
  /// A file under its name while the run goes; removed at the end unless it was renamed.
  struct Part {
    std::filesystem::path file, temporary;
    explicit Part(const std::filesystem::path& final_name);
    ~Part();
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    void publish() const;
  };
  void hand_over();

  // In this order: the writer ends before the files are closed, and they are closed before they are removed.
  std::filesystem::path dir_;
  Part history_part_, snapshot_part_;
  std::optional<HistoryFile> history_;     ///< the writer's
  std::optional<SnapshotFile> snapshots_;  ///< the writer's
  std::size_t block_rows_ = 0;
  fronts::History block_;  ///< rows to be handed to the writer
  Writer writer_;
};

}  // namespace slipfront::io
