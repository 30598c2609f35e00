// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "processes/processes.hpp"

namespace slipfront::test {

/// Messages between threads that stand for ranks.
class Mailboxes {
 public:
  explicit Mailboxes(int size) : size_(size) {}
  int size() const { return size_; }
  static constexpr int of_messages = -1;
  void put(int from, int to, MessageBuffer buffer, int channel = of_messages) {
    const std::scoped_lock lock(mutex_);
    boxes_[{from, to, channel}].push_back(std::move(buffer));
    changed_.notify_all();
  }
  MessageBuffer take(int from, int to, int channel = of_messages) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[{from, to, channel}];
    changed_.wait(lock, [&] { return !box.empty(); });
    auto buffer = std::move(box.front());
    box.pop_front();
    return buffer;
  }

 private:
  int size_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::tuple<int, int, int>, std::deque<MessageBuffer>> boxes_;
};

class Sent final : public Processes::Transfer {
 public:
  Sent(Mailboxes& mail, int from, int to, int channel, std::span<const std::byte> bytes)
      : mail_(mail), from_(from), to_(to), channel_(channel), bytes_(bytes) {}
  void begin() override { mail_.put(from_, to_, MessageBuffer({bytes_.begin(), bytes_.end()}), channel_); }
  void finish() override {}

 private:
  Mailboxes& mail_;
  int from_, to_, channel_;
  std::span<const std::byte> bytes_;
};

class Received final : public Processes::Transfer {
 public:
  Received(Mailboxes& mail, int from, int to, int channel, std::span<std::byte> bytes)
      : mail_(mail), from_(from), to_(to), channel_(channel), bytes_(bytes) {}
  void begin() override {
    SLIPFRONT_ASSERT(!is_under_way_, "begun again before its end");
    is_under_way_ = true;
  }
  void finish() override {
    if (!is_under_way_) return;
    is_under_way_ = false;
    const auto buffer = mail_.take(from_, to_, channel_);
    SLIPFRONT_ASSERT(buffer.bytes().size() == bytes_.size(), "a transfer of other lengths");
    std::ranges::copy(buffer.bytes(), bytes_.begin());
  }

 private:
  Mailboxes& mail_;
  int from_, to_, channel_;
  std::span<std::byte> bytes_;
  bool is_under_way_ = false;
};

class ThreadProcess final : public Processes {
 public:
  ThreadProcess(Mailboxes& mail, int rank) : mail_(mail), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return mail_.size(); }
  void send(int to, const MessageBuffer& buffer) override { mail_.put(rank_, to, buffer); }
  MessageBuffer receive(int from) override { return mail_.take(from, rank_); }
  std::unique_ptr<Transfer> transfer_to(int rank, int channel, std::span<const std::byte> bytes) override {
    return std::make_unique<Sent>(mail_, rank_, rank, channel, bytes);
  }
  std::unique_ptr<Transfer> transfer_from(int rank, int channel, std::span<std::byte> bytes) override {
    return std::make_unique<Received>(mail_, rank, rank_, channel, bytes);
  }
  void reduce_max(std::span<double> values) override {
    for (int other = 0; other < size(); ++other)
      if (other != rank_) send(other, packed(std::vector(values.begin(), values.end())));
    for (int other = 0; other < size(); ++other) {
      if (other == rank_) continue;
      const auto theirs = unpacked<std::vector<double>>(receive(other));
      for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::max(values[k], theirs[k]);
    }
  }
  [[noreturn]] void fail(int /*exit_code*/, const std::string& line) override {
    std::fprintf(stderr, "%s\n", line.c_str());
    std::abort();
  }

 private:
  Mailboxes& mail_;
  int rank_;
};

/// Runs f(rank) for each of some ranks, in threads. @throws what rank 0 throws
template <class F>
void on_ranks(int n, F&& f) {
  std::vector<std::jthread> others;
  for (int rank = 1; rank < n; ++rank)
    others.emplace_back([&f, rank] {
      try {
        f(rank);
      } catch (const FailedElsewhere&) {
        // Rank 0 tells.
      }
    });
  f(0);
}

}  // namespace slipfront::test
