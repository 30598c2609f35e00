// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace slipfront {

/// Whether a saved value is one: numbers are finite, bytes are flags.
template <class T>
bool is_possible(const T& value) {
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
  if constexpr (std::is_same_v<T, std::uint8_t>) return value <= 1;
  return true;
}

/// A saved state does not fit the case that reads it.
struct StateError : UserError {
  using UserError::UserError;
};

/// Refuses a saved state that its case does not come to. @throws StateError
inline void require_possible(bool is_possible, const char* what) {
  if (!is_possible) throw StateError("the saved state has {} of another case, or was changed", what);
}

/// Where the state of work under way is written to, or read from: numbers as they are in memory. Whoever has
/// a state lists its members once, for both: `archive(a, b)`. Types tell theirs by a template `serialize`.
class StateArchive {
 public:
  StateArchive() = default;
  StateArchive(const StateArchive&) = delete;
  StateArchive& operator=(const StateArchive&) = delete;
  virtual ~StateArchive() = default;

  virtual bool is_loading() const = 0;
  /// Between ranks of one program: plain types need no `serialize`.
  virtual bool is_message() const { return false; }
  /// Writes n bytes, or reads them.
  virtual void bytes(void* data, std::size_t n) = 0;
  /// Refuses a length that what is left to read cannot hold.
  virtual void require(std::uint64_t /*count*/) const {}

  template <class... T>
  void operator()(T&&... members) {
    (member(members), ...);
  }

 private:
  /// Constants are written only.
  template <class T>
  void member(const T& value) {
    SLIPFRONT_ASSERT(!is_loading(), "a constant is not read");
    member(const_cast<T&>(value));
  }
  void member(std::string& text) {
    std::vector<char> letters(text.begin(), text.end());
    member(letters);
    text.assign(letters.begin(), letters.end());
  }
  template <class T>
  void member(std::optional<T>& value) {
    bool is_there = value.has_value();
    member(is_there);
    if (is_loading()) value = is_there ? std::optional<T>(std::in_place) : std::nullopt;
    if (value) member(*value);
  }
  template <class T>
  void member(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      auto byte = static_cast<std::uint8_t>(value);
      bytes(&byte, 1);
      require_possible(byte <= 1, "flags");
      value = byte != 0;
    } else if constexpr (is_plain<T>) {
      bytes_of(&value, 1);
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
    if constexpr (is_plain<T>)
      bytes_of(values.data(), values.size());
    else
      for (auto& value : values) member(value);
  }
  template <class T>
  static constexpr bool is_plain =
      std::is_trivially_copyable_v<T> && !requires(T & value, StateArchive& archive) {
    value.serialize(archive);
  };
  template <class T>
  void bytes_of(T* values, std::size_t n) {
    SLIPFRONT_ASSERT(std::is_scalar_v<T> || is_message(), "a file holds members one by one");
    bytes(values, sizeof(T) * n);
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

}  // namespace slipfront
