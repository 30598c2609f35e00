// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cereal/cereal.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "files/checksum.hpp"
#include "files/files.hpp"

/// State of a program under way in a separate file: numbers as they are in memory, so that what is read is
/// what was written to the last bit, and behind them a checksum of everything. Types tell what belongs to
/// their state by cereal's `serialize`.
namespace slipfront::results {

/// Writes a file of states. The file is there once `close` has returned, not before.
class OutputArchive : public cereal::OutputArchive<OutputArchive, cereal::AllowEmptyClassElision> {
 public:
  /// @throws WriteError, as every other function
  explicit OutputArchive(const std::filesystem::path& file);
  ~OutputArchive() override;
  void save(const void* data, std::size_t bytes);
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
class InputArchive : public cereal::InputArchive<InputArchive, cereal::AllowEmptyClassElision> {
 public:
  /// Compares the checksum before anything is read.
  /// @throws UserError where the file is missing, damaged, or no such file; loading does so where there is
  /// less than is asked for
  explicit InputArchive(const std::filesystem::path& file);
  const std::filesystem::path& path() const { return path_; }
  void load(void* data, std::size_t bytes);
  void load(bool& flag);
  /// Refuses a length that what is left of the file cannot hold.
  void require(std::uint64_t count) const;
  /// @throws UserError where something is left.
  void close();

 private:
  [[noreturn]] void throw_damaged() const;
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t left_ = 0;
};

template <class T>
requires std::is_arithmetic_v<T>
void CEREAL_SAVE_FUNCTION_NAME(OutputArchive& archive, const T& value) {
  archive.save(&value, sizeof(value));
}
template <class T>
requires std::is_arithmetic_v<T>
void CEREAL_LOAD_FUNCTION_NAME(InputArchive& archive, T& value) {
  if constexpr (std::same_as<T, bool>)
    archive.load(value);
  else
    archive.load(&value, sizeof(value));
}
template <class T>
void CEREAL_SAVE_FUNCTION_NAME(OutputArchive& archive, const cereal::BinaryData<T>& data) {
  archive.save(data.data, data.size);
}
template <class T>
void CEREAL_LOAD_FUNCTION_NAME(InputArchive& archive, cereal::BinaryData<T>& data) {
  archive.load(data.data, data.size);
}
template <class T>
void CEREAL_SAVE_FUNCTION_NAME(OutputArchive& archive, const cereal::SizeTag<T>& tag) {
  const auto count = static_cast<std::uint64_t>(tag.size);
  archive.save(&count, sizeof(count));
}
template <class T>
void CEREAL_LOAD_FUNCTION_NAME(InputArchive& archive, cereal::SizeTag<T>& tag) {
  std::uint64_t count = 0;
  archive.load(&count, sizeof(count));
  archive.require(count);
  tag.size = count;
}
template <class Archive, class T>
requires(
    std::same_as<Archive, OutputArchive> ||
    std::same_as<Archive, InputArchive>) void CEREAL_SERIALIZE_FUNCTION_NAME(Archive& archive,
                                                                             cereal::NameValuePair<T>& pair) {
  archive(pair.value);
}

}  // namespace slipfront::results

CEREAL_REGISTER_ARCHIVE(slipfront::results::OutputArchive)
CEREAL_REGISTER_ARCHIVE(slipfront::results::InputArchive)
CEREAL_SETUP_ARCHIVE_TRAITS(slipfront::results::InputArchive, slipfront::results::OutputArchive)
