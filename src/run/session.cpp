// SPDX-License-Identifier: BSD-3-Clause
#include "run/session.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

#include "advice/needs.hpp"
#include "advice/notes.hpp"
#include "base/caller.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/state.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"
#include "files/text.hpp"
#include "problem/source.hpp"
#include "results/rows.hpp"
#include "results/stream.hpp"
#include "results/table.hpp"
#include "run/checkpoint.hpp"
#include "run/event_phase.hpp"
#include "run/sequence.hpp"
#include "run/shared_states.hpp"
#include "setup/event.hpp"
#include "setup/outputs.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;

/// A run on rank 0, from phase to phase. It keeps checkpoints between two of them, in ramps, slow slip and
/// events.
class Session {
 public:
  /// @param sessions  that were before, whose work is in the folder
  Session(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
          const SessionHooks& hooks, int sessions)
      : folder_(folder),
        dir_(folder.unfinished()),
        problem_(problem),
        options_(options),
        hooks_(hooks),
        processes_(*options.processes),
        execution_{.threads = options.threads.value_or(suitable_threads(problem))},
        checkpoints_(folder.state()),
        head_{.source = problem.source, .sessions = sessions + 1},
        began_(sessions > 0) {}

  /// From a checkpoint, or from the beginning.
  Finished run(std::unique_ptr<Checkpoints::Checkpoint> kept);
  /// From where the sequence has ended that is complete in the folder.
  Finished extend();

 private:
  void begin(Checkpoints::Checkpoint* kept);
  /// From phase to phase, to the end.
  Finished go_on(std::unique_ptr<Checkpoints::Checkpoint> kept);
  void read_sequence(results::InputArchive& kept, bool in_event);
  /// Work with what to keep of it where it fails.
  Finished keeping_failures(const std::function<Finished()>& work);
  /// The next event, under way. @return false where none begins
  bool begin_event(Checkpoints::Checkpoint* kept);
  /// An event on all ranks. @param in_event  whether it goes on from a checkpoint
  void emplace_event(bool in_event);
  /// What an event has come to. @return whether the run goes on to another one
  bool take(const FinishedEvent& event);

  /// The state of a single event: solved, or taken from the shared ones.
  InitialState first_state(Checkpoints::Checkpoint* kept);
  void begin_ramp(Checkpoints::Checkpoint* kept, motion::Stepper& stepper, motion::RampRun& ramp);
  /// That in which the next event of a sequence begins, as Sequence::next.
  const InitialState* next_state();
  UserError does_not_rest(const Result& result) const;
  /// Refuses finished events, by their lists of checksums, and slow slip that are not as they were.
  void require_parts_unchanged() const;

  /// Between linear solutions. @return whether the run goes on
  bool look_at_statics();
  /// Between steps of a ramp or an event.
  Wanted look(std::int64_t step, std::int64_t total, double time_s);
  void keep();
  void write_status(const Status& status, const std::string& end = "");
  void fail(const char* status, const std::string& reason) noexcept;

  /// By default each rank has threads for its subdomain.
  motion::Execution execution_of_event() const {
    if (options_.threads) return execution_;
    return {.threads = std::max(1, execution_.threads / processes_.size())};
  }
  /// Its name in messages.
  std::string part() const { return sequence_ ? fmt::format("event {}", number()) : "event"; }
  /// Of the event that comes next or is under way, from 1.
  std::size_t number() const { return sequence_->events().size() + 1; }
  /// On the sequence so far.
  Diagnostics notes() const {
    auto all = notes_of_case_;
    all.add(notes_of_sequence(problem_, sequence_->events()));
    return all;
  }
  fs::path slow_dir() const { return results::slow_folder(dir_, number()); }
  std::vector<results::RowFormat> slow_files() const {
    auto slow = setup::output_setup(problem_, 0, 0, 0);
    slow.x_m = sequence_->x_m();
    return {results::history_output.format(slow)};
  }
  fs::path event_dir() const { return sequence_ ? results::event_folder(dir_, number()) : dir_; }
  /// Where a finished event is, or the slow slip before it: with the sequence that this one extends perhaps.
  fs::path done(fs::path (*folder_of)(const fs::path&, std::size_t), std::size_t k) const {
    const auto own = folder_of(dir_, k);
    return files::is_folder(own) || !extends_ ? own : folder_of(folder_.dir(), k);
  }

  results::ResultFolder& folder_;
  fs::path dir_;
  const Problem& problem_;
  const SessionOptions& options_;
  const SessionHooks& hooks_;
  Processes& processes_;
  motion::Execution execution_;
  Checkpoints checkpoints_;
  CheckpointHead head_;
  bool began_;  ///< before that a new run has nothing to keep
  Clock::time_point kept_ = Clock::now();
  double kept_time_s_ = 0;
  std::string keeps_;  ///< note of a checkpoint that was asked for

  std::optional<Sequence> sequence_;
  Diagnostics notes_of_case_;                  ///< of a sequence
  bool extends_ = false;                       ///< a sequence that is complete in the folder
  std::vector<std::string> sums_;              ///< of the lists of checksums of the events that are done
  std::vector<std::string> slow_sums_;         ///< of the histories of slow slip before them
  std::optional<results::ResultStream> slow_;  ///< of the slow slip under way
  motion::Stepper* ramp_stepper_ = nullptr;
  motion::RampRun* ramp_ = nullptr;  ///< under way
  EventRoot root_;
  std::optional<EventPhase> event_;  ///< under way
};

Finished Session::run(std::unique_ptr<Checkpoints::Checkpoint> kept) {
  return keeping_failures([&] {
    begin(kept.get());
    return go_on(std::move(kept));
  });
}

Finished Session::extend() {
  began_ = false;
  return keeping_failures([&] {
    begin(nullptr);
    results::InputArchive archive(folder_.dir() / end_file);
    read_sequence(archive, false);
    keep();
    began_ = true;
    return go_on({});
  });
}

Finished Session::go_on(std::unique_ptr<Checkpoints::Checkpoint> kept) {
  Finished finished;
  while (event_ || begin_event(kept.get())) {
    kept.reset();
    finished.last = event_->run();
    processes_.set_awaited(false);
    event_.reset();
    if (!take(finished.last)) break;
  }
  if (!sequence_) {
    if (status_of(finished.last.result).name == "complete") folder_.publish();
    return finished;
  }
  finished.events = sequence_->events();
  finished.loading = sequence_->loading();
  finished.notes = notes();
  finished.end = sequence_->end();
  if (finished.end.empty())
    finished.end =
        fmt::format("no event begins before the loading ends, at {:g} s", finished.loading.back().time_s);
  problem::write_case(dir_, problem_.source);
  try {
    require_parts_unchanged();
  } catch (const UserError& error) {
    throw WriteError("{}", error.what());  // while this program has the folder
  }
  write_status({"complete", "", head_.sessions}, finished.end);
  results::OutputArchive archive(dir_ / end_file);
  archive(sums_, slow_sums_);
  sequence_->serialize(archive);
  archive.close();
  folder_.publish(extends_);
  return finished;
}

Finished Session::keeping_failures(const std::function<Finished()>& work) {
  try {
    return work();
  } catch (const Interrupted& error) {
    fail("interrupted", error.what());
    if (!began_ && !sequence_) throw;
    throw Interrupted(fmt::format("{}; {}", error.what(), how_to_resume(folder_)));
  } catch (const BlowUp& error) {
    fail("blew_up", error.what());
    throw;
  } catch (const std::exception& error) {
    if (began_)
      fail("failed", error.what());
    else
      folder_.abandon();
    throw;
  }
}

void Session::begin(Checkpoints::Checkpoint* kept) {
  advice::require_memory_fits(problem_, processes_);
  write_status({"running", "before the event", head_.sessions});
  if (problem_.is_sequence()) {
    notes_of_case_ = advice::notes_of_case(problem_, processes_);
    sequence_.emplace(
        problem_, [this](std::int64_t, std::int64_t) { return look_at_statics(); }, processes_);
  }
  if (kept == nullptr) return;
  if (sequence_) read_sequence(kept->body, kept->head.in_event);
  if (!kept->head.in_event) return;
  emplace_event(true);
  event_->restore(&kept->body);
  if (sequence_) sequence_->resume_event(event_->initial());
  kept_time_s_ = event_->time_s();
}

void Session::read_sequence(results::InputArchive& kept, bool in_event) {
  read_from(&kept, [&] {
    kept(sums_, slow_sums_);
    sequence_->serialize(kept);
    const std::size_t n_slow = problem_.is_slow() ? sums_.size() + (in_event ? 1 : 0) : 0;
    require_possible(sums_.size() == sequence_->events().size() && slow_sums_.size() >= n_slow &&
                         sequence_->is_in_event() == in_event,
                     "events");
    slow_sums_.resize(n_slow);
    if (sequence_->is_creeping()) {
      results::ResultStream::Extents extents;
      kept(extents);
      slow_.emplace(slow_dir(), slow_files(), extents);
    }
    if (!in_event) kept.close();
  });
  extends_ = !sums_.empty() && !files::is_folder(results::event_folder(dir_, 1));
  require_parts_unchanged();
  for (std::size_t k = 0; k < sums_.size(); ++k) files::require_intact(done(results::event_folder, k + 1));
}

bool Session::begin_event(Checkpoints::Checkpoint* kept) {
  InitialState initial;
  if (sequence_) {
    if (!sequence_->end().empty()) return false;
    const auto* next = next_state();
    if (next == nullptr) return false;
    initial = *next;
    results::remove_tree(event_dir());  // what a session that was killed has left
    files::make_folders(event_dir());
    problem::write_case(event_dir(), problem_.source);
  } else {
    initial = first_state(kept);
    ramp_ = nullptr;
  }
  if (hooks_.request() == Request::stop) throw Interrupted("interrupted before the event");
  emplace_event(false);
  event_->begin(std::move(initial));
  began_ = true;
  kept_ = Clock::now();
  kept_time_s_ = 0;
  return true;
}

void Session::emplace_event(bool in_event) {
  auto message = packed(true, in_event);
  problem::pack_case(problem_, message);
  processes_.broadcast(std::move(message));
  processes_.set_awaited(true);
  root_ = {event_dir(),
           folder_.state(),
           head_.sessions,
           [this](std::int64_t step, std::int64_t total, double time_s) { return look(step, total, time_s); },
           [this] { keep(); },
           hooks_.note};
  event_.emplace(problem_, processes_, execution_of_event(), &root_, options_.observers);
}

bool Session::take(const FinishedEvent& event) {
  if (!sequence_) return false;
  const auto& [end, reason] = std::tie(event.result.event.end, event.result.event.reason);
  if (end == motion::EventEnd::interrupted)
    throw Interrupted(fmt::format("interrupted in {} at t = {:.4g} s", part(), event.result.event.time_s));
  if (end == motion::EventEnd::blow_up)
    throw BlowUp(fmt::format("{}: {}; {}", part(), reason, what_was_kept(folder_)));
  if (end != motion::EventEnd::quiet) throw does_not_rest(event.result);
  results::seal(event_dir());
  sums_.push_back(files::sha256_of_file(event_dir() / files::checksum_list));
  sequence_->record_event(event.result);
  write_status({"running", "", head_.sessions});
  keep();
  if (hooks_.event_done) hooks_.event_done(sums_.size(), sequence_->events().back());
  return true;
}

InitialState Session::first_state(Checkpoints::Checkpoint* kept) {
  std::optional<SharedStates> shared;
  if (options_.shared_states) shared.emplace(*options_.shared_states);
  if (shared)
    if (auto taken = shared->take(problem_, hooks_.note)) return std::move(*taken);
  auto initial = setup::make_initial_state(
      problem_,
      [&](std::int64_t step, std::int64_t total) {
        if (ramp_ == nullptr) return look_at_statics();
        const auto wanted = look(step, total, ramp_stepper_->time_s());
        if (wanted.checkpoint) keep();
        return !wanted.stop;
      },
      execution_, [&](motion::Stepper& stepper, motion::RampRun& ramp) { begin_ramp(kept, stepper, ramp); },
      processes_);
  if (shared) shared->keep(problem_, initial);
  return initial;
}

void Session::begin_ramp(Checkpoints::Checkpoint* kept, motion::Stepper& stepper, motion::RampRun& ramp) {
  if (kept != nullptr)
    read_from(&kept->body, [&] {
      read_motion(&kept->body, stepper, {});
      kept->body(ramp);
      kept->body.close();
    });
  began_ = true;
  ramp_stepper_ = &stepper;
  ramp_ = &ramp;
  kept_time_s_ = stepper.time_s();
}

const InitialState* Session::next_state() {
  const auto take_row = [&](const record::History& row) {
    if (!slow_) {
      files::make_folders(slow_dir());
      slow_.emplace(slow_dir(), slow_files());
      began_ = true;
    }
    slow_->sink(results::history_output.file).put(results::rows_of(members_of(row)));
    // Ordinary slow slip has fewer rows.
    constexpr std::size_t many = 4096;
    const auto n_rows = sequence_->n_slow_rows();
    if (n_rows < many || !std::has_single_bit(n_rows)) return;
    double fastest_m_per_s = 0;
    for (const double V : row.slip_rate_m_per_s) fastest_m_per_s = std::max(fastest_m_per_s, std::abs(V));
    hooks_.note(fmt::format("slow slip before {}: {} rows to {:.6g} s, fastest node {:.3g} m/s", part(),
                            n_rows, row.time_s.front(), fastest_m_per_s));
  };
  try {
    const auto* initial = sequence_->next(take_row);
    if (slow_) {
      slow_->finish();
      slow_.reset();
      slow_sums_.push_back(files::sha256_of_file(slow_dir() / results::history_output.file));
    }
    return initial;
  } catch (const UserError& error) {
    if (sequence_->events().empty()) throw;
    Message message(fmt::format("{} is not found: {}; {}", part(), error.what(), what_was_kept(folder_)));
    message.keys = error.keys();
    throw UserError(message);
  }
}

UserError Session::does_not_rest(const Result& result) const {
  const auto what = fmt::format("{} has not come to rest: {}", part(), end_of_event(result));
  if (result.event.end == motion::EventEnd::observer)
    return UserError("{}; {}", what, what_was_kept(folder_));
  const auto& row = result.event.interface_at_end;
  const auto sum = [](const auto& values) { return std::accumulate(values.begin(), values.end(), 0.); };
  if (std::abs(sum(row.slip_rate_m_per_s)) * result.event.time_s >= std::abs(sum(row.slip_m)))
    return problem_.above().machine.is_rigid()
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

void Session::require_parts_unchanged() const {
  const auto require_sum = [](const fs::path& file, const std::string& sum) {
    if (!files::is_there(file) || files::sha256_of_file(file) != sum)
      throw UserError("{}: was changed since it was finished; restore it, or start a new run",
                      file.parent_path().string());
  };
  for (std::size_t k = 0; k < sums_.size(); ++k)
    require_sum(done(results::event_folder, k + 1) / files::checksum_list, sums_[k]);
  for (std::size_t k = 0; k < slow_sums_.size(); ++k)
    require_sum(done(results::slow_folder, k + 1) / results::history_output.file, slow_sums_[k]);
}

bool Session::look_at_statics() {
  const Request request = hooks_.request();
  if (sequence_ && sequence_->is_creeping()) {
    if (request != Request::none || seconds_since(kept_) >= options_.keep_every_wall_s) keep();
    if (request == Request::keep) hooks_.note(fmt::format("checkpoint in the slow slip before {}", part()));
    return request != Request::stop;
  }
  if (request == Request::keep) hooks_.note("no checkpoint: there is nothing to save before the first step");
  return request != Request::stop;
}

Wanted Session::look(std::int64_t step, std::int64_t total, double time_s) {
  const auto name = ramp_ != nullptr ? "ramp" : part();
  hooks_.progress(name.c_str(), step, total);
  const auto request = hooks_.request();
  if (request == Request::keep) keeps_ = fmt::format("checkpoint at t = {:.6g} s of the {}", time_s, name);
  Wanted wanted;
  wanted.stop = request == Request::stop;
  wanted.checkpoint = request != Request::none || seconds_since(kept_) >= options_.keep_every_wall_s ||
                      time_s - kept_time_s_ >= options_.keep_every_s;
  return wanted;
}

void Session::keep() {
  head_.in_event = event_.has_value();
  checkpoints_.keep(head_, [&](results::OutputArchive& archive) {
    if (sequence_) {
      archive(sums_, slow_sums_);
      sequence_->serialize(archive);
      if (sequence_->is_creeping()) archive(slow_->keep());
    }
    if (event_) event_->write(archive);
    if (ramp_ != nullptr) {
      write_motion(archive, *ramp_stepper_);
      archive(*ramp_);
    }
  });
  kept_ = Clock::now();
  if (event_ || ramp_ != nullptr) kept_time_s_ = event_ ? event_->time_s() : ramp_stepper_->time_s();
  if (!keeps_.empty()) hooks_.note(std::exchange(keeps_, {}));
}

void Session::write_status(const Status& status, const std::string& end) {
  if (!problem_.is_sequence()) return run::write_status(dir_, problem_, status);
  if (sequence_)
    write_sequence(dir_, problem_, notes(), sequence_->events(), sequence_->loading(), end, status);
  else
    write_sequence(dir_, problem_, {}, {}, {}, end, status);
}

void Session::fail(const char* status, const std::string& reason) noexcept {
  try {
    if (event_) {
      event_->hand_over();
      run::write_status(event_dir(), problem_, {status, reason, head_.sessions});
    }
    if (!event_ || sequence_) write_status({status, reason, head_.sessions});
  } catch (...) {
    // What made the run fail may also keep its reason from being written.
  }
}

/// Refuses a case of unfinished work that is not the one that was begun.
void require_unchanged(const std::filesystem::path& dir, const problem::Source& now,
                       const problem::Source& begun) {
  require_same_keys(now, begun, (dir / problem::case_file).string());
  for (const auto& [table, name] : {std::pair{&problem::Source::prestress_table, problem::prestress_file},
                                    {&problem::Source::friction_table, problem::friction_file}})
    if (now.*table != begun.*table)
      throw UserError("{}: was changed since the run was begun; restore it, or start a new run",
                      (dir / name).string());
}

void require_room(const results::ResultFolder& folder, const Problem& problem) {
  folder.require_room(problem.is_sequence() ? problem.sequence.max_events : 0);
}

/// A file that is missing of those that a folder's list of checksums names, and of the lists among them; the
/// list itself where there is none.
std::optional<fs::path> missing_file(const fs::path& dir) {
  const auto sums = files::read_checksums(dir);
  if (sums.empty()) return dir / files::checksum_list;
  for (const auto& [name, sum] : sums) {
    const auto file = dir / name;
    if (!files::is_there(file)) return file;
    if (file.filename() != files::checksum_list) continue;
    if (auto missing = missing_file(file.parent_path())) return missing;
  }
  return {};
}

/// The problem of the work that was left unfinished in a folder. @param expected  whose case it must be, or
/// null
Problem unfinished_problem(const results::ResultFolder& folder, const Problem* expected) {
  if (!folder.has_unfinished() || !files::is_there(folder.unfinished() / problem::case_file)) {
    if (files::is_there(folder.dir() / sequence_file))
      if (const auto missing = missing_file(folder.dir()))
        throw UserError("{}: is missing; restore it, or start a new run", missing->string());
    throw UserError("{}: holds no unfinished run to continue", folder.dir().string());
  }
  auto problem = problem::read_problem(folder.unfinished());
  if (expected != nullptr) require_same_case(expected->source, problem.source);
  return problem;
}

/// The work that was left unfinished in a folder, with its last checkpoint that is intact, or null.
struct UnfinishedWork {
  Problem problem;
  std::unique_ptr<Checkpoints::Checkpoint> kept;
  int sessions = 1;  ///< so far
};

UnfinishedWork load_unfinished(const results::ResultFolder& folder, const Problem* expected,
                               const std::function<void(const std::string&)>& note) {
  UnfinishedWork work{unfinished_problem(folder, expected), Checkpoints(folder.state()).last(note)};
  const auto& problem = work.problem;
  require_room(folder, problem);
  // A session that was killed has left no checkpoint of its own, perhaps.
  for (const char* name : {run_file, sequence_file})
    work.sessions = std::max(work.sessions, sessions_of(folder.unfinished() / name));
  if (work.kept) work.sessions = std::max(work.sessions, work.kept->head.sessions);
  const auto head = work.kept ? work.kept->head : Checkpoints(folder.state()).begun();
  if (head) {
    if (head->program != program_identity())
      throw UserError("{}: was begun by {}, and this is {}; continue with that one, or start a new run",
                      folder.unfinished().string(), files::one_line(head->program), program_identity());
    require_unchanged(folder.unfinished(), problem.source, head->source);
  }
  problem::write_case(folder.unfinished(), problem.source);  // as it was, however it was written meanwhile
  return work;
}

}  // namespace

int suitable_threads(const Problem& problem) {
  constexpr double nodes_per_thread = 20'000;
  constexpr unsigned max_threads = 4;
  const double useful = advice::mesh_size(problem).n_nodes / nodes_per_thread;
  const double most = std::clamp(std::thread::hardware_concurrency(), 1U, max_threads);
  return static_cast<int>(std::clamp(useful, 1.0, most));
}

namespace {

void begin_work(results::ResultFolder& folder, const Problem& problem) {
  require_room(folder, problem);
  try {
    folder.begin();
    problem::write_case(folder.unfinished(), problem.source);
    Checkpoints(folder.state()).begin({.source = problem.source});
  } catch (const WriteError&) {
    folder.abandon();
    throw;
  }
}

/// A sequence that is complete goes on where its last event has left it.
Finished extend(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                const SessionHooks& hooks) {
  const auto& dir = folder.dir();
  if (!files::is_there(dir / end_file))
    throw UserError("{}: has no {}, from which it would go on; start a new run", dir.string(), end_file);
  const int sessions = sessions_of(dir / sequence_file);
  begin_work(folder, problem);
  return Session(folder, problem, options, hooks, sessions).extend();
}

}  // namespace

Finished run_into(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                  const SessionHooks& hooks) {
  begin_work(folder, problem);
  return Session(folder, problem, options, hooks, 0).run({});
}

Finished resume(results::ResultFolder& folder, const Problem* expected, const SessionOptions& options,
                const SessionHooks& hooks) {
  if (expected != nullptr && !folder.has_unfinished() && is_complete(folder.dir()))
    return extend(folder, *expected, options, hooks);
  auto [problem, kept, sessions] = load_unfinished(folder, expected, hooks.note);
  return Session(folder, problem, options, hooks, sessions).run(std::move(kept));
}

bool is_done(const results::ResultFolder& folder, const Problem* expected) {
  if (folder.has_unfinished() || !is_complete(folder.dir())) return false;
  if (expected == nullptr) return true;
  const auto done = problem::read_problem(folder.dir());
  if (is_continuation(*expected, done) && expected->source.case_text != done.source.case_text) return false;
  require_same_case(expected->source, done.source);
  return true;
}

void require_same_program(Processes& processes) {
  processes.gather(packed(program_identity()), [&](int rank, MessageBuffer& buffer) {
    if (const auto program = unpacked<std::string>(buffer); program != program_identity())
      throw UserError("slipfront: rank {} is {}, and rank 0 {}; start the same program everywhere", rank,
                      program, program_identity());
  });
}

void serve_ranks(Processes& processes) {
  // What a signal asks for is rank 0's to hear.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ, SIGPIPE, SIGUSR1})
    std::signal(signal, SIG_IGN);
  for (;;) try {
      auto message = processes.broadcast({});
      if (!unpacked<bool>(message)) return;
      const bool in_event = unpacked<bool>(message);
      const auto problem = problem::unpack_case(message);
      EventPhase event(problem, processes, {}, nullptr, {});
      in_event ? event.restore(nullptr) : event.begin({});
      event.run();
    } catch (const FailedElsewhere&) {
    }
}

void stop_ranks(Processes& processes) {
  processes.broadcast(packed(false));
}

std::string what_was_kept(const results::ResultFolder& folder) {
  return fmt::format("the partial results are in {}", folder.unfinished().string());
}

std::string how_to_resume(const results::ResultFolder& folder) {
  return fmt::format(
      "{}; {} continues the run", what_was_kept(folder),
      for_caller("slipfront run --restart {}", "slipfront.resume(\"{}\")", folder.dir().string()));
}

void require_came_to_end(const Result& result, const results::ResultFolder& folder) {
  const auto& event = result.event;
  if (event.end == motion::EventEnd::blow_up) throw BlowUp(event.reason + "; " + what_was_kept(folder));
  if (event.end == motion::EventEnd::interrupted)
    throw Interrupted(fmt::format("interrupted at t = {:.4g} s; {}", event.time_s, how_to_resume(folder)));
}

bool is_complete(const std::filesystem::path& dir) {
  const auto is_there = [&](const char* name) { return files::is_there(dir / name); };
  if (is_there(sequence_file)) return !missing_file(dir);
  return is_there(files::checksum_list) && is_there("run.json") && is_there(results::history_output.file);
}

}  // namespace slipfront::run
