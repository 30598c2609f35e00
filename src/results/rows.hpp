// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "files/checksum.hpp"
#include "files/files.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"

/// HDF5 files of rows that come one after the other: a head, the rows, doubles as in memory, and perhaps more
/// data behind them. While a run goes the head is empty but for its first eight bytes, which are its length
/// as an integer; so the rows can be appended, cut and read without HDF5. At the end HDF5's metadata are put
/// into the head, its first eight bytes last: a file is finished or not, whenever it is cut off. The rows
/// stay where they are, the data set `rows`; others show them as views.
namespace slipfront::results {

inline constexpr const char* rows_name = "rows";

/// @throws BlowUp
[[noreturn]] void throw_not_finite(const std::filesystem::path& file, const std::string& column);

/// Bytes of a head with some bytes of names and places.
std::uint64_t head_bytes(const Origin& origin, std::size_t others = 0);

/// What a file holds so far.
struct Extent {
  std::uint64_t bytes = 0;                   ///< with its head; 0 where there is no file yet
  std::string checksum;                      ///< of the rows
  std::uint64_t n_values = 0, n_finite = 0;  ///< numbers, and those before the first that is not finite
  template <class Archive>
  void serialize(Archive& archive) {
    archive(bytes, checksum, n_values, n_finite);
  }
};

/// Appends rows, and sums them up.
class RowFile {
 public:
  /// Makes a new file.
  RowFile(const std::filesystem::path& path, std::uint64_t head_bytes);
  /// Goes on in one that holds at least so much, finished or not; what it holds beyond is cut off.
  /// @throws UserError where it is missing, shorter, or another
  RowFile(const std::filesystem::path& path, std::uint64_t head_bytes, const Extent& extent);

  void write(std::span<const double> values);
  /// Returns when all is on the device.
  Extent sync();

 private:
  files::OutputFile file_;
  files::Sha256 sum_;
  std::uint64_t n_values_ = 0, n_finite_ = 0;
};

/// Compares a file that is complete. @throws WriteError where it is not what was written
void require_unchanged(const std::filesystem::path& path, std::uint64_t head_bytes, const Extent& extent);
/// Compares what lies at a place in a file. @throws as require_unchanged
void require_bytes(const std::filesystem::path& path, std::uint64_t place, std::span<const std::byte> bytes);

/// Reads the rows of a file that is to be finished.
class RowReader {
 public:
  /// @param path  of a file that is not finished
  /// @throws WriteError where it cannot be read
  RowReader(const std::filesystem::path& path, std::size_t row_values);
  std::uint64_t head_bytes() const { return head_bytes_; }
  std::size_t n_rows() const { return n_rows_; }
  /// Some values of a row.
  std::vector<double> read(std::size_t row, std::size_t first, std::size_t n);

 private:
  void read_at(std::uint64_t place, std::span<std::byte> bytes);

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t head_bytes_ = 0;
  std::size_t row_values_ = 0, n_rows_ = 0;
};

/// The metadata of a file, made in memory: what the program itself writes is all that is on the disk.
class Layout {
 public:
  /// @param describe  makes all data sets but `rows`
  /// @param behind    of these those whose numbers lie behind the rows
  Layout(const std::filesystem::path& path, std::uint64_t head_bytes, const hdf5::Rows& rows,
         const Origin& origin, const std::function<void(const hdf5::File&)>& describe,
         const std::vector<std::string>& behind = {});

  /// Size of the whole file.
  std::uint64_t bytes() const { return bytes_; }
  const hdf5::Place& place_of(const std::string& name) const { return places_.at(name); }
  /// Puts the head into its place, and compares it: the file is finished. @throws WriteError
  void finish() const;

 private:
  std::filesystem::path path_;
  std::vector<std::byte> head_;
  std::uint64_t bytes_ = 0;
  std::map<std::string, hdf5::Place> places_;
};

}  // namespace slipfront::results
