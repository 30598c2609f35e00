// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace slipfront {

/// Buffer of a message between two ranks of one program; values are read in the order in which they were
/// written.
class MessageBuffer {
 public:
  MessageBuffer() = default;
  explicit MessageBuffer(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  std::span<const std::byte> bytes() const { return bytes_; }

  template <class T>
  requires std::is_trivially_copyable_v<T> MessageBuffer& put(const T& value) {
    return put_bytes(&value, sizeof(T));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> MessageBuffer& put(std::span<const T> values) {
    put(static_cast<std::uint64_t>(values.size()));
    return put_bytes(values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> MessageBuffer& put(std::span<T> values) {
    return put(std::span<const T>(values));
  }
  template <class T>
  MessageBuffer& put(const std::vector<T>& values) {
    return put(std::span<const T>(values));
  }
  /// Makes room for so many bytes more.
  void reserve(std::size_t n) { bytes_.reserve(bytes_.size() + n); }
  /// Appends the unread rest of another buffer.
  MessageBuffer& append(const MessageBuffer& buffer) {
    return put_bytes(buffer.bytes_.data() + buffer.next_, buffer.bytes_.size() - buffer.next_);
  }
  MessageBuffer& put(const std::string& text) { return put(std::span<const char>(text)); }

  template <class T>
  requires std::is_trivially_copyable_v<T> T take() {
    T value;
    take_bytes(&value, sizeof(T));
    return value;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> std::vector<T> take_all() {
    const auto count = static_cast<std::size_t>(take<std::uint64_t>());
    SLIPFRONT_ASSERT(count <= (bytes_.size() - next_) / sizeof(T), "a buffer holds what was written");
    std::vector<T> values(count);
    take_bytes(values.data(), count * sizeof(T));
    return values;
  }
  std::string take_text() {
    const auto text = take_all<char>();
    return {text.begin(), text.end()};
  }

  MessageBuffer& put_bytes(const void* from, std::size_t count) {
    const auto size = bytes_.size();
    bytes_.resize(size + count);
    if (count > 0) std::memcpy(bytes_.data() + size, from, count);
    return *this;
  }
  void take_bytes(void* to, std::size_t count) {
    SLIPFRONT_ASSERT(count <= bytes_.size() - next_, "a buffer holds what was written");
    if (count > 0) std::memcpy(to, bytes_.data() + next_, count);
    next_ += count;
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t next_ = 0;
};

}  // namespace slipfront
