// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace slipfront::threads {

/// Does jobs one after the other in a separate thread while the caller goes on. The memory that waiting
/// jobs hold is bounded: where there is no room for another one, the caller waits. Used by one thread.
class Writer {
 public:
  /// @param max_bytes  that the jobs which wait or are under way may hold together; one job may hold more
  explicit Writer(std::size_t max_bytes);
  /// Waits for the job under way; those that have not begun are dropped.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Waits until there is room for the job, which holds about `bytes`.
  /// @throws what an earlier job has thrown; no job is done after that one.
  void put(std::size_t bytes, std::function<void()> job);

  /// Waits until a job of so many bytes can be put without waiting: where its data are yet to be made.
  /// @throws as put does.
  void wait_for_room(std::size_t bytes);

  /// Waits until all is done. @throws what a job has thrown.
  void finish();

 private:
  struct Job {
    std::size_t bytes = 0;
    std::function<void()> work;
  };
  void loop();
  void wait_for_room(std::unique_lock<std::mutex>& lock, std::size_t bytes);

  const std::size_t max_bytes_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> waiting_;
  bool busy_ = false;           ///< a job is under way
  std::size_t bytes_ = 0;       ///< of the jobs that wait or are under way
  std::exception_ptr failure_;  ///< of the first job that threw
  bool ended_ = false;
  std::thread thread_;  ///< none where the system gives none: put does the job itself
};

}  // namespace slipfront::threads
