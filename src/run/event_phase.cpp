// SPDX-License-Identifier: BSD-3-Clause
#include "run/event_phase.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "advice/outlook.hpp"
#include "base/error.hpp"
#include "base/state.hpp"
#include "problem/source.hpp"
#include "run/checkpoint.hpp"
#include "run/fields.hpp"
#include "setup/event.hpp"
#include "setup/event_loads.hpp"
#include "setup/outputs.hpp"

namespace slipfront::run {
namespace {

/// Wall time between two looks of the outside at an event; longer where writing them takes long.
constexpr double min_report_interval_s = 2;
constexpr double report_share = 0.02;

/// Where rows go that rank 0 writes: the other ranks take part in gathering them.
struct NoRows final : results::RowSink {
  void put(std::vector<double> /*values*/) override {}
};
NoRows no_rows;

}  // namespace

EventPhase::EventPhase(const Problem& problem, Processes& processes, const motion::Execution& execution,
                       const EventRoot* root, const std::function<motion::Observers()>& more)
    : problem_(problem),
      processes_(processes),
      execution_(execution),
      root_(root),
      more_(more),
      report_interval_s_(min_report_interval_s) {}

void EventPhase::begin(InitialState initial) {
  initial_ = std::move(initial);
  stepper_ = setup::start_event(problem_, initial_, execution_, processes_);
  at_root([&] { stream_.emplace(root_->dir, formats()); });
  emplace_run();
  begin_steps();
}

void EventPhase::restore(results::InputArchive* kept) {
  const auto with_file = [&](const std::function<void()>& read) { at_root([&] { read_from(kept, read); }); };
  with_file([&] {
    (*kept)(wall_before_s_);
    require_possible(wall_before_s_ >= 0 && std::isfinite(wall_before_s_), "a time");
    initial_ = read_initial_state(*kept, problem_, processes_);
  });
  const auto loads = setup::event_loads(problem_, initial_, processes_);
  stepper_ = setup::make_stepper(problem_, initial_, execution_, processes_);
  read_from(kept, [&] { read_motion(kept, *stepper_, loads); });
  with_file([&] {
    results::ResultStream::Extents extents;
    (*kept)(extents);
    stream_.emplace(root_->dir, formats(), extents);
  });
  emplace_run();
  auto of_run = processes_.from_root([&](MessageBuffer& to) {
    read_from(kept, [&] {
      (*kept)(*run_);
      kept->close();
    });
    if (processes_.size() > 1) to.append(packed(*run_));  // as large as the record of slip
  });
  if (!is_root()) MessageArchive::reader(of_run)(*run_);
  read_from(kept, [&] { processes_.together([&] { run_->require_restored(); }); });
  begin_steps();
}

std::vector<results::RowFormat> EventPhase::formats() const {
  return formats_of(setup::output_setup(problem_, initial_, stepper_->step_s()));
}

void EventPhase::emplace_run() {
  run_.emplace(setup::begin_event(
      problem_, initial_, *stepper_,
      [this](std::int64_t step, std::int64_t total) { return look(step, total); },
      [this](const results::Output& output) -> results::RowSink& {
        return is_root() ? stream_->sink(output.file) : no_rows;
      },
      more_ ? more_() : motion::Observers{}));
}

void EventPhase::begin_steps() {
  at_root([&] {
    rupture_ = advice::rupture_outlook(problem_, initial_.subcritical, initial_.tributary_m, initial_.healed);
    write_static(root_->dir, problem_, initial_);
  });
  began_ = Clock::now();
  write_progress();
}

FinishedEvent EventPhase::run() {
  return finish(run_->run());
}

bool EventPhase::look(std::int64_t step, std::int64_t total) {
  Wanted wanted;
  if (is_root()) {
    wanted = root_->look(step, total, stepper_->time_s());
    wanted.report = seconds_since(reported_) >= report_interval_s_;
  }
  wanted = unpacked<Wanted>(processes_.broadcast(packed(wanted)));
  if (wanted.checkpoint) is_root() ? root_->keep() : stepper_->keep({});
  if (wanted.report) write_progress();
  return !wanted.stop;
}

void EventPhase::write(results::OutputArchive& archive) {
  // The streams first: a checkpoint must not count on rows that are not there yet.
  auto extents = stream_->keep();
  double spent_s = wall_s();
  archive(spent_s, initial_);
  write_motion(archive, *stepper_);
  archive(extents, *run_);
}

void EventPhase::write_progress() {
  const auto start = Clock::now();
  auto breakdown = stepper_->breakdown();
  if (!is_root()) {
    collect(problem_, *stepper_, {});
    return;
  }
  motion::Event so_far;
  so_far.steps = stepper_->step();
  so_far.time_s = stepper_->time_s();
  const auto& energies = run_->energies();
  so_far.energies = {energies.front(), energies.back()};
  so_far.record = run_->record();
  so_far.breakdown = std::move(breakdown);
  so_far.tip_slip = run_->tip_slip();
  auto result = collect(problem_, *stepper_, std::move(so_far));
  stream_->hand_over();
  result.stepping_wall_s = wall_s();
  analyse(result, initial_, rupture_);
  write_so_far(root_->dir, result, energies, initial_, {"running", "", root_->sessions});
  reported_ = Clock::now();
  report_interval_s_ = std::max(min_report_interval_s, seconds_since(start) / report_share);
}

FinishedEvent EventPhase::finish(motion::Event event) {
  FinishedEvent done{collect(problem_, *stepper_, std::move(event)), {}};
  auto& result = done.result;
  result.stepping_wall_s = wall_s();
  run_.reset();
  stepper_.reset();
  done.initial = std::move(initial_);
  at_root([&] {
    analyse(result, done.initial, rupture_);
    auto status = status_of(result);
    status.sessions = root_->sessions;
    // As they are, whatever has happened to the files meanwhile.
    problem::write_case(root_->dir, problem_.source);
    write_static(root_->dir, problem_, done.initial);
    // What takes no time first: the program may be given none after an interruption.
    write_so_far(root_->dir, result, result.event.energies, done.initial, status);
    stream_->finish(numbers_of(status));
    stream_.reset();
  });
  write_fields(root_ ? root_->dir : "", root_ ? root_->state : "", problem_, processes_,
               root_ ? root_->note : nullptr);
  return done;
}

}  // namespace slipfront::run
