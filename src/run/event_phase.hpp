// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "advice/outlook.hpp"
#include "base/clock.hpp"
#include "motion/event.hpp"
#include "results/archive.hpp"
#include "results/stream.hpp"
#include "run/run.hpp"

namespace slipfront::run {

/// What rank 0 wants of an event that pauses.
struct Wanted {
  bool checkpoint = false, report = false, stop = false;
};

/// Rank 0's part in an event.
struct EventRoot {
  std::filesystem::path dir;    ///< of its files
  std::filesystem::path state;  ///< of what going on needs
  int sessions = 1;             ///< see Status
  std::function<Wanted(std::int64_t step, std::int64_t total, double time_s)> look;  ///< asked between steps
  std::function<void()> keep;  ///< keeps a checkpoint, with EventPhase::write
  std::function<void(const std::string& note)> note;
};

/// The phase of a run in which waves run: an event on all ranks that share it, each with its subdomain. Rank
/// 0 alone has the state before it, its files and its results. Beginning and running are collective.
class EventPhase {
 public:
  /// @param root  null on the other ranks
  /// @param more  makes further observers
  EventPhase(const Problem& problem, Processes& processes, const motion::Execution& execution,
             const EventRoot* root, const std::function<motion::Observers()>& more);
  EventPhase(const EventPhase&) = delete;
  EventPhase& operator=(const EventPhase&) = delete;

  /// @param initial  on rank 0
  void begin(InitialState initial);
  /// Goes on from what `write` has kept. @param kept  null on the other ranks
  /// @throws UserError naming its file
  void restore(results::InputArchive* kept);
  /// To the end: time.end_s, rest, blow-up, interruption or an observer's.
  FinishedEvent run();
  /// Rank 0's part of a checkpoint, in EventRoot::keep.
  void write(results::OutputArchive& archive);
  /// Hands rows to their files, for those who look into them. Rank 0 alone.
  void hand_over() {
    if (stream_) stream_->hand_over();
  }

  double time_s() const { return stepper_->time_s(); }
  const InitialState& initial() const { return initial_; }

 private:
  bool is_root() const { return root_ != nullptr; }
  /// Work of rank 0, which the others wait for. @throws as Processes::from_root
  void at_root(const std::function<void()>& work) {
    processes_.from_root([&](MessageBuffer& /*to*/) { work(); });
  }
  /// Of its files of rows.
  std::vector<results::RowFormat> formats() const;
  void emplace_run();
  /// What both ways of beginning come to.
  void begin_steps();
  bool look(std::int64_t step, std::int64_t total);
  void write_progress();
  FinishedEvent finish(motion::Event event);
  double wall_s() const { return wall_before_s_ + seconds_since(began_); }

  const Problem& problem_;
  Processes& processes_;
  motion::Execution execution_;
  const EventRoot* root_;
  std::function<motion::Observers()> more_;
  Clock::time_point began_ = Clock::now(), reported_ = Clock::now();
  double wall_before_s_ = 0, report_interval_s_ = 0;

  InitialState initial_;
  advice::RuptureOutlook rupture_;  ///< of it
  std::unique_ptr<motion::TimeStepper> stepper_;
  std::optional<motion::EventRun> run_;
  std::optional<results::ResultStream> stream_;
};

}  // namespace slipfront::run
