// SPDX-License-Identifier: BSD-3-Clause
#include "threads/team.hpp"

#include <algorithm>
#include <system_error>

#include "base/error.hpp"

namespace slipfront::threads {

int Team::processors() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

Team::Team(int threads) {
  try {
    for (int part = 1; part < threads; ++part)
      others_.emplace_back([this, part] {
        all_started_.wait();
        while (true) {
          barrier_->arrive_and_wait();
          if (work_ == nullptr) return;
          (*work_)(part);
          barrier_->arrive_and_wait();
        }
      });
  } catch (const std::system_error&) {
    // No more threads to be had: those that are there do the work.
  }
  size_ = static_cast<int>(others_.size()) + 1;
  barrier_ = std::make_unique<std::barrier<>>(size_);
  all_started_.count_down();
}

Team::~Team() {
  work_ = nullptr;
  if (size_ > 1) barrier_->arrive_and_wait();
}

void Team::run(int parts, const std::function<void(int)>& work) {
  SLIPFRONT_ASSERT(parts == 1 || parts == size_, "parts of a team's work");
  if (parts == 1) {
    work(0);
    return;
  }
  work_ = &work;
  barrier_->arrive_and_wait();
  work(0);
  barrier_->arrive_and_wait();
}

}  // namespace slipfront::threads
