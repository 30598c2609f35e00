// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace slipfront::files {

/// SHA-256 of bytes that come one after the other.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::span<const std::byte> bytes);
  /// 64 hexadecimal digits, of all that was added so far.
  std::string digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string sha256(std::string_view text);
/// @throws UserError where the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

/// The list of checksums of a folder's files, in the form of sha256sum, which can check it.
inline constexpr const char* checksum_list = "checksums.sha256";

using Checksums = std::map<std::string, std::string>;  ///< of each file, by its name in the folder

/// @throws WriteError
void write_checksums(const std::filesystem::path& dir, const Checksums& checksums);
/// Empty where there is no list.
/// @throws UserError where it is not one: names outside the folder among them.
Checksums read_checksums(const std::filesystem::path& dir);
/// Compares every file of the list. Nothing is compared where there is none.
/// @throws UserError naming the first that is missing or another.
void require_intact(const std::filesystem::path& dir);
/// Compares one file with its folder's list, if there is one.
/// @throws UserError where it is not in the list, or another.
void require_listed(const std::filesystem::path& file);

}  // namespace slipfront::files
