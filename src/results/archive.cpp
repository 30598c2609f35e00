// SPDX-License-Identifier: BSD-3-Clause
#include "results/archive.hpp"

#include <array>
#include <cstring>
#include <system_error>

#include "base/error.hpp"

namespace slipfront::results {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18U;
constexpr std::size_t sum_digits = 64;

}  // namespace

OutputArchive::OutputArchive(const std::filesystem::path& file)
    : path_(file), fresh_(file.string() + ".new"), file_(files::OutputFile::replace(fresh_)) {
  waiting_.reserve(buffer_bytes);
}

OutputArchive::~OutputArchive() {
  if (!fresh_.empty()) files::try_to_remove(fresh_);
}

void OutputArchive::bytes(void* data, std::size_t n) {
  const std::span<const std::byte> piece(static_cast<const std::byte*>(data), n);
  if (waiting_.size() + n > buffer_bytes) flush();
  if (n > buffer_bytes) {
    sum_.add(piece);
    file_.write(piece);
  } else {
    waiting_.insert(waiting_.end(), piece.begin(), piece.end());
  }
}

void OutputArchive::flush() {
  sum_.add(waiting_);
  file_.write(waiting_);
  waiting_.clear();
}

void OutputArchive::close() {
  flush();
  file_.write(sum_.digest());
  file_.sync();
  file_.close();
  files::move_file(fresh_, path_);
  fresh_.clear();
  files::sync_file(path_.parent_path());
}

InputArchive::InputArchive(const std::filesystem::path& file)
    : path_(file), stream_(files::is_file(file) ? std::ifstream(file, std::ios::binary) : std::ifstream()) {
  if (!stream_.is_open()) throw UserError("{}: cannot be read; check that it is there", path_.string());
  std::error_code error;
  const auto length = std::filesystem::file_size(file, error);
  if (error || length < sum_digits) throw_damaged();
  left_ = length - sum_digits;

  files::Sha256 sum;
  std::vector<std::byte> piece(buffer_bytes);
  for (auto rest = left_; rest > 0;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(rest, piece.size()));
    if (!stream_.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(n)))
      throw_damaged();
    sum.add(std::span(piece).first(n));
    rest -= n;
  }
  std::string written(sum_digits, ' ');
  if (!stream_.read(written.data(), sum_digits) || written != sum.digest()) throw_damaged();
  stream_.seekg(0);
}

void InputArchive::bytes(void* data, std::size_t n) {
  if (n > left_ || !stream_.read(static_cast<char*>(data), static_cast<std::streamsize>(n))) throw_damaged();
  left_ -= n;
}

void InputArchive::require(std::uint64_t count) const {
  if (count > left_) throw_damaged();
}

void InputArchive::close() {
  if (left_ != 0) throw_damaged();
}

void InputArchive::throw_damaged() const {
  throw UserError("{}: is damaged or of another version", path_.string());
}

}  // namespace slipfront::results
