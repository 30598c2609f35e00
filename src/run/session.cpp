// SPDX-License-Identifier: BSD-3-Clause
#include "run/session.hpp"

#include <algorithm>
#include <csignal>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "base/caller.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/state.hpp"
#include "files/text.hpp"
#include "problem/source.hpp"
#include "results/results.hpp"
#include "results/stream.hpp"
#include "run/checkpoint.hpp"
#include "run/fields.hpp"
#include "run/shared_states.hpp"

namespace slipfront::run {
namespace {

/// Wall time between two looks of the outside at a run; longer where writing them takes long.
constexpr double min_report_interval_s = 2;
constexpr double report_share = 0.02;

/// Where rows go that rank 0 writes: the other ranks take part in gathering snapshots.
struct NoOutput final : motion::EventOutput {
  void sample(const record::History& /*row*/) override {}
  void snapshot(motion::TimeStepper& stepper) override { stepper.snapshot(); }
  void probe(const record::ProbeRecord& /*rows*/) override {}
};

/// A run, on every rank that shares it. Rank 0 alone has the folder, the hooks and the results.
class Session {
 public:
  /// @param folder    null on other ranks
  /// @param sessions  that were before, whose work is in the folder
  Session(results::ResultFolder* folder, const Problem& problem, const SessionOptions& options,
          const SessionHooks& hooks, int sessions)
      : folder_(folder),
        problem_(problem),
        options_(options),
        hooks_(hooks),
        processes_(*options.processes),
        execution_{.threads = options.threads.value_or(suitable_threads(problem))},
        resumed_(sessions > 0) {
    if (!is_root()) return;
    dir_ = folder->unfinished();
    checkpoints_.emplace(folder->state());
    head_ = CheckpointHead{.source = problem.source};
    head_.sessions = sessions + 1;
  }

  /// From a checkpoint, or from the beginning.
  Finished run(std::unique_ptr<Checkpoints::Checkpoint> kept);
  /// Runs beside rank 0. @param in_event  whether rank 0 has a checkpoint of the event
  void run_beside(bool in_event) {
    begin_event(nullptr, in_event);
    finish(event_->run());
  }

 private:
  /// Solved, or taken from the shared ones.
  InitialState initial_state(Checkpoints::Checkpoint* kept);
  void begin_ramp(Checkpoints::Checkpoint* kept, motion::Stepper& stepper, motion::RampRun& ramp);
  void begin_event(Checkpoints::Checkpoint* kept, bool in_event);
  void restore_event(Checkpoints::Checkpoint* kept);
  void emplace_event();
  bool is_root() const { return processes_.is_root(); }
  /// Work of rank 0, which the others wait for. @throws as Processes::from_root
  void at_root(const std::function<void()>& work) {
    processes_.from_root([&](MessageBuffer& /*to*/) { work(); });
  }
  /// Between linear solutions. @return whether the run goes on
  bool look_at_statics();
  /// Between steps. @return whether the run goes on
  bool look(const char* part, std::int64_t step, std::int64_t total, double time_s);
  void keep();
  void write_progress();
  /// Execution of the event: by default each rank has threads for its subdomain.
  motion::Execution event_execution() const {
    if (options_.threads) return execution_;
    return {.threads = std::max(1, execution_.threads / processes_.size())};
  }
  double wall_s() const { return head_.wall_s + seconds_since(event_began_); }
  /// The run's event is over: makes its results.
  Finished finish(motion::Event event);
  void write_results(const Finished& run);
  void fail(const char* status, const std::string& reason) noexcept;

  results::ResultFolder* folder_;
  std::filesystem::path dir_;
  const Problem& problem_;
  const SessionOptions& options_;
  const SessionHooks& hooks_;
  Processes& processes_;
  motion::Execution execution_;
  std::optional<Checkpoints> checkpoints_;
  CheckpointHead head_;
  Clock::time_point event_began_ = Clock::now(), kept_ = Clock::now(), reported_ = Clock::now();
  bool resumed_;
  bool began_ = false;  ///< before that a new run has nothing to keep
  double kept_time_s_ = 0, report_interval_s_ = min_report_interval_s;

  InitialState initial_;
  RuptureOutlook rupture_;                  ///< of it
  motion::TimeStepper* stepper_ = nullptr;  ///< of the ramp or of the event
  motion::RampRun* ramp_ = nullptr;
  std::unique_ptr<motion::TimeStepper> event_stepper_;
  std::optional<motion::EventRun> event_;
  std::optional<results::ResultStream> stream_;
  NoOutput no_output_;
};

/// Reads from a checkpoint, which is rank 0's. @throws UserError naming its file
template <class Read>
void read_from(Checkpoints::Checkpoint* kept, Read&& read) {
  try {
    read();
  } catch (const StateError& error) {
    if (kept == nullptr) throw;
    throw UserError("{}: {}; start a new run", kept->body.path().string(), error.what());
  }
}

Finished Session::run(std::unique_ptr<Checkpoints::Checkpoint> kept) {
  try {
    if (kept) head_.wall_s = kept->head.wall_s;
    write_status(dir_, problem_, {"running", "before the event", head_.sessions});
    begin_event(kept.get(), kept && kept->head.in_event);
    kept.reset();
    return finish(event_->run());
  } catch (const Interrupted& error) {
    fail("interrupted", error.what());
    if (!began_) throw;
    throw Interrupted(fmt::format("{}; {}", error.what(), how_to_resume(*folder_)));
  } catch (const BlowUp& error) {
    fail("blew_up", error.what());
    throw;
  } catch (const std::exception& error) {
    if (began_ || resumed_)
      fail("failed", error.what());
    else
      folder_->abandon();
    throw;
  }
}

void Session::fail(const char* status, const std::string& reason) noexcept {
  try {
    if (stream_) stream_->hand_over();
    write_status(dir_, problem_, {status, reason, head_.sessions});
  } catch (...) {
    // What made the run fail may also keep its reason from being written.
  }
}

InitialState Session::initial_state(Checkpoints::Checkpoint* kept) {
  if (options_.initial_state) return options_.initial_state();
  std::optional<SharedStates> shared;
  if (options_.shared_states) shared.emplace(*options_.shared_states);
  if (shared)
    if (auto taken = shared->take(problem_, hooks_.note)) return std::move(*taken);
  auto initial = make_initial_state(
      problem_,
      [&](std::int64_t step, std::int64_t total) {
        return stepper_ == nullptr ? look_at_statics() : look("ramp", step, total, stepper_->time_s());
      },
      execution_, [&](motion::Stepper& stepper, motion::RampRun& ramp) { begin_ramp(kept, stepper, ramp); },
      processes_);
  if (shared) shared->keep(problem_, initial);
  return initial;
}

void Session::begin_ramp(Checkpoints::Checkpoint* kept, motion::Stepper& stepper, motion::RampRun& ramp) {
  if (kept != nullptr) {
    read_from(kept, [&] {
      read_motion(&kept->body, stepper, {});
      kept->body(ramp);
      kept->body.close();
    });
  }
  began_ = true;
  stepper_ = &stepper;
  ramp_ = &ramp;
  kept_time_s_ = stepper.time_s();
}

void Session::begin_event(Checkpoints::Checkpoint* kept, bool in_event) {
  if (in_event) {
    restore_event(kept);
  } else {
    at_root([&] {
      initial_ = initial_state(kept);
      ramp_ = nullptr;
      stepper_ = nullptr;
      if (hooks_.request() == Request::stop) throw Interrupted("interrupted before the event");
    });
    event_stepper_ = start_event(problem_, initial_, event_execution(), processes_);
    at_root([&] { stream_.emplace(dir_, run_files(problem_, initial_, event_stepper_->step_s())); });
    emplace_event();
  }
  at_root([&] {
    rupture_ = rupture_outlook(problem_, initial_.subcritical, initial_.tributary_m, initial_.healed);
  });
  stepper_ = event_stepper_.get();
  kept_time_s_ = stepper_->time_s();
  event_began_ = kept_ = Clock::now();
  at_root([&] { write_static(dir_, problem_, initial_); });
  began_ = true;
  write_progress();
}

void Session::restore_event(Checkpoints::Checkpoint* kept) {
  const auto with_file = [&](const std::function<void()>& read) { at_root([&] { read_from(kept, read); }); };
  with_file([&] { initial_ = read_initial_state(kept->body, problem_, processes_); });
  const auto loads = from_root(processes_, [&] { return loads_of_event(problem_, initial_); });
  event_stepper_ = make_stepper(problem_, initial_, event_execution(), processes_);
  read_from(kept, [&] { read_motion(kept ? &kept->body : nullptr, *event_stepper_, loads); });
  with_file([&] {
    results::ResultStream::Extents extents;
    kept->body(extents);
    stream_.emplace(dir_, run_files(problem_, initial_, event_stepper_->step_s()), extents);
  });
  emplace_event();
  auto of_event = processes_.from_root([&](MessageBuffer& to) {
    read_from(kept, [&] {
      kept->body(*event_);
      kept->body.close();
    });
    if (processes_.size() > 1) to.append(packed(*event_));  // as large as the record of slip
  });
  if (!is_root()) MessageArchive::reader(of_event)(*event_);
  read_from(kept, [&] { processes_.together([&] { event_->require_restored(); }); });
}

void Session::emplace_event() {
  event_.emplace(run::begin_event(
      problem_, initial_, *event_stepper_,
      [&](std::int64_t step, std::int64_t total) { return look("event", step, total, stepper_->time_s()); },
      is_root() ? static_cast<motion::EventOutput*>(&*stream_) : &no_output_,
      options_.observers ? options_.observers() : motion::Observers{}));
}

bool Session::look_at_statics() {
  const Request request = hooks_.request();
  if (request == Request::keep) hooks_.note("no checkpoint: there is nothing to save before the first step");
  return request != Request::stop;
}

bool Session::look(const char* part, std::int64_t step, std::int64_t total, double time_s) {
  struct Wanted {
    Request request = Request::none;
    bool checkpoint = false, report = false;
  } wanted;
  if (is_root()) {
    hooks_.progress(part, step, total);
    wanted.request = hooks_.request();
    wanted.checkpoint = wanted.request != Request::none ||
                        seconds_since(kept_) >= options_.keep_every_wall_s ||
                        time_s - kept_time_s_ >= options_.keep_every_s;
    wanted.report = event_ && seconds_since(reported_) >= report_interval_s_;
  }
  if (event_) wanted = unpacked<Wanted>(processes_.broadcast(packed(wanted)));
  if (wanted.checkpoint) keep();
  if (wanted.request == Request::keep && is_root())
    hooks_.note(fmt::format("checkpoint at t = {:.6g} s of the {}", time_s, part));
  if (wanted.report) write_progress();
  return wanted.request != Request::stop;
}

void Session::keep() {
  if (!is_root()) return stepper_->keep({});
  auto head = head_;
  head.in_event = event_.has_value();
  if (head.in_event) head.wall_s = wall_s();
  // The streams first: a checkpoint must not count on rows that are not there yet.
  auto extents = stream_ ? stream_->keep() : results::ResultStream::Extents{};
  checkpoints_->keep(head, [&](results::OutputArchive& archive) {
    if (head.in_event) archive(initial_);
    write_motion(archive, *stepper_);
    if (head.in_event)
      archive(extents, *event_);
    else
      archive(*ramp_);
  });
  kept_ = Clock::now();
  kept_time_s_ = stepper_->time_s();
}

void Session::write_progress() {
  const auto start = Clock::now();
  auto breakdown = stepper_->breakdown();
  if (!is_root()) {
    collect(problem_, *stepper_, {});
    return;
  }
  motion::Event so_far;
  so_far.steps = stepper_->step();
  so_far.time_s = stepper_->time_s();
  const auto& energies = event_->energies();
  so_far.energies = {energies.front(), energies.back()};
  so_far.record = event_->record();
  so_far.breakdown = std::move(breakdown);
  so_far.tip_slip = event_->tip_slip();
  auto result = collect(problem_, *stepper_, std::move(so_far));
  stream_->hand_over();
  result.stepping_wall_s = wall_s();
  analyse(result, initial_, rupture_);
  write_so_far(dir_, result, energies, initial_, {"running", "", head_.sessions});
  reported_ = Clock::now();
  report_interval_s_ = std::max(min_report_interval_s, seconds_since(start) / report_share);
}

Finished Session::finish(motion::Event event) {
  Finished run{collect(problem_, *stepper_, std::move(event)), {}};
  run.result.stepping_wall_s = wall_s();
  event_.reset();
  event_stepper_.reset();
  run.initial = std::move(initial_);
  at_root([&] {
    analyse(run.result, run.initial, rupture_);
    write_results(run);
  });
  write_fields(folder_, problem_, processes_, hooks_.note);
  at_root([&] {
    if (status_of(run.result).name == "complete") folder_->publish();
  });
  return run;
}

void Session::write_results(const Finished& run) {
  auto status = status_of(run.result);
  status.sessions = head_.sessions;
  // As they are, whatever has happened to the files meanwhile.
  problem::write_case(dir_, problem_.source);
  write_static(dir_, problem_, run.initial);
  // What takes no time first: the program may be given none after an interruption.
  write_so_far(dir_, run.result, run.result.event.energies, run.initial, status);
  stream_->finish(numbers_of(status));
  stream_.reset();
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

/// On rank 0, with the others in serve_ranks.
Finished run_shared(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                    const SessionHooks& hooks, int sessions, std::unique_ptr<Checkpoints::Checkpoint> kept) {
  Session session(&folder, problem, options, hooks, sessions);
  auto message = packed(true, kept && kept->head.in_event);
  problem::pack_case(problem, message);
  options.processes->broadcast(std::move(message));
  options.processes->set_awaited(true);
  auto finished = session.run(std::move(kept));
  options.processes->set_awaited(false);
  return finished;
}

void require_room(const results::ResultFolder& folder, const Problem& problem) {
  folder.require_room(problem.is_sequence() ? problem.sequence.max_events : 0);
}

}  // namespace

int suitable_threads(const Problem& problem) {
  constexpr double nodes_per_thread = 20'000;
  constexpr unsigned max_threads = 4;
  const double useful = mesh_size(problem).n_nodes / nodes_per_thread;
  const double most = std::clamp(std::thread::hardware_concurrency(), 1U, max_threads);
  return static_cast<int>(std::clamp(useful, 1.0, most));
}

void begin_work(results::ResultFolder& folder, const Problem& problem) {
  require_room(folder, problem);
  try {
    folder.begin();
    problem::write_case(folder.unfinished(), problem.source);
    Checkpoints(folder.state()).begin(CheckpointHead{.source = problem.source});
  } catch (const WriteError&) {
    folder.abandon();
    throw;
  }
}

Finished run_into(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                  const SessionHooks& hooks) {
  begin_work(folder, problem);
  return run_shared(folder, problem, options, hooks, 0, {});
}

Finished resume(results::ResultFolder& folder, const Problem* expected, const SessionOptions& options,
                const SessionHooks& hooks) {
  auto [problem, kept, sessions] = load_unfinished(folder, expected, hooks.note);
  return run_shared(folder, problem, options, hooks, sessions, std::move(kept));
}

Problem unfinished_case(const results::ResultFolder& folder, const Problem* expected) {
  const auto file = folder.unfinished() / problem::case_file;
  if (!folder.has_unfinished() || !files::is_there(file))
    throw UserError("{}: holds no unfinished run to continue", folder.dir().string());
  auto problem = problem::read_problem(folder.unfinished());
  if (expected != nullptr) require_same_case(expected->source, problem.source);
  return problem;
}

UnfinishedWork load_unfinished(const results::ResultFolder& folder, const Problem* expected,
                               const std::function<void(const std::string&)>& note) {
  UnfinishedWork work{unfinished_case(folder, expected), Checkpoints(folder.state()).last(note)};
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

void serve_ranks(Processes& processes) {
  // What a signal asks for is rank 0's to hear.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ, SIGPIPE, SIGUSR1})
    std::signal(signal, SIG_IGN);
  for (;;) try {
      auto message = processes.broadcast({});
      if (!unpacked<bool>(message)) return;
      const bool in_event = unpacked<bool>(message);
      const auto problem = problem::unpack_case(message);
      SessionOptions options;
      options.processes = &processes;
      Session(nullptr, problem, options, {}, 0).run_beside(in_event);
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

namespace {

/// Whether all files are there that a folder's list of checksums names, and those of the lists among them.
bool has_all(const std::filesystem::path& dir) {
  const auto sums = files::read_checksums(dir);
  return !sums.empty() && std::ranges::all_of(sums, [&](const auto& named) {
    const auto file = dir / named.first;
    if (!files::is_there(file)) return false;
    return file.filename() != files::checksum_list || has_all(file.parent_path());
  });
}

}  // namespace

bool is_complete(const std::filesystem::path& dir) {
  const auto is_there = [&](const char* name) { return files::is_there(dir / name); };
  if (is_there(sequence_file)) return has_all(dir);
  return is_there(files::checksum_list) && is_there("run.json") && is_there(results::history_file);
}

}  // namespace slipfront::run
