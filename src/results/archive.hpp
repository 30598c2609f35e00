// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "base/state.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"

/// State of a program under way in a separate file: numbers as they are in memory, so that what is read is
/// what was written to the last bit, and behind them a checksum of everything. See StateArchive.
namespace slipfront::results {

/// Writes a file of states. The file is there once `close` has returned, not before.
class OutputArchive : public StateArchive {
 public:
  /// @throws WriteError, as every other function
  explicit OutputArchive(const std::filesystem::path& file);
  ~OutputArchive() override;
  bool is_loading() const override { return false; }
  void bytes(void* data, std::size_t n) override;
  /// Writes the checksum, waits until all is on the device and gives the file its name.
  void close();

 private:
  void flush();
  std::filesystem::path path_, fresh_;
  files::OutputFile file_;
  files::Sha256 sum_;
  std::vector<std::byte> waiting_;
};

/// Reads such a file.
class InputArchive : public StateArchive {
 public:
  /// Compares the checksum before anything is read.
  /// @throws UserError where the file is missing, damaged, or no such file; loading does so where there is
  /// less than is asked for
  explicit InputArchive(const std::filesystem::path& file);
  const std::filesystem::path& path() const { return path_; }
  bool is_loading() const override { return true; }
  void bytes(void* data, std::size_t n) override;
  void require(std::uint64_t count) const override;
  /// @throws UserError where something is left.
  void close();

 private:
  [[noreturn]] void throw_damaged() const;
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t left_ = 0;
};

}  // namespace slipfront::results
