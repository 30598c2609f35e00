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
#include <string>
#include <utility>
#include <vector>

#include "processes/processes.hpp"

namespace slipfront::test {

/// Threads of one process that send each other parcels as processes do.
class Mailboxes {
 public:
  explicit Mailboxes(int size) : size_(size) {}
  int size() const { return size_; }
  void put(int from, int to, Parcel parcel) {
    const std::scoped_lock lock(mutex_);
    boxes_[{from, to}].push_back(std::move(parcel));
    changed_.notify_all();
  }
  Parcel take(int from, int to) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[{from, to}];
    changed_.wait(lock, [&] { return !box.empty(); });
    auto parcel = std::move(box.front());
    box.pop_front();
    return parcel;
  }

 private:
  int size_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::pair<int, int>, std::deque<Parcel>> boxes_;
};

class ThreadProcess final : public Processes {
 public:
  ThreadProcess(Mailboxes& mail, int rank) : mail_(mail), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return mail_.size(); }
  void send(int to, const Parcel& parcel) override { mail_.put(rank_, to, parcel); }
  Parcel receive(int from) override { return mail_.take(from, rank_); }
  void exchange(std::span<const Exchange> exchanges) override {
    for (const auto& e : exchanges) send(e.with, Parcel().put(std::span<const double>(e.out)));
    for (const auto& e : exchanges) {
      const auto values = receive(e.with).take_all<double>();
      if (values.size() != e.in.size()) fail("an exchange of other lengths");
      std::ranges::copy(values, e.in.begin());
    }
  }
  void take_largest(std::span<double> values) override {
    for (int other = 0; other < size(); ++other)
      if (other != rank_) send(other, Parcel().put(std::span<const double>(values)));
    for (int other = 0; other < size(); ++other) {
      if (other == rank_) continue;
      const auto theirs = receive(other).take_all<double>();
      for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::max(values[k], theirs[k]);
    }
  }
  [[noreturn]] void fail(const std::string& message) override {
    std::fprintf(stderr, "process %d: %s\n", rank_, message.c_str());
    std::abort();
  }

 private:
  Mailboxes& mail_;
  int rank_;
};

}  // namespace slipfront::test
