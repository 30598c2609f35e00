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

/// Values on their way from one process to another one of the same program, taken in the order in which they
/// were put.
class Parcel {
 public:
  Parcel() = default;
  explicit Parcel(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  std::span<const std::byte> bytes() const { return bytes_; }
  /// Whether all has been taken.
  bool is_empty() const { return next_ == bytes_.size(); }

  template <class T>
  requires std::is_trivially_copyable_v<T> Parcel& put(const T& value) {
    return put_bytes(&value, sizeof(T));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> Parcel& put(std::span<const T> values) {
    put(static_cast<std::uint64_t>(values.size()));
    return put_bytes(values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> Parcel& put(std::span<T> values) {
    return put(std::span<const T>(values));
  }
  template <class T>
  Parcel& put(const std::vector<T>& values) {
    return put(std::span<const T>(values));
  }
  /// Makes room for so many bytes more.
  void reserve(std::size_t n) { bytes_.reserve(bytes_.size() + n); }
  /// What has not been taken from another parcel, to be taken as if it had been put here.
  Parcel& append(const Parcel& parcel) {
    return put_bytes(parcel.bytes_.data() + parcel.next_, parcel.bytes_.size() - parcel.next_);
  }
  Parcel& put(const std::string& text) { return put(std::span<const char>(text)); }

  template <class T>
  requires std::is_trivially_copyable_v<T> T take() {
    T value;
    take_bytes(&value, sizeof(T));
    return value;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> std::vector<T> take_all() {
    const auto count = static_cast<std::size_t>(take<std::uint64_t>());
    SLIPFRONT_ASSERT(count <= (bytes_.size() - next_) / sizeof(T), "a parcel holds what was put");
    std::vector<T> values(count);
    take_bytes(values.data(), count * sizeof(T));
    return values;
  }
  std::string take_text() {
    const auto text = take_all<char>();
    return {text.begin(), text.end()};
  }

 private:
  Parcel& put_bytes(const void* from, std::size_t count) {
    const auto size = bytes_.size();
    bytes_.resize(size + count);
    if (count > 0) std::memcpy(bytes_.data() + size, from, count);
    return *this;
  }
  void take_bytes(void* to, std::size_t count) {
    SLIPFRONT_ASSERT(count <= bytes_.size() - next_, "a parcel holds what was put");
    if (count > 0) std::memcpy(to, bytes_.data() + next_, count);
    next_ += count;
  }

  std::vector<std::byte> bytes_;
  std::size_t next_ = 0;
};

}  // namespace slipfront
