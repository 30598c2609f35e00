// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "results/rows.hpp"
#include "threads/writer.hpp"

namespace slipfront::results {

/// Appends rows to their files while a run goes. Another thread writes them (threads::Writer), and the steps
/// wait for it only where more than a bounded amount would be waiting: the memory does not grow with the run.
class ResultStream {
 public:
  /// What the writer may hold at a time of blocks that are not in their files yet; before more is handed to
  /// it, the steps wait. A piece that is larger by itself is handed over when the writer has nothing else.
  static constexpr std::size_t max_bytes_waiting = 16U << 20U;

  /// What the files hold so far, in their order.
  using Extents = std::vector<Extent>;

  /// Makes the files in place of earlier ones.
  ResultStream(std::filesystem::path dir, const std::vector<RowFormat>& formats);
  /// Goes on in files that hold at least so much; what they hold beyond is cut off.
  /// @throws UserError where one is missing, shorter, or another; StateError where there are others
  ResultStream(std::filesystem::path dir, std::vector<RowFormat> formats, const Extents& extents);
  ~ResultStream();
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;

  /// The rows of a file. Each function throws WriteError where one could not be written, perhaps long before.
  RowSink& sink(const std::string& file);
  /// Hands rows that are not yet a whole block to the writer, for those who look into the files.
  void hand_over();
  /// Waits until all that was given is on the device.
  Extents keep();
  /// The same, compares the files with what was given, and finishes them.
  /// @throws BlowUp where a number is not finite that has to be
  void finish(Numbers numbers = Numbers::finite);

 private:
  class File;
  std::filesystem::path dir_;
  std::vector<std::unique_ptr<File>> files_;
  threads::Writer writer_;
};

}  // namespace slipfront::results
