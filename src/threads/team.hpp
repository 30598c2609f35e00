// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <barrier>
#include <cstdint>
#include <functional>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

namespace slipfront::threads {

/// Threads that do parts of one piece of work after the other.
class Team {
 public:
  /// So many threads, or fewer where no more are to be had.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  static int processors();
  int size() const { return size_; }
  /// Calls work(part) for part in [0, parts) side by side and waits for all. `parts` is 1 or size(); work
  /// throws nothing.
  void run(int parts, const std::function<void(int)>& work);
  /// Within run: waits until all parts have come here.
  void meet(int parts) {
    if (parts > 1) barrier_->arrive_and_wait();
  }

 private:
  int size_ = 1;
  std::latch all_started_{1};
  std::unique_ptr<std::barrier<>> barrier_;
  const std::function<void(int)>* work_ = nullptr;  ///< null: the threads end
  std::vector<std::jthread> others_;
};

/// Numbers [begin, end) that are one part of n.
struct LoopChunk {
  int begin, end;
  LoopChunk(int n, int part, int parts)
      : begin(static_cast<int>(static_cast<std::int64_t>(n) * part / parts)),
        end(static_cast<int>(static_cast<std::int64_t>(n) * (part + 1) / parts)) {}
};

}  // namespace slipfront::threads
