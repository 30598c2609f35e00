// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "record/record.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"

namespace slipfront::results {

/// Rows that make whole chunks of a history file: the best number to append at a time.
std::size_t history_block_rows(std::size_t n_nodes);

/// An interface.h5 that grows: the times [nt], the places [nx] and record::history_fields [nt, nx], each with
/// the attributes `unit` and `description`, all with checksums of HDF5's own. It can be read once it is
/// closed. Every function throws WriteError where the file cannot be written.
class HistoryFile {
 public:
  HistoryFile(const std::filesystem::path& path, std::span<const double> x_m, const Origin& origin = {});
  /// Appends rows; their x_m is not looked at.
  void append(const record::History& rows);
  /// Without it a full disk would go unnoticed. The last call.
  void close();

 private:
  hdf5::File file_;
  std::size_t n_nodes_, n_rows_ = 0;
};

/// An interface.h5 that was written just now, to be compared with what it should hold: HDF5 may lose what a
/// full disk has refused without a word. Every function throws WriteError where it holds something else.
class WrittenHistory {
 public:
  explicit WrittenHistory(const std::filesystem::path& path, const Origin& origin = {});
  /// Compares rows from `row` on, and the places.
  void require(std::size_t row, const record::History& rows) const;
  /// Compares the numbers of rows and of places.
  void require_lengths(std::size_t n_rows, std::size_t n_nodes) const;

 private:
  hdf5::File file_;
};

/// Writes a whole history and compares it. @throws WriteError
void write_history(const std::filesystem::path& file, const record::History& history,
                   const Origin& origin = {});

/// Reads a file that was written so, or by another program with the same names and units in the format of
/// HDF5 1.10. Where its folder has a list of checksums the file must be as it says before HDF5 sees it;
/// without one HDF5's own checksums tell damage.
/// @throws UserError naming the file, and the data set that is missing, misshaped or not held by it.
record::History read_history(const std::filesystem::path& file);

}  // namespace slipfront::results
