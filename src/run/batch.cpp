// SPDX-License-Identifier: BSD-3-Clause
#include "run/batch.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "advice/needs.hpp"
#include "base/error.hpp"
#include "setup/initial_state.hpp"

namespace slipfront::run {

namespace {

/// Calls work(k) for k in [0, n) from several threads; the first exception ends it and is thrown here.
void in_parallel(int threads, std::size_t n, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto loop = [&] {
    for (std::size_t k = next++; k < n; k = next++) {
      try {
        work(k);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = n;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (std::size_t t = 1; t < std::min(static_cast<std::size_t>(threads), n); ++t)
        others.emplace_back(loop);
    } catch (const std::system_error&) {
      // No more threads to be had: those that are there do the work.
    }
    loop();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

Batch::Batch(int threads, std::function<bool()> may_continue, std::string interruption,
             const std::filesystem::path& kept)
    : threads_(threads), may_continue_(std::move(may_continue)), interruption_(std::move(interruption)) {
  if (!kept.empty()) kept_.emplace(kept);
}

void Batch::run(std::span<const Problem> cases, const Done& done, const Usable& usable) {
  std::vector<std::size_t> missing;
  std::vector<const Problem*> missing_cases;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    Result result;
    InitialState initial;
    if (kept_ && kept_->has(cases[k]) && (!usable || usable(k)) && kept_->take(cases[k], result, initial)) {
      done(k, result, initial, true);
      counts_.add(result.event.end);
      continue;
    }
    missing.push_back(k);
    missing_cases.push_back(&cases[k]);
  }
  compute_initial_states(missing_cases);
  in_parallel(threads_, missing.size(), [&](std::size_t m) {
    const std::size_t k = missing[m];
    const auto& initial = states_.at(cases[k].source.state_key);
    const auto result = run_from(cases[k], initial, monitor());
    if (result.event.end == motion::EventEnd::interrupted) throw Interrupted(interruption_);
    done(k, result, initial, false);
    {
      const std::lock_guard lock(mutex_);
      counts_.add(result.event.end);
      if (kept_) kept_->keep(result, initial);
    }
    if (!wanted()) throw Interrupted(interruption_);
  });
}

void Batch::compute_initial_states(std::span<const Problem* const> cases) {
  std::vector<std::pair<std::string, const Problem*>> missing;
  for (const auto* problem : cases) {
    auto key = problem->source.state_key;
    if (states_.contains(key)) continue;
    states_[key] = {};
    missing.emplace_back(std::move(key), problem);
  }
  in_parallel(threads_, missing.size(), [&](std::size_t k) {
    try {
      advice::require_memory_fits(*missing[k].second);
      states_.at(missing[k].first) = setup::make_initial_state(*missing[k].second, monitor());
    } catch (const Interrupted&) {
      throw Interrupted(interruption_);
    }
  });
}

bool Batch::wanted() {
  const std::lock_guard lock(mutex_);
  interrupted_ = interrupted_ || !may_continue_();
  return !interrupted_;
}

motion::Monitor Batch::monitor() {
  return [this](std::int64_t, std::int64_t) { return wanted(); };
}

}  // namespace slipfront::run
