// SPDX-License-Identifier: BSD-3-Clause
#include "run/batch.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"
#include "fronts/front.hpp"
#include "input/schema.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/histories.hpp"
#include "python/watcher.hpp"
#include "results/folder.hpp"
#include "run/checkpoint.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;
namespace fs = std::filesystem;
using results::ResultFolder;

/// Velocities of the plate.
struct Velocities {
  double time_s = 0;
  std::vector<double> x_m_per_s, y_m_per_s;  ///< [nodes]
};

/// What a case has come to, without its history.
struct BatchEvent {
  motion::EventEnd end = motion::EventEnd::end_time;
  std::string reason;
  solid::WaveSpeeds speeds;
  std::vector<fronts::Front> fronts;
  record::StaticState tractions;
  double inside_from_m = 0, inside_to_m = 0, peak_x_m = 0, critical_shear_m = 0;
  double ramp_critical_shear_m = nan;  ///< NaN where there was no ramp
  std::size_t ramp_onsets = 0;
  std::vector<double> onset_x_m = {}, onset_s = {};  ///< [onsets]
  double trigger_work_J_per_m = nan;                 ///< NaN without energies
  std::vector<double> node_x_m = {}, node_y_m = {};  ///< of the plate, of a case with snapshots
  std::vector<Velocities> snapshots = {};
};

BatchEvent event_of(const run::Result& result, const InitialState& initial) {
  const auto& before = initial.subcritical;
  BatchEvent e{.end = result.event.end,
               .reason = result.event.reason,
               .speeds = result.speeds,
               .fronts = result.fronts,
               .tractions = before.tractions,
               .inside_from_m = before.inside_from_m,
               .inside_to_m = before.inside_to_m,
               .peak_x_m = before.peak_x_m,
               .critical_shear_m = initial.critical_shear_m};
  if (initial.ramp) {
    e.ramp_critical_shear_m = initial.ramp->supercritical.shear_m;
    e.ramp_onsets = initial.ramp->record.n_onsets();
  }
  for (const auto& onset : result.event.record.onsets) {
    e.onset_x_m.push_back(result.event.record.x_m[onset.node]);
    e.onset_s.push_back(onset.time_s);
  }
  if (!result.event.energies.empty()) e.trigger_work_J_per_m = result.event.energies.back().trigger_work;
  const auto kept = result.rows.find(results::snapshot_output.file);
  if (kept == result.rows.end()) return e;
  e.node_x_m = initial.mesh.x_m;
  e.node_y_m = initial.mesh.y_m;
  const auto n = static_cast<std::ptrdiff_t>(e.node_x_m.size()), n_all = std::ptrdiff_t{initial.n_nodes};
  const auto& rows = kept->second.values;
  for (auto row = rows.begin(); row != rows.end(); row += 1 + motion::n_motion_components * n_all) {
    const auto of_plate = [&](motion::MotionComponent component) {
      const auto first = row + 1 + static_cast<int>(component) * n_all;
      return std::vector(first, first + n);
    };
    e.snapshots.push_back(
        {*row, of_plate(motion::MotionComponent::v_x), of_plate(motion::MotionComponent::v_y)});
  }
  return e;
}

/// Where the interface is in contact, inside and at its largest t/p, as the statics would tell.
void find_contact(const record::StaticState& state, double edge_margin_m, InitialState& initial) {
  auto& before = initial.subcritical;
  const auto in_contact = [](double p_Pa) { return p_Pa > 0; };
  const auto first = std::ranges::find_if(state.p_s_Pa, in_contact);
  require(first != state.p_s_Pa.end(), "p_s_Pa is nowhere above 0: nothing is in contact");
  const auto last = std::find_if(state.p_s_Pa.rbegin(), state.p_s_Pa.rend(), in_contact);
  before.inside_from_m = state.x_m[first - state.p_s_Pa.begin()] + edge_margin_m;
  before.inside_to_m = state.x_m[state.p_s_Pa.rend() - last - 1] - edge_margin_m;
  before.peak_ratio = -infinity;
  for (std::size_t k = 0; k < state.x_m.size(); ++k) {
    const double ratio = state.t_s_Pa[k] / state.p_s_Pa[k];
    if (!before.is_inside(state.x_m[k]) || !(state.p_s_Pa[k] > 0) || !(ratio > before.peak_ratio)) continue;
    before.peak_ratio = ratio;
    before.peak_x_m = state.x_m[k];
  }
  require(std::isfinite(before.peak_ratio), "t_s_Pa/p_s_Pa is defined nowhere inside the interface");
}

/// An event from a user's arrays instead of a run.
BatchEvent event_of_history(const input::CaseFile& given, const Values& time_s, const Values& x_m,
                            const Rows& slip_rate_m_per_s, const Rows& t_Pa, const Rows& p_Pa,
                            const Values& t_s_Pa, const Values& p_s_Pa, double threshold_m_per_s,
                            double critical_shear_m) {
  const auto problem = problem::make_problem(given.config());
  const auto history = to_history(time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa);
  InitialState initial;
  initial.subcritical.tractions = to_state(x_m, t_s_Pa, p_s_Pa);
  initial.critical_shear_m = critical_shear_m;
  find_contact(initial.subcritical.tractions, problem.loading.edge_margin_m, initial);
  run::Result result;
  result.speeds = solid::wave_speeds(problem.above().material);
  const auto options = run::front_options(problem, initial);
  result.event.record = to_record(history, threshold_m_per_s, options.l_star_m);
  result.fronts = fronts::find_fronts(result.event.record, initial.subcritical.tractions, options);
  return event_of(result, initial);
}

/// Whether a run's folder is complete and as it was written.
bool is_written(const fs::path& dir) {
  try {
    files::require_intact(dir);
    return files::is_there(dir / files::checksum_list);
  } catch (const UserError&) {
    return false;
  }
}

void write_run(const fs::path& dir, const run::Result& result, const InitialState& initial) {
  static std::mutex mutex;  // HDF5 need not be built for several threads
  const std::lock_guard lock(mutex);
  results::remove_tree(dir);  // what an interruption has left
  files::make_folders(dir);
  run::write(dir, result, initial);
}

/// Cases that run side by side, and call Python as each is done.
class Batch {
 public:
  Batch(int threads, const std::optional<fs::path>& kept)
      : batch_(
            threads, [this] { return !watcher_->is_stopped(); },
            "interrupted; completed runs are saved: repeat the command to continue", kept.value_or("")) {}

  void run(const std::vector<const input::CaseFile*>& cases,
           const std::vector<std::optional<fs::path>>& folders, const nb::callable& done) {
    require(folders.size() == cases.size(), "a folder, or None, for each case");
    std::vector<Problem> problems;
    for (const auto* given : cases) problems.push_back(problem::make_problem(given->config()));
    Watcher watcher{nb::none()};
    watcher_ = &watcher;
    const nb::gil_scoped_release unlocked;
    try {
      batch_.run(
          problems,
          [&](std::size_t k, const run::Result& result, const InitialState& initial, bool was_kept) {
            if (folders[k] && !was_kept) write_run(*folders[k], result, initial);
            auto event = event_of(result, initial);
            watcher.in_python([&] { done(k, std::move(event)); });
          },
          [&](std::size_t k) {  // snapshots are not kept
            return problems[k].output.snapshot_times_s.empty() && (!folders[k] || is_written(*folders[k]));
          });
      watcher.rethrow();
    } catch (const Interrupted&) {
      watcher.rethrow();
      throw;
    }
  }

  const run::Counts& counts() const { return batch_.counts(); }

 private:
  Watcher* watcher_ = nullptr;  ///< of the call under way
  run::Batch batch_;
};

void bind_event(nb::module_& module) {
  using E = BatchEvent;
  const auto array = [](auto member) { return [member](const E& e) { return view_of(e.*member, e); }; };
  nb::class_<Velocities>(module, "Velocities", "Of a plate's nodes at a time.")
      .def_ro("time_s", &Velocities::time_s)
      .def_prop_ro("x_m_per_s", [](const Velocities& v) { return view_of(v.x_m_per_s, v); })
      .def_prop_ro("y_m_per_s", [](const Velocities& v) { return view_of(v.y_m_per_s, v); });
  nb::class_<E>(module, "BatchEvent", "What a case of a batch has come to.")
      .def_prop_ro(
          "blew_up", [](const E& e) { return e.end == motion::EventEnd::blow_up; }, "see reason")
      .def_ro("reason", &E::reason)
      .def_ro("speeds", &E::speeds, "of the plate")
      .def_ro("fronts", &E::fronts)
      .def_prop_ro(
          "x_m", [](const E& e) { return view_of(e.tractions.x_m, e); }, "of the interface [nodes]")
      .def_prop_ro(
          "t_s_Pa", [](const E& e) { return view_of(e.tractions.t_s_Pa, e); }, "before the event [nodes]")
      .def_prop_ro(
          "p_s_Pa", [](const E& e) { return view_of(e.tractions.p_s_Pa, e); }, "before the event [nodes]")
      .def_ro("inside_from_m", &E::inside_from_m, "the part of the contact that counts as inside")
      .def_ro("inside_to_m", &E::inside_to_m)
      .def_ro("peak_x_m", &E::peak_x_m, "of t_s/p_s inside")
      .def_ro("critical_shear_m", &E::critical_shear_m, "shear at which slip begins inside")
      .def_ro("ramp_critical_shear_m", &E::ramp_critical_shear_m,
              "the same by the ramp; NaN where there was none")
      .def_ro("ramp_onsets", &E::ramp_onsets, "beginnings of slip at the edges during the ramp")
      .def_prop_ro("onset_x_m", array(&E::onset_x_m), "where slip begins, in the order of time [onsets]")
      .def_prop_ro("onset_s", array(&E::onset_s), "when it does [onsets]")
      .def_ro("trigger_work_J_per_m", &E::trigger_work_J_per_m, "NaN where no energies were taken")
      .def_prop_ro("node_x_m", array(&E::node_x_m), "of the plate, of a case with snapshots [nodes]")
      .def_prop_ro("node_y_m", array(&E::node_y_m), "the same")
      .def_ro("snapshots", &E::snapshots, "those of the case; none of a run that was kept");
}

}  // namespace

void bind_batch(nb::module_& module) {
  bind_event(module);
  nb::class_<Batch>(module, "Batch", "Cases that run side by side and share their statics.")
      .def(nb::init<int, const std::optional<fs::path>&>(), "threads"_a, "kept"_a.none(),
           "kept: folder of the runs that are done.")
      .def("run", &Batch::run, "cases"_a, "folders"_a, "done"_a,
           "Runs cases, but for those that were kept; writes each into its folder, if any; calls "
           "done(k, event) as case k is done.")
      .def_prop_ro(
          "n_runs", [](const Batch& b) { return b.counts().n_runs; }, "of all calls")
      .def_prop_ro(
          "n_quiet", [](const Batch& b) { return b.counts().n_quiet; },
          "of them, those that ended before time.end_s since nothing moved");
  module.def("event_of_history", &event_of_history, "case"_a, "time_s"_a, "x_m"_a, "slip_rate_m_per_s"_a,
             "t_Pa"_a, "p_Pa"_a, "t_s_Pa"_a, "p_s_Pa"_a, "threshold_m_per_s"_a, "critical_shear_m"_a,
             "An event from a history of its interface and the tractions before it.");
  nb::class_<ResultFolder>(module, "ResultFolder",
                           "A folder of results, which come into it when they are complete.")
      .def(
          "__init__",
          [](ResultFolder* self, const fs::path& dir, const std::string& work) {
            new (self) ResultFolder(dir, work + " with " + run::program_identity());
          },
          "dir"_a, "work"_a, "work: only unfinished work of this kind is gone on with.")
      .def_prop_ro("unfinished", &ResultFolder::unfinished, "where the work goes on")
      .def_prop_ro("state", &ResultFolder::state, "what going on needs, no result")
      .def("require_empty", &ResultFolder::require_empty, "overwrite"_a, "resumes"_a)
      .def("begin_or_resume", &ResultFolder::begin_or_resume)
      .def("publish", [](ResultFolder& folder) { folder.publish(); })
      .def("abandon", &ResultFolder::abandon);
}

}  // namespace slipfront::python
