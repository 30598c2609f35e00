// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/state.hpp"

namespace slipfront {

/// Buffer of a message between two ranks of one program; values are read in the order in which they were
/// written.
class MessageBuffer {
 public:
  MessageBuffer() = default;
  explicit MessageBuffer(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  std::span<const std::byte> bytes() const { return bytes_; }
  /// Appends the unread rest of another buffer.
  MessageBuffer& append(const MessageBuffer& buffer) {
    put_bytes(buffer.bytes_.data() + buffer.next_, buffer.bytes_.size() - buffer.next_);
    return *this;
  }
  void put_bytes(const void* from, std::size_t count) {
    const auto size = bytes_.size();
    bytes_.resize(size + count);
    if (count > 0) std::memcpy(bytes_.data() + size, from, count);
  }
  void take_bytes(void* to, std::size_t count) {
    SLIPFRONT_ASSERT(count <= bytes_.size() - next_, "a buffer holds what was written");
    if (count > 0) std::memcpy(to, bytes_.data() + next_, count);
    next_ += count;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t next_ = 0;
};

/// Writes a state to a message, or reads it from there.
class MessageArchive final : public StateArchive {
 public:
  explicit MessageArchive(MessageBuffer& to) : buffer_(to), is_loading_(false) {}
  static MessageArchive reader(MessageBuffer& from) { return {from, true}; }
  bool is_loading() const override { return is_loading_; }
  bool is_message() const override { return true; }
  void bytes(void* data, std::size_t n) override {
    if (is_loading_)
      buffer_.take_bytes(data, n);
    else
      buffer_.put_bytes(data, n);
  }

 private:
  MessageArchive(MessageBuffer& buffer, bool is_loading) : buffer_(buffer), is_loading_(is_loading) {}

  MessageBuffer& buffer_;
  bool is_loading_;
};

/// A message of values.
template <class... T>
MessageBuffer packed(const T&... values) {
  MessageBuffer buffer;
  MessageArchive archive(buffer);
  archive(values...);
  return buffer;
}
template <class T>
T unpacked(MessageBuffer& from) {
  T value{};
  MessageArchive::reader(from)(value);
  return value;
}
template <class T>
T unpacked(MessageBuffer&& from) {
  return unpacked<T>(from);
}

}  // namespace slipfront
