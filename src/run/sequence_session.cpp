// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence_session.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"
#include "results/stream.hpp"
#include "run/checkpoint.hpp"
#include "run/sequence.hpp"

namespace slipfront::run {

namespace {

/// The kind of work that an event's folder holds; it is gone on with as part of its sequence.
constexpr const char* event_work = "event of a sequence";

/// A sequence on rank 0; its events are runs on all ranks.
class SequenceSession {
 public:
  SequenceSession(results::ResultFolder& folder, const input::Case& config, const SessionOptions& options,
                  const SessionHooks& hooks, const EventDone& done, int sessions)
      : folder_(folder),
        config_(config),
        hooks_(hooks),
        done_(done),
        options_(options),
        checkpoints_(folder.state()),
        resumed_(sessions > 0),
        head_(checkpoint_head(config)) {
    head_.sessions = sessions + 1;
  }

  /// From a checkpoint, or from the beginning.
  FinishedSequence run(std::unique_ptr<Checkpoints::Checkpoint> kept);

 private:
  void begin(Checkpoints::Checkpoint* kept);
  /// Refuses finished events, by their lists of checksums, and slow slip that are not as they were.
  void require_parts_unchanged() const;
  /// The next event. @return false where none begins
  bool run_event();
  UserError does_not_rest(const std::string& part, const Result& result) const;
  /// The state in which an event begins, as Sequence::next.
  const InitialState* load_to(const std::string& event);
  /// Between events.
  void keep();
  void write(const std::string& end, const Status& status);
  void fail(const char* status, const std::string& reason) noexcept;
  std::filesystem::path event_dir(std::size_t k) const {
    return results::event_folder(folder_.unfinished(), k);
  }
  std::filesystem::path slow_history(std::size_t k) const {
    return results::slow_folder(folder_.unfinished(), k) / results::history_file;
  }

  results::ResultFolder& folder_;
  const input::Case& config_;
  const SessionHooks& hooks_;
  const EventDone& done_;
  SessionOptions options_;
  Checkpoints checkpoints_;
  bool resumed_;
  CheckpointHead head_;
  std::unique_ptr<Sequence> sequence_;
  std::vector<std::string> sums_;       ///< of the lists of checksums of the events that are done
  std::vector<std::string> slow_sums_;  ///< of the histories of slow slip before them
};

FinishedSequence SequenceSession::run(std::unique_ptr<Checkpoints::Checkpoint> kept) {
  try {
    begin(kept.get());
    kept.reset();
    std::string end;
    while ((end = sequence_->end()).empty() && run_event()) {
      write("", {"running", "", head_.sessions});
      keep();
      done_(sequence_->events().size(), sequence_->events().back());
    }
    if (end.empty())
      end = fmt::format("no event begins before the loading ends, at {:g} s",
                        sequence_->loading().back().time_s);
    write_case(folder_.unfinished(), config_);
    try {
      require_parts_unchanged();
    } catch (const UserError& error) {
      throw WriteError("{}", error.what());  // while this program has the folder
    }
    write(end, {"complete", "", head_.sessions});
    folder_.publish();
    return {sequence_->events(), sequence_->loading(), end};
  } catch (const Interrupted& error) {
    fail("interrupted", error.what());
    throw Interrupted(fmt::format("{}; {}", error.what(), how_to_resume(folder_)));
  } catch (const BlowUp& error) {
    fail("blew_up", error.what());
    throw;
  } catch (const std::exception& error) {
    // A first phase that came to nothing has left no folder.
    if (resumed_ || files::is_there(event_dir(1)) || files::is_there(slow_history(1)))
      fail("failed", error.what());
    else
      folder_.abandon();
    throw;
  }
}

void SequenceSession::begin(Checkpoints::Checkpoint* kept) {
  write_sequence(folder_.unfinished(), config_, {}, {}, "", {"running", "", head_.sessions});
  sequence_ = std::make_unique<Sequence>(
      config_, [this](std::int64_t, std::int64_t) { return hooks_.request() != Request::stop; },
      *options_.processes);
  if (kept == nullptr) return;
  try {
    kept->body(sums_, slow_sums_);
    sequence_->serialize(kept->body);
    kept->body.close();
    const std::size_t n_slow = input::is_slow(config_) ? sums_.size() : 0;
    require_possible(sums_.size() == sequence_->events().size() && slow_sums_.size() == n_slow, "events");
  } catch (const StateError& error) {
    throw UserError("{}: {}; start a new run", kept->body.path().string(), error.what());
  }
  require_parts_unchanged();
  for (std::size_t k = 0; k < sums_.size(); ++k) files::require_intact(event_dir(k + 1));
}

void SequenceSession::require_parts_unchanged() const {
  const auto require_sum = [](const std::filesystem::path& file, const std::string& sum) {
    if (!files::is_there(file) || files::sha256_of_file(file) != sum)
      throw UserError("{}: was changed since it was finished; restore it, or start a new run",
                      file.parent_path().string());
  };
  for (std::size_t k = 0; k < sums_.size(); ++k)
    require_sum(event_dir(k + 1) / files::checksum_list, sums_[k]);
  for (std::size_t k = 0; k < slow_sums_.size(); ++k) require_sum(slow_history(k + 1), slow_sums_[k]);
}

bool SequenceSession::run_event() {
  const auto part = fmt::format("event {}", sequence_->events().size() + 1);
  const auto* initial = load_to(part);
  if (initial == nullptr) return false;
  auto hooks = hooks_;
  hooks.progress = [&](const char* /*part*/, std::int64_t step, std::int64_t total) {
    hooks_.progress(part.c_str(), step, total);
  };
  options_.initial_state = [initial] { return *initial; };
  const auto dir = event_dir(sequence_->events().size() + 1);
  results::ResultFolder event_folder(dir, event_work, &folder_);
  // A case file comes last of what a run begins with.
  const bool goes_on =
      event_folder.has_unfinished() && files::is_there(event_folder.unfinished() / case_file);
  const auto finished = goes_on ? resume(event_folder, nullptr, options_, hooks)
                                : run_into(event_folder, sequence_->config_of_event(), options_, hooks);
  const auto& event = finished.result.event;
  if (event.end == motion::EventEnd::interrupted)
    throw Interrupted(fmt::format("interrupted in {} at t = {:.4g} s", part, event.time_s));
  if (event.end == motion::EventEnd::blow_up)
    throw BlowUp(fmt::format("{}: {}; {}", part, event.reason, what_was_kept(folder_)));
  if (event.end != motion::EventEnd::quiet) throw does_not_rest(part, finished.result);
  sequence_->record_event(finished.result);
  sums_.push_back(files::sha256_of_file(dir / files::checksum_list));
  return true;
}

UserError SequenceSession::does_not_rest(const std::string& part, const Result& result) const {
  const auto what = fmt::format("{} has not come to rest: {}", part, end_of_event(result));
  const auto& row = result.event.interface_at_end;
  const auto sum = [](const auto& values) { return std::accumulate(values.begin(), values.end(), 0.); };
  if (std::abs(sum(row.slip_rate_m_per_s)) * result.event.time_s >= std::abs(sum(row.slip_m)))
    return config_.machine.is_rigid()
               ? UserError(
                     "{}, and slip does not slow down: the load drives it on; choose a slower one ({}), or "
                     "press harder; {}",
                     what, Key("loading.shear_speed_m_per_s"), what_was_kept(folder_))
               : UserError(
                     "{}, and slip does not slow down: the loads drive it on, as dead loads or a soft "
                     "machine do; choose others ({}, {}), or a later {}; {}",
                     what, Key("loading.shear_stiffness_Pa_per_m"), Key("loading.normal_stiffness_Pa_per_m"),
                     Key("time.end_s"), what_was_kept(folder_));
  return UserError("{}; choose a later {}, a larger {}, or edges that absorb; {}", what, Key("time.end_s"),
                   Key("material.stiffness_damping_s"), what_was_kept(folder_));
}

const InitialState* SequenceSession::load_to(const std::string& event) {
  std::optional<results::ResultStream> slow;
  // Ordinary slow slip has fewer rows.
  std::size_t n_rows = 0, told_at = 4096;
  const auto take_slow = [&](const record::History& row) {
    if (!slow) {
      const auto dir = results::slow_folder(folder_.unfinished(), sequence_->events().size() + 1);
      files::make_folders(dir);
      slow.emplace(dir, results::RunFiles{history_table(config_, row.x_m), {}});
    }
    slow->sample(row);
    if (++n_rows < told_at) return;
    told_at *= 2;
    double fastest_m_per_s = 0;
    for (const double V : row.slip_rate_m_per_s) fastest_m_per_s = std::max(fastest_m_per_s, std::abs(V));
    hooks_.note(fmt::format("slow slip before {}: {} rows to {:.6g} s, fastest node {:.3g} m/s", event,
                            n_rows, row.time_s.front(), fastest_m_per_s));
  };
  try {
    const auto* initial = sequence_->next(take_slow);
    if (slow) {
      slow->finish();
      slow_sums_.push_back(files::sha256_of_file(slow_history(slow_sums_.size() + 1)));
    }
    return initial;
  } catch (const UserError& error) {
    if (sequence_->events().empty()) throw;
    Message message(fmt::format("{} is not found: {}; {}", event, error.what(), what_was_kept(folder_)));
    message.keys = error.keys();
    throw UserError(message);
  }
}

void SequenceSession::keep() {
  checkpoints_.keep(head_, [&](results::OutputArchive& archive) {
    archive(sums_, slow_sums_);
    sequence_->serialize(archive);
  });
}

void SequenceSession::write(const std::string& end, const Status& status) {
  write_sequence(folder_.unfinished(), config_, sequence_->events(), sequence_->loading(), end, status);
}

void SequenceSession::fail(const char* status, const std::string& reason) noexcept {
  try {
    if (sequence_) write("", {status, reason, head_.sessions});
  } catch (...) {
    // What made the sequence fail may also keep its reason from being written.
  }
}

}  // namespace

FinishedSequence run_sequence_into(results::ResultFolder& folder, const input::Case& config,
                                   const SessionOptions& options, const SessionHooks& hooks,
                                   const EventDone& done) {
  begin_work(folder, config);
  return SequenceSession(folder, config, options, hooks, done, 0).run({});
}

FinishedSequence resume_sequence(results::ResultFolder& folder, const input::Case* expected,
                                 const SessionOptions& options, const SessionHooks& hooks,
                                 const EventDone& done) {
  auto [config, kept, sessions] = load_unfinished(folder, expected, hooks.note);
  return SequenceSession(folder, config, options, hooks, done, sessions).run(std::move(kept));
}

}  // namespace slipfront::run
