// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "fronts/record.hpp"
#include "io/hdf5.hpp"

namespace slipfront::io {

/// Rows that make whole chunks of a history file: the best number to append at a time.
std::size_t history_block_rows(std::size_t n_nodes);

/// An interface.h5 that grows: time_s [nt], x_m [nx], slip_m, slip_rate_m_per_s, t_Pa, p_Pa [nt, nx], each
/// with the attributes `unit` and `description`. What was appended can be read even if the program is killed
/// later. Every function throws UserError where the file cannot be written.
class HistoryFile {
 public:
  /// @param shown  the file's name in messages, where it is to be another
  HistoryFile(const std::filesystem::path& path, std::span<const double> x_m,
              const std::filesystem::path& shown = {});
  /// Appends rows; their x_m is not looked at.
  void append(const fronts::History& rows);
  /// Without it a full disk would go unnoticed. The last call.
  void close();

 private:
  hdf5::File file_;
  std::size_t n_nodes_, n_rows_ = 0;
};

/// Writes a whole history. @throws UserError where the file cannot be written.
void write_history(const std::filesystem::path& file, const fronts::History& history);

/// Reads a file that was written so, or by another program with the same names and units.
/// @throws UserError naming the file and the missing or misshaped data set.
fronts::History read_history(const std::filesystem::path& file);

}  // namespace slipfront::io
