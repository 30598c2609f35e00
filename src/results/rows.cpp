// SPDX-License-Identifier: BSD-3-Clause
#include "results/rows.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace slipfront::results {
namespace {

/// Files are read in pieces of this size for their checksum.
constexpr std::size_t piece_bytes = std::size_t{1} << 18U;
/// A head is of whole blocks of a disk, with more than enough of them for all but texts and places.
constexpr std::uint64_t block_bytes = 4096, metadata_bytes = 16 * block_bytes;
/// Bytes of a signature; a file that is not finished has the length of its head in them.
constexpr std::size_t signature_bytes = 8;

/// Adds what a file holds between two places, as far as it is there.
void add_bytes(const std::filesystem::path& path, std::uint64_t first, std::uint64_t end,
               files::Sha256& sum) {
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(first));
  std::vector<char> piece(piece_bytes);
  while (first < end) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(end - first, piece.size()));
    if (!stream.read(piece.data(), static_cast<std::streamsize>(n))) return;
    sum.add(std::as_bytes(std::span(piece).first(n)));
    first += n;
  }
}

[[noreturn]] void throw_changed(const std::filesystem::path& path) {
  throw WriteError("{}: is not what was written: it was changed, damaged or removed meanwhile",
                   path.string());
}

std::span<const std::byte> bytes_of(const std::uint64_t& number) {
  static_assert(sizeof(number) == signature_bytes);
  return std::as_bytes(std::span(&number, 1));
}

/// A finished file becomes one that goes on, before it is cut: it is read as what it is.
files::OutputFile reopened(const std::filesystem::path& path, std::uint64_t head_bytes,
                           std::uint64_t length) {
  if (files::is_there(path)) {
    files::PlacedFile file(path);
    file.write_at(0, bytes_of(head_bytes));
    file.sync();
    file.close();
  }
  return files::OutputFile::resume(path, length);
}

}  // namespace

std::uint64_t head_bytes(const Origin& origin, std::size_t others) {
  const auto bytes = metadata_bytes + origin.title.size() + origin.case_text.size() + others;
  return (bytes + block_bytes - 1) / block_bytes * block_bytes;
}

RowFile::RowFile(const std::filesystem::path& path, std::uint64_t head_bytes)
    : file_(files::OutputFile::create(path)) {
  file_.write(bytes_of(head_bytes));
  file_.write(std::vector<std::byte>(head_bytes - signature_bytes));
}

RowFile::RowFile(const std::filesystem::path& path, std::uint64_t head_bytes, const Extent& extent)
    : file_(reopened(path, head_bytes, extent.bytes)) {
  n_values_ = extent.n_values;
  n_finite_ = extent.n_finite;
  add_bytes(path, head_bytes, extent.bytes, sum_);
  if (sum_.digest() != extent.checksum)
    throw UserError("{}: was changed or damaged since the last checkpoint; start the run again",
                    path.string());
}

void RowFile::write(std::span<const double> values) {
  file_.write(std::as_bytes(values));
  sum_.add(std::as_bytes(values));
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (n_finite_ == n_values_)
    n_finite_ += static_cast<std::uint64_t>(std::ranges::find_if_not(values, is_finite) - values.begin());
  n_values_ += values.size();
}

Extent RowFile::sync() {
  file_.sync();
  return {file_.length(), sum_.digest(), n_values_, n_finite_};
}

void require_unchanged(const std::filesystem::path& path, std::uint64_t head_bytes, const Extent& extent) {
  files::Sha256 sum;
  std::error_code error;
  if (files::is_file(path)) add_bytes(path, head_bytes, extent.bytes, sum);
  if (std::filesystem::file_size(path, error) != extent.bytes || error || sum.digest() != extent.checksum)
    throw_changed(path);
}

RowReader::RowReader(const std::filesystem::path& path, std::size_t row_values)
    : path_(path), stream_(path, std::ios::binary), row_values_(row_values) {
  read_at(0, std::as_writable_bytes(std::span(&head_bytes_, 1)));
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (error || bytes < head_bytes_) throw_changed(path);
  n_rows_ = (bytes - head_bytes_) / (sizeof(double) * row_values);
}

std::vector<double> RowReader::read(std::size_t row, std::size_t first, std::size_t n) {
  std::vector<double> values(n);
  read_at(head_bytes_ + sizeof(double) * (row * row_values_ + first),
          std::as_writable_bytes(std::span(values)));
  return values;
}

void RowReader::read_at(std::uint64_t place, std::span<std::byte> bytes) {
  stream_.seekg(static_cast<std::streamoff>(place));
  if (!stream_.read(reinterpret_cast<char*>(bytes.data()), std::ssize(bytes))) throw_changed(path_);
}

Layout::Layout(const std::filesystem::path& path, std::uint64_t head_bytes, const hdf5::Rows& rows,
               const Origin& origin, const std::function<void(const hdf5::File&)>& describe,
               const std::vector<std::string>& behind)
    : path_(path), head_(head_bytes) {
  const files::Descriptor memory(::memfd_create("layout", MFD_CLOEXEC));
  const auto name = fmt::format("/proc/self/fd/{}", memory.get());
  // Metadata first, so that they are all in the head.
  auto file = hdf5::create_file(name, path);
  hdf5::describe_root(file, origin);
  hdf5::create(file, rows.name, hdf5::Type::float64, {rows.n, rows.values});
  hdf5::set_attribute(file, rows.name, "unit", std::string("those of the data sets that show them"));
  hdf5::set_attribute(file, rows.name, "description", std::string("all numbers, as they were written"));
  describe(file);
  hdf5::close(std::move(file));
  file = hdf5::open_file(name, path, head_bytes);
  const auto place = hdf5::reserve(file, rows.name);
  SLIPFRONT_ASSERT(rows.n == 0 || place.offset == head_bytes, "the metadata fit into the head");
  hdf5::close(std::move(file));
  file = hdf5::open_file(name, path);
  for (const auto& data_set : behind) places_[data_set] = hdf5::reserve(file, data_set);
  hdf5::close(std::move(file));
  bytes_ = std::filesystem::file_size(name);
  std::ifstream(name, std::ios::binary)
      .read(reinterpret_cast<char*>(head_.data()), static_cast<std::streamsize>(head_bytes));
}

void Layout::finish() const {
  files::PlacedFile file(path_);
  file.write_at(signature_bytes, std::span(head_).subspan(signature_bytes));
  file.sync();
  file.write_at(0, std::span(head_).first(signature_bytes));
  file.sync();
  file.close();
  require_bytes(path_, 0, head_);
}

void require_bytes(const std::filesystem::path& path, std::uint64_t place, std::span<const std::byte> bytes) {
  std::vector<std::byte> written(bytes.size());
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(place));
  if (!stream.read(reinterpret_cast<char*>(written.data()), std::ssize(written)) ||
      std::memcmp(written.data(), bytes.data(), bytes.size()) != 0)
    throw_changed(path);
}

}  // namespace slipfront::results
