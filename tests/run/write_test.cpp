// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/version.hpp"
#include "cases.hpp"
#include "files/checksum.hpp"
#include "input/schema.hpp"
#include "results/hdf5.hpp"
#include "results/history.hpp"
#include "results/results.hpp"
#include "run/session.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

using nlohmann::json;
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
      initial = make_initial_state(config, go_on);
      result = run_from(config, initial, go_on);
      write(folder.path(), result, initial);
    }
  };
  static void SetUpTestSuite() { shared = std::make_unique<Shared>(); }
  static void TearDownTestSuite() { shared.reset(); }
  static inline std::unique_ptr<Shared> shared;

  const Shared& s = *shared;
  std::string text(const char* name) const { return test::read_file(s.folder / name); }
};

std::set<std::string> names_in(const std::filesystem::path& dir) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(dir))
    names.insert(entry.path().filename().string());
  return names;
}

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream stream(csv);
  for (std::string line; std::getline(stream, line);) {
    rows.emplace_back(1);
    for (const char c : line) {
      if (c == ',')
        rows.back().emplace_back();
      else
        rows.back().back() += c;
    }
  }
  return rows;
}

/// Exactly the number that was written; an empty field for what is undefined.
void expect_field(const std::string& field, double value) {
  if (std::isnan(value))
    EXPECT_EQ(field, "");
  else
    EXPECT_EQ(std::stod(field), value);
}

TEST_F(WrittenRun, HasTheFilesByTheirNames) {
  EXPECT_THAT(names_in(s.folder.path()),
              testing::UnorderedElementsAre("case.resolved.toml", "run.json", "interface.h5", "fronts.csv",
                                            "static.csv", "energy.csv", "fields.vtkhdf", "checksums.sha256"));
  files::require_intact(s.folder.path());
}

TEST_F(WrittenRun, WithoutSnapshotsHasNoFields) {
  const test::TemporaryFolder folder;
  auto result = s.result;
  result.event.snapshots.clear();
  write(folder.path(), result, s.initial);
  EXPECT_THAT(names_in(folder.path()),
              testing::UnorderedElementsAre("case.resolved.toml", "run.json", "interface.h5", "fronts.csv",
                                            "static.csv", "energy.csv", "checksums.sha256"));
}

TEST_F(WrittenRun, EnergiesAreARowPerInstant) {
  const auto rows = rows_of(text("energy.csv"));
  const auto& energies = s.result.event.energies;
  ASSERT_EQ(rows.size(), energies.size() + 1);
  ASSERT_GT(energies.size(), 3U);
  EXPECT_EQ(rows[0].front(), "time_s");
  EXPECT_EQ(rows[0].back(), "imbalance_J_per_m");
  for (std::size_t k = 0; k < energies.size(); ++k) {
    const auto& e = energies[k];
    const std::vector<double> values = {
        e.time_s,       e.strain,         e.kinetic,       e.top_work,
        e.trigger_work, e.prestress_work, e.friction_work, e.contact_work,
        e.damping_work, e.boundary_work,  e.coupling_work, e.stored() - energies[0].stored() - e.work()};
    ASSERT_EQ(rows[k + 1].size(), values.size());
    for (std::size_t c = 0; c < values.size(); ++c) expect_field(rows[k + 1][c], values[c]);
  }
}

TEST_F(WrittenRun, ResolvedCaseReadsBackToTheSameCase) {
  const auto again = input::read_case(s.folder / "case.resolved.toml");
  EXPECT_EQ(input::to_toml(again), input::to_toml(s.config));
  EXPECT_EQ(again.title, s.config.title);
}

TEST_F(WrittenRun, SummaryTellsTheRun) {
  const json run = json::parse(text("run.json"));
  for (const char* key : {"version", "commit",          "compiler",
                          "host",    "title",           "end",
                          "mesh",    "wave_speeds",     "stable_dt_s",
                          "dt_s",    "interface_dt_s",  "steps",
                          "time_s",  "wall_s",          "node_updates_per_s",
                          "statics", "energy_at_start", "energy_at_end",
                          "onsets",  "fronts",          "warnings"})
    EXPECT_TRUE(run.contains(key)) << key;
  EXPECT_EQ(run["version"], version());
  EXPECT_EQ(run["compiler"], compiler());
  EXPECT_EQ(run["processor"], processor());
  EXPECT_EQ(run["title"], s.config.title);
  EXPECT_EQ(run["end"], s.result.event.end == motion::EventEnd::quiet ? "quiet" : "end_time");
  EXPECT_EQ(run["mesh"]["nodes"], s.initial.mesh.n_nodes());
  EXPECT_EQ(run["wave_speeds"]["c_L_m_per_s"], s.result.speeds.c_L);
  EXPECT_EQ(run["dt_s"], s.result.step_s);
  EXPECT_EQ(run["steps"], s.result.event.steps);
  EXPECT_EQ(run["time_s"], s.result.event.time_s);
  EXPECT_EQ(run["onsets"], s.result.event.record.n_onsets());
  EXPECT_EQ(run["statics"]["critical_shear_m"], s.initial.critical_shear_m);
  EXPECT_EQ(run["statics"]["common_peak_t_over_p"], s.initial.common.peak_ratio);
  EXPECT_FALSE(run["statics"].contains("ramp"));
  ASSERT_EQ(run["fronts"].size(), s.result.fronts.size());
  for (std::size_t k = 0; k < s.result.fronts.size(); ++k) {
    const auto& front = s.result.fronts[k];
    EXPECT_EQ(run["fronts"][k]["id"], front.id);
    EXPECT_EQ(run["fronts"][k]["direction"], front.direction);
    EXPECT_EQ(run["fronts"][k]["start_x_m"], front.points.front().x_m);
    EXPECT_EQ(run["fronts"][k]["end_s"], front.points.back().onset_s);
    EXPECT_EQ(run["fronts"][k]["end"], std::string(name(front.end)));
    EXPECT_EQ(run["fronts"][k]["mode"], std::string(name(front.mode)));
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
    if (end == motion::EventEnd::blow_up) result.event.blow_up = "blew up at step 7";
    write(folder.path(), result, s.initial);
    const json run = json::parse(test::read_file(folder / "run.json"));
    EXPECT_EQ(run["end"], word);
    const bool told = !run["warnings"].empty() && run["warnings"].back() == "blew up at step 7";
    EXPECT_EQ(told, end == motion::EventEnd::blow_up);
  }
}

TEST_F(WrittenRun, StaticTractionsByColumn) {
  const auto rows = rows_of(text("static.csv"));
  EXPECT_THAT(rows[0], testing::ElementsAre("x_m", "t_s_Pa", "p_s_Pa"));
  const auto& state = s.initial.common.tractions;
  ASSERT_EQ(rows.size(), state.x_m.size() + 1);
  for (std::size_t k = 0; k < state.x_m.size(); ++k) {
    ASSERT_EQ(rows[k + 1].size(), 3U);
    expect_field(rows[k + 1][0], state.x_m[k]);
    expect_field(rows[k + 1][1], state.t_s_Pa[k]);
    expect_field(rows[k + 1][2], state.p_s_Pa[k]);
  }
}

TEST_F(WrittenRun, FrontsByColumn) {
  const auto csv = text("fronts.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
            "U_s_J_per_m3,U_r_J_per_m3,speed_kind");
  const auto rows = rows_of(csv);
  std::size_t row = 1;
  for (const auto& front : s.result.fronts) {
    for (const auto& p : front.points) {
      ASSERT_LT(row, rows.size());
      ASSERT_EQ(rows[row].size(), 14U);
      EXPECT_EQ(rows[row][13], fronts::name(p.speed_kind));
      const double id = front.id, direction = front.direction;
      const std::array values = {id,       p.x_m,          p.onset_s,     direction, p.v_tip_m_per_s,
                                 p.t_s_Pa, p.p_s_Pa,       p.t_d_Pa,      p.p_d_Pa,  p.t_r_Pa,
                                 p.p_r_Pa, p.U_s_J_per_m3, p.U_r_J_per_m3};
      for (std::size_t k = 0; k < values.size(); ++k) expect_field(rows[row][k], values[k]);
      ++row;
    }
  }
  EXPECT_GT(row, 10U);
  EXPECT_EQ(row, rows.size());
}

TEST_F(WrittenRun, HistoryReadsBack) {
  const auto path = s.folder / "interface.h5";
  const auto history = results::read_history(path);
  const auto& ours = s.result.event.history;
  EXPECT_EQ(history.time_s, ours.time_s);
  EXPECT_EQ(history.x_m, ours.x_m);
  for (const auto& field : record::history_fields)
    EXPECT_EQ(history.*field.member, ours.*field.member) << field.name;
}

TEST_F(WrittenRun, FieldsHoldEverySnapshot) {
  const auto file = results::hdf5::open_file(s.folder / "fields.vtkhdf");
  const auto times = results::hdf5::read(file, "/VTKHDF/Steps/Values");
  ASSERT_EQ(times.values.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    // Taken at the first step at or after the time asked for.
    EXPECT_GE(times.values[k], s.config.output.snapshot_times_s[k]);
    EXPECT_LT(times.values[k], s.config.output.snapshot_times_s[k] + s.result.step_s);
  }
  const auto n_nodes = static_cast<std::size_t>(s.initial.mesh.n_nodes());
  const auto u = results::hdf5::read(file, "/VTKHDF/PointData/displacement_m");
  ASSERT_EQ(u.values.size(), 3 * 3 * n_nodes);
  for (std::size_t n = 0; n < n_nodes; ++n) {
    EXPECT_EQ(u.values[3 * n], s.initial.spontaneous.u_m.x[n]);
    EXPECT_EQ(u.values[3 * n + 1], s.initial.spontaneous.u_m.y[n]);
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
  const auto run = run_into(folder, config, {}, hooks);
  EXPECT_TRUE(run.result.event.history.time_s.empty());
  EXPECT_TRUE(run.result.event.snapshots.empty());
  return status_of(run.result).name == "complete" ? dir : folder.unfinished();
}

void run_in_memory(const input::Case& config, const std::filesystem::path& dir,
                   const motion::Monitor& monitor) {
  const auto initial = make_initial_state(config, go_on);
  write(dir, run_from(config, initial, monitor), initial);
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

input::Case prestressed_case() {
  auto config = coarse_case(interface::EventKind::nucleation, 2e-3);
  config.plate.corner = mesh::Corner::none;
  config.plate.sides = mesh::Sides::periodic;
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress = {4e6, 5e6, ""};
  config.nucleation.x_m = 0.1;
  return config;
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
                                 {"prestress", prestressed_case(), go_on},
                                 {"blow_up", blow_up, go_on},
                                 {"interrupted", coarse_case(), stop}};
  for (auto [name, config, monitor] : runs) {
    SCOPED_TRACE(name);
    config.output.snapshot_times_s = {0, 5e-6, 15e-6, 1};  // the last one is not reached
    const test::TemporaryFolder streamed, kept;
    const auto dir = run_streamed(config, streamed.path(), monitor);
    run_in_memory(config, kept.path(), monitor);
    ASSERT_EQ(result_names_in(dir), result_names_in(kept.path()));
    for (const char* file : {"case.resolved.toml", "fronts.csv", "static.csv", "energy.csv", "fields.vtkhdf"})
      EXPECT_EQ(test::read_file(dir / file), test::read_file(kept / file)) << file;
    EXPECT_EQ(summary_of(dir), summary_of(kept.path()));
    // The files may differ in where their chunks lie.
    const auto a = results::read_history(dir / "interface.h5"),
               b = results::read_history(kept / "interface.h5");
    EXPECT_GT(a.time_s.size(), 10U);
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.x_m, b.x_m);
    for (const auto& field : record::history_fields)
      EXPECT_EQ(a.*field.member, b.*field.member) << field.name;
  }
}

TEST(StreamedRun, TwoOfThemMakeEqualFiles) {
  const test::TemporaryFolder a, b;
  for (const auto* folder : {&a, &b}) run_streamed(coarse_case(), folder->path(), go_on);
  EXPECT_EQ(test::read_file(a / "interface.h5"), test::read_file(b / "interface.h5"));
}

TEST(Write, OfARampTellsBothWays) {
  auto config = coarse_case(interface::EventKind::spontaneous, 5e-3);
  config.loading.method = statics::LoadingMethod::ramp;
  const auto initial = make_initial_state(config, go_on);
  const test::TemporaryFolder folder;
  write(folder.path(), run_from(config, initial, go_on), initial);
  const json ramp = json::parse(test::read_file(folder / "run.json"))["statics"]["ramp"];
  EXPECT_EQ(ramp["critical_shear_m"], initial.ramp->spontaneous.shear_m);
  EXPECT_DOUBLE_EQ(ramp["relative_to_direct"],
                   initial.ramp->spontaneous.shear_m / initial.critical_shear_m - 1);
  EXPECT_EQ(ramp["steps"], initial.ramp->steps);
  EXPECT_EQ(ramp["onsets_before_critical"], initial.ramp->record.n_onsets());
}

}  // namespace
}  // namespace slipfront::run
