// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/version.hpp"
#include "cases.hpp"
#include "files/checksum.hpp"
#include "input/schema.hpp"
#include "results/results.hpp"
#include "run/session.hpp"
#include "support/files.hpp"
#include "support/results.hpp"

namespace slipfront::run {
namespace {

using nlohmann::json;
using problem::make_problem;
using test::coarse_case;
using test::go_on;

/// One run written to a folder, shared by the tests.
class WrittenRun : public testing::Test {
 protected:
  struct Shared {
    test::TemporaryFolder folder;
    input::Case config;
    InitialState initial;
    Result result;
    Shared() {
      config = coarse_case();
      config.title = "a \"written\" run";
      config.output.snapshot_times_s = {0, 10e-6, 30e-6};
      initial = setup::make_initial_state(make_problem(config), go_on);
      result = run_from(make_problem(config), initial, go_on);
      write(folder.path(), result, initial);
    }
  };
  static void SetUpTestSuite() { shared = std::make_unique<Shared>(); }
  static void TearDownTestSuite() { shared.reset(); }
  static inline std::unique_ptr<Shared> shared;

  const Shared& s = *shared;
};

std::set<std::string> names_in(const std::filesystem::path& dir) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(dir))
    names.insert(entry.path().filename().string());
  return names;
}

/// Rows of numbers under their header, each to the last bit; undefined ones are empty fields, words follow
/// numbers.
void expect_table(const std::filesystem::path& file, const std::string& header,
                  const std::vector<std::vector<double>>& rows, const std::vector<std::string>& words = {}) {
  std::istringstream stream(test::read_file(file));
  std::string line, field;
  std::getline(stream, line);
  EXPECT_EQ(line, header);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_TRUE(std::getline(stream, line)) << "row " << k;
    std::istringstream fields(line);
    for (const double value : rows[k]) {
      ASSERT_TRUE(std::getline(fields, field, ',')) << line;
      EXPECT_TRUE(std::isnan(value) ? field.empty() : std::stod(field) == value) << line;
    }
    EXPECT_EQ(static_cast<bool>(std::getline(fields, field)), !words.empty()) << line;
    if (!words.empty()) {
      EXPECT_EQ(field, words[k]);
    }
  }
  EXPECT_FALSE(std::getline(stream, line));
}

TEST_F(WrittenRun, HasTheFilesByTheirNames) {
  auto names = std::set<std::string>{"case.resolved.toml", "run.json",      "interface.h5",
                                     "fronts.csv",         "fracture.csv",  "static.csv",
                                     "energy.csv",         "fields.vtkhdf", "checksums.sha256"};
  EXPECT_EQ(names_in(s.folder.path()), names);
  files::require_intact(s.folder.path());
  // Without snapshots there are no fields.
  const test::TemporaryFolder folder;
  auto result = s.result;
  result.rows.erase(results::snapshot_output.file);
  write(folder.path(), result, s.initial);
  names.erase("fields.vtkhdf");
  EXPECT_EQ(names_in(folder.path()), names);
}

TEST_F(WrittenRun, TablesHoldWhatWasComputed) {
  const auto& energies = s.result.event.energies;
  ASSERT_GT(energies.size(), 3U);
  std::vector<std::vector<double>> rows;
  for (const auto& e : energies)
    rows.push_back({e.time_s, e.strain, e.kinetic, e.machine, e.far_edge_work, e.trigger_work,
                    e.prestress_work, e.friction_work, e.contact_work, e.damping_work, e.boundary_work,
                    e.coupling_work, e.stored() - energies[0].stored() - e.work()});
  expect_table(s.folder / "energy.csv",
               "time_s,strain_J_per_m,kinetic_J_per_m,machine_J_per_m,top_work_J_per_m,trigger_work_J_per_m,"
               "prestress_work_J_per_m,"
               "friction_work_J_per_m,contact_work_J_per_m,damping_work_J_per_m,boundary_work_J_per_m,"
               "coupling_work_J_per_m,imbalance_J_per_m",
               rows);

  rows.clear();
  const auto& state = s.initial.subcritical.tractions;
  for (std::size_t k = 0; k < state.x_m.size(); ++k)
    rows.push_back({state.x_m[k], state.t_s_Pa[k], state.p_s_Pa[k]});
  expect_table(s.folder / "static.csv", "x_m,t_s_Pa,p_s_Pa", rows);

  rows.clear();
  std::vector<std::string> kinds;
  for (const auto& front : s.result.fronts)
    for (const auto& p : front.points) {
      rows.push_back({static_cast<double>(front.id), p.x_m, p.onset_s, static_cast<double>(front.direction),
                      p.v_tip_m_per_s, p.t_s_Pa, p.p_s_Pa, p.t_d_Pa, p.p_d_Pa, p.t_r_Pa, p.p_r_Pa,
                      p.U_s_J_per_m3, p.U_r_J_per_m3});
      kinds.emplace_back(fronts::name(p.speed_kind));
    }
  EXPECT_GT(rows.size(), 10U);
  expect_table(s.folder / "fronts.csv",
               "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
               "U_s_J_per_m3,U_r_J_per_m3,speed_kind",
               rows, kinds);
}

TEST_F(WrittenRun, ResolvedCaseReadsBackToTheSameCase) {
  const auto again = input::read_case(s.folder / "case.resolved.toml");
  EXPECT_EQ(input::to_toml(again), input::to_toml(s.config));
  EXPECT_EQ(again.title, s.config.title);
}

TEST_F(WrittenRun, SummaryTellsTheRun) {
  const json run = json::parse(test::read_file(s.folder / "run.json"));
  for (const char* key : {"commit", "host", "stable_dt_s", "interface_dt_s", "wall_s", "node_updates_per_s",
                          "energy_at_start", "energy_at_end", "notes"})
    EXPECT_TRUE(run.contains(key)) << key;
  const std::pair<const char*, json> values[] = {
      {"/version", version()},
      {"/compiler", compiler()},
      {"/processor", processor()},
      {"/title", s.config.title},
      {"/end", s.result.event.end == motion::EventEnd::quiet ? "quiet" : "end_time"},
      {"/mesh/nodes", s.initial.mesh.n_nodes()},
      {"/wave_speeds/c_L_m_per_s", s.result.speeds.c_L},
      {"/dt_s", s.result.step_s},
      {"/steps", s.result.event.steps},
      {"/time_s", s.result.event.time_s},
      {"/onsets", s.result.event.record.n_onsets()},
      {"/statics/critical_shear_m", s.initial.critical_shear_m},
      {"/statics/common_peak_t_over_p", s.initial.subcritical.peak_ratio}};
  for (const auto& [place, value] : values) EXPECT_EQ(run.at(json::json_pointer(place)), value) << place;
  EXPECT_FALSE(run["statics"].contains("ramp"));
  ASSERT_EQ(run["fronts"].size(), s.result.fronts.size());
  for (std::size_t k = 0; k < s.result.fronts.size(); ++k) {
    const auto& front = s.result.fronts[k];
    const auto& written = run["fronts"][k];
    EXPECT_EQ(written["id"], front.id);
    EXPECT_EQ(written["direction"], front.direction);
    EXPECT_EQ(written["start_x_m"], front.points.front().x_m);
    EXPECT_EQ(written["end_s"], front.points.back().onset_s);
    EXPECT_EQ(written["end"], std::string(name(front.end)));
    EXPECT_EQ(written["mode"], std::string(name(front.mode)));
  }
}

TEST_F(WrittenRun, SummaryTellsHowTheRunEnded) {
  for (const auto& [end, word] : {std::pair{motion::EventEnd::end_time, "end_time"},
                                  {motion::EventEnd::quiet, "quiet"},
                                  {motion::EventEnd::interrupted, "interrupted"},
                                  {motion::EventEnd::blow_up, "blow_up"}}) {
    const test::TemporaryFolder folder;
    auto result = s.result;
    result.event.end = end;
    if (end == motion::EventEnd::blow_up) result.event.reason = "blew up at step 7";
    write(folder.path(), result, s.initial);
    const json run = json::parse(test::read_file(folder / "run.json"));
    EXPECT_EQ(run["end"], word);
    EXPECT_EQ(run["end_reason"] == "blew up at step 7", end == motion::EventEnd::blow_up);
  }
}

void expect_same(const record::History& a, const record::History& b) {
  EXPECT_GT(a.time_s.size(), 10U);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.x_m, b.x_m);
  for (const auto& field : record::history_fields) EXPECT_EQ(a.*field.member, b.*field.member) << field.name;
}

TEST_F(WrittenRun, HistoryReadsBack) {
  expect_same(test::read_history(s.folder / "interface.h5"), test::history_of(s.result));
}

TEST_F(WrittenRun, FieldsHoldEverySnapshot) {
  const auto file = s.folder / "fields.vtkhdf";
  const auto times = test::read(file, "/VTKHDF/Steps/Values");
  ASSERT_EQ(times.values.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    // Taken at the first step at or after the time asked for.
    EXPECT_GE(times.values[k], s.config.output.snapshot_times_s[k]);
    EXPECT_LT(times.values[k], s.config.output.snapshot_times_s[k] + s.result.step_s);
  }
  const auto n_nodes = static_cast<std::size_t>(s.initial.mesh.n_nodes());
  const auto u = test::read(file, "/VTKHDF/PointData/displacement_m");
  ASSERT_EQ(u.values.size(), 3 * 3 * n_nodes);
  for (std::size_t n = 0; n < n_nodes; ++n) {
    EXPECT_EQ(u.values[3 * n], s.initial.supercritical.u_m.x[n]);
    EXPECT_EQ(u.values[3 * n + 1], s.initial.supercritical.u_m.y[n]);
  }
}

/// A run's folder written while the run goes; the part of it that holds the files.
std::filesystem::path run_streamed(const input::Case& config, const std::filesystem::path& dir,
                                   const motion::Monitor& monitor) {
  results::ResultFolder folder(dir, run_work);
  bool stop = false;
  SessionHooks hooks;
  hooks.progress = [&](const char* part, std::int64_t step, std::int64_t total) {
    stop = std::string(part) == "event" && !monitor(step, total);
  };
  hooks.request = [&] { return stop ? Request::stop : Request::none; };
  const auto run = run_into(folder, make_problem(config), {}, hooks);
  EXPECT_TRUE(run.last.result.rows.empty());
  return status_of(run.last.result).name == "complete" ? dir : folder.unfinished();
}

void run_in_memory(const input::Case& config, const std::filesystem::path& dir,
                   const motion::Monitor& monitor) {
  const auto initial = setup::make_initial_state(make_problem(config), go_on);
  write(dir, run_from(make_problem(config), initial, monitor), initial);
}

/// Names of a run's files, but of what tells apart one that is complete.
std::set<std::string> result_names_in(const std::filesystem::path& dir) {
  auto names = names_in(dir);
  names.erase("state");
  names.erase("checksums.sha256");
  return names;
}

/// All of a run.json but the times it took.
json summary_of(const std::filesystem::path& dir) {
  auto run = json::parse(test::read_file(dir / "run.json"));
  run.erase("wall_s");
  run.erase("node_updates_per_s");
  if (run["statics"].contains("wall_s")) run["statics"].erase("wall_s");
  return run;
}

TEST(StreamedRun, EqualsTheOneKeptInMemory) {
  auto blow_up = coarse_case();
  blow_up.time.step_factor = 1.4;
  blow_up.time.allow_unstable = true;
  const motion::Monitor stop = [](std::int64_t step, std::int64_t) { return step < 100; };
  struct Run {
    const char* name;
    input::Case config;
    motion::Monitor monitor;
  };
  const std::vector<Run> runs = {{"left", coarse_case(interface::EventKind::left), go_on},
                                 {"prestress", test::prestressed_case(), go_on},
                                 {"blow_up", blow_up, go_on},
                                 {"interrupted", coarse_case(), stop}};
  for (auto [name, config, monitor] : runs) {
    SCOPED_TRACE(name);
    config.output.snapshot_times_s = {0, 5e-6, 15e-6, 1};  // the last one is not reached
    const test::TemporaryFolder streamed, kept;
    const auto dir = run_streamed(config, streamed.path(), monitor);
    run_in_memory(config, kept.path(), monitor);
    ASSERT_EQ(result_names_in(dir), result_names_in(kept.path()));
    for (const char* file :
         {"case.resolved.toml", "fronts.csv", "static.csv", "energy.csv", "fields.vtkhdf", "interface.h5"})
      EXPECT_EQ(test::read_file(dir / file), test::read_file(kept / file)) << file;
    EXPECT_EQ(summary_of(dir), summary_of(kept.path()));
  }
}

TEST(Write, OfARampTellsBothWays) {
  const auto config = test::ramped_case();
  const auto initial = setup::make_initial_state(make_problem(config), go_on);
  const test::TemporaryFolder folder;
  write(folder.path(), run_from(make_problem(config), initial, go_on), initial);
  const json ramp = json::parse(test::read_file(folder / "run.json"))["statics"]["ramp"];
  EXPECT_EQ(ramp["critical_shear_m"], initial.ramp->supercritical.shear_m);
  EXPECT_DOUBLE_EQ(ramp["relative_to_direct"],
                   initial.ramp->supercritical.shear_m / initial.critical_shear_m - 1);
  EXPECT_EQ(ramp["steps"], initial.ramp->steps);
  EXPECT_EQ(ramp["onsets_before_critical"], initial.ramp->record.n_onsets());
}

}  // namespace
}  // namespace slipfront::run
