// SPDX-License-Identifier: BSD-3-Clause
#include "threads/writer.hpp"

#include <system_error>
#include <utility>

namespace slipfront::threads {

Writer::Writer(std::size_t max_bytes) : max_bytes_(max_bytes) {
  try {
    thread_ = std::thread([this] { loop(); });
  } catch (const std::system_error&) {
    // No thread to be had.
  }
}

Writer::~Writer() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Writer::put(std::size_t bytes, std::function<void()> job) {
  if (!thread_.joinable()) {
    if (failure_) std::rethrow_exception(failure_);
    try {
      return job();
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }
  {
    std::unique_lock lock(mutex_);
    wait_for_room(lock, bytes);
    waiting_.push_back({bytes, std::move(job)});
    bytes_ += bytes;
  }
  changed_.notify_all();
}

void Writer::wait_for_room(std::size_t bytes) {
  std::unique_lock lock(mutex_);
  wait_for_room(lock, bytes);
}

void Writer::wait_for_room(std::unique_lock<std::mutex>& lock, std::size_t bytes) {
  changed_.wait(lock, [&] { return failure_ || bytes_ == 0 || bytes_ + bytes <= max_bytes_; });
  if (failure_) std::rethrow_exception(failure_);
}

void Writer::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return failure_ || (waiting_.empty() && !busy_); });
  if (failure_) std::rethrow_exception(failure_);
}

void Writer::loop() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
      job.work();
    } catch (...) {
      failure = std::current_exception();
    }
    job.work = nullptr;  // gives back what it held
    lock.lock();
    busy_ = false;
    bytes_ -= job.bytes;
    if (failure) {
      failure_ = std::move(failure);
      waiting_.clear();
    }
    lock.unlock();
    changed_.notify_all();
    lock.lock();
    if (failure_) return;
  }
}

}  // namespace slipfront::threads
