// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "base/state.hpp"

namespace slipfront {

/// Where the state of work under way is written to, or read from: numbers as they are in memory. Whoever has
/// a state lists its members once, for both: `archive(a, b)`. Types tell theirs by a template `serialize`.
class StateArchive {
 public:
  StateArchive() = default;
  StateArchive(const StateArchive&) = delete;
  StateArchive& operator=(const StateArchive&) = delete;
  virtual ~StateArchive() = default;

  virtual bool is_loading() const = 0;
  /// Writes so many bytes, or reads them.
  virtual void bytes(void* data, std::size_t n) = 0;
  /// Refuses a length that what is left to read cannot hold.
  virtual void require(std::uint64_t count) const = 0;

  template <class... T>
  void operator()(T&... members) {
    (member(members), ...);
  }

 private:
  template <class T>
  void member(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      auto byte = static_cast<std::uint8_t>(value);
      bytes(&byte, 1);
      require_possible(byte <= 1, "flags");
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes(&value, sizeof(value));
    } else {
      value.serialize(*this);
    }
  }
  template <class T>
  void member(std::vector<T>& values) {
    std::uint64_t count = values.size();
    member(count);
    if (is_loading()) {
      require(count);
      values.resize(count);
    }
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      bytes(values.data(), sizeof(T) * values.size());
    else
      for (auto& value : values) member(value);
  }
};

/// A vector of known length. @throws StateError where one of another length is read, or of impossible values.
template <class T>
void archive_vector(StateArchive& archive, std::vector<T>& values) {
  const auto length = values.size();
  archive(values);
  require_possible(values.size() == length, "numbers");
  for (const auto& value : values) require_possible(!archive.is_loading() || is_possible(value), "numbers");
}

/// The numbers of an archive that has `save` or `load` of bytes, and tells by its type which.
template <class Archive>
class StateOfArchive final : public StateArchive {
 public:
  explicit StateOfArchive(Archive& archive) : archive_(archive) {}
  bool is_loading() const override { return Archive::is_loading::value; }
  void bytes(void* data, std::size_t n) override {
    if constexpr (Archive::is_loading::value)
      archive_.load(data, n);
    else
      archive_.save(data, n);
  }
  void require([[maybe_unused]] std::uint64_t count) const override {
    if constexpr (Archive::is_loading::value) archive_.require(count);
  }

 private:
  Archive& archive_;
};

}  // namespace slipfront
