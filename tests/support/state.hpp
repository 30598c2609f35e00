// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/state.hpp"

namespace slipfront::test {

/// State in memory.
class MemoryArchive final : public StateArchive {
 public:
  bool is_loading() const override { return is_loading_; }
  void bytes(void* data, std::size_t n) override {
    auto* at = static_cast<std::byte*>(data);
    if (is_loading_) {
      require(n);
      std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(next_), n, at);
      next_ += n;
    } else {
      bytes_.insert(bytes_.end(), at, at + n);
    }
  }
  void require(std::uint64_t count) const override {
    if (count > bytes_.size() - next_) throw StateError("the state is at its end");
  }
  /// From now on what was written is read.
  void rewind() { is_loading_ = true; }
  std::vector<std::byte>& content() { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t next_ = 0;
  bool is_loading_ = false;
};

/// The state of something that has `archive`, for another one of its kind.
template <class T>
void copy_state(T& from, T& to) {
  MemoryArchive state;
  from.archive(state);
  state.rewind();
  to.archive(state);
}

}  // namespace slipfront::test
