// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <utility>

#include "boundary/pusher.hpp"
#include "cases.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "problem/contact.hpp"
#include "problem/problem.hpp"
#include "results/folder.hpp"
#include "run/session.hpp"
#include "sessions.hpp"

namespace slipfront::run {
namespace {

using problem::friction_at;
using problem::inertia_slip_rate_m_per_s;
using problem::make_problem;
namespace fs = std::filesystem;
using record::LoadingPhase;
using record::LoadingRow;
using test::error_of;
using test::stopping_at;
using test::undisturbed;
using ::testing::HasSubstr;

input::Case sequence_case(int max_events, double mu_k = 0.6) {
  auto config = test::coarse_case();
  config.sequence.max_events = max_events;
  config.loading.shear_speed_m_per_s = 1.6e-6;
  config.time.quiet_s = 0.45e-3;
  config.time.end_s = 11e-3;
  test::law(config).mu_k = mu_k;
  return config;
}

/// Stick-slip of a small block in some seconds.
input::Case rate_and_state_case(int max_events) {
  auto config = test::paper_case();
  config.plate = {.width_m = 0.04, .height_m = 0.02, .element_size_m = 1e-3, .corner = mesh::Corner::none};
  config.material.stiffness_damping_s = 2e-6;
  interface::RateAndStateAging law;
  law.a = 0.01;
  law.b = 0.02;
  law.d_c_m = 1e-7;
  law.V_i_m_per_s = 1e-6;
  config.friction = law;
  config.loading.mean_pressure_Pa = 5e6;
  config.loading.edge_margin_m = 4e-3;
  config.loading.shear_speed_m_per_s = 1.6e-6;
  config.sequence.max_events = max_events;
  config.time.quiet_s = 0.1e-3;
  config.time.end_s = 4e-3;
  return config;
}

/// The same along a path, whose parts end before the first event and between others.
input::Case rate_and_state_path(int max_events) {
  auto config = rate_and_state_case(max_events);
  config.sequence.path = {{20, 50, 1000}, {4e-5, 9e-5, 1.6e-3}};
  return config;
}

/// A block that a soft pusher moves under a dead load.
input::Case pushed_block(int max_events) {
  auto config = sequence_case(max_events, 0.5);
  test::law(config).mu_s = 0.7;
  config.plate.corner = mesh::Corner::none;
  config.loading.mean_pressure_Pa = 5e6;
  config.machine = {2.5e11, 0, {8e-3, 16e-3}};
  return config;
}

/// The same with pressures that are not even.
input::Case unevenly_pushed_block(int max_events) {
  auto config = pushed_block(max_events);
  config.loading.mean_pressure_Pa.reset();
  config.loading.top_pressure = {{0, config.plate.width_m}, {6e6, 4e6}};
  return config;
}

/// Computes the next event. @return the state in which it began
const InitialState* run_next(Sequence& sequence, const input::Case& config) {
  const auto* initial = sequence.next();
  if (initial != nullptr) sequence.record_event(run_from(make_problem(config), *initial, test::go_on));
  return initial;
}

/// Computes all events.
void run_all(Sequence& sequence, const input::Case& config) {
  while (sequence.end().empty()) run_next(sequence, config);
}

double largest_term(const std::vector<LoadingRow>& rows) {
  double largest = 0;
  for (const auto& row : rows)
    for (const auto& term : record::energy_terms)
      largest = std::max(largest, std::abs(row.energies.*term.member));
  return largest;
}

/// Work of the edge, without what the tilt has stored.
double largest_work(const std::vector<LoadingRow>& rows) {
  return std::abs(std::ranges::max_element(rows, {}, [](const LoadingRow& row) {
                    return std::abs(row.energies.far_edge_work);
                  })->energies.far_edge_work);
}

void expect_balance(const std::vector<LoadingRow>& rows, double tolerance_J_per_m) {
  for (const auto& row : rows) EXPECT_LT(std::abs(imbalance_J_per_m(row, rows.front())), tolerance_J_per_m);
}

TEST(Sequence, EnergiesOfAllPhasesBalance) {
  auto config = sequence_case(6);
  config.time.interface_substeps =
      1;  // energies of sub-cycled motion are bounded from below but for coupling
  Sequence sequence(make_problem(config), test::go_on);
  run_all(sequence, config);
  const auto& rows = sequence.loading();
  ASSERT_EQ(rows.size(), 1 + 3 * 6);
  expect_balance(rows, 1e-11 * largest_term(rows));
  for (std::size_t k = 3; k < rows.size(); k += 3) {
    ASSERT_EQ(rows[k].phase, LoadingPhase::at_rest);
    // An equilibrium has the least energy of all motions with this interface.
    EXPECT_GT(rows[k].wave_loss_J_per_m, rows[k - 1].wave_loss_J_per_m);
    EXPECT_LT(rows[k].energies.strain, rows[k - 2].energies.strain);
    EXPECT_LT(rows[k].energies.friction_work, rows[k - 2].energies.friction_work);
    EXPECT_LT(rows[k].shear_over_normal, rows[k - 2].shear_over_normal);
  }
}

TEST(Sequence, EquilibriumCarriesTheTractionsWithWhichADampedEventComesToRest) {
  auto config = sequence_case(2);
  config.material.stiffness_damping_s = 4e-6;
  config.time.end_s = 40e-3;
  double off_before = infinity;
  for (const double quiet_s : {2e-3, 8e-3}) {
    config.time.quiet_s = quiet_s;
    Sequence sequence(make_problem(config), test::go_on);
    const auto* initial = sequence.next();
    const auto result = run_from(make_problem(config), *initial, test::go_on);
    sequence.record_event(result);
    const auto& ends = sequence.loading()[2];
    const auto& rests = sequence.loading()[3];
    const double off = std::abs(ends.shear_force_N_per_m / rests.shear_force_N_per_m - 1);
    EXPECT_LT(off, 0.2 * off_before);  // waves fade away
    off_before = off;
  }
  EXPECT_LT(off_before, 1e-3);
}

TEST(Sequence, IsTheSameWhateverRowsAreWritten) {
  auto config = sequence_case(6, 1.0);
  std::vector<std::vector<record::SequenceEvent>> events;
  for (const double interval_s : {0.5e-6, 50e-6}) {
    config.output.history_interval_s = interval_s;
    Sequence sequence(make_problem(config), test::go_on);
    while (sequence.end().empty()) run_next(sequence, config);
    events.push_back(sequence.events());
  }
  ASSERT_EQ(events[0].size(), events[1].size());
  for (std::size_t k = 0; k < events[0].size(); ++k) {
    EXPECT_EQ(events[0][k].shear_m, events[1][k].shear_m) << k;
    EXPECT_EQ(events[0][k].potency_m2, events[1][k].potency_m2) << k;
    EXPECT_EQ(events[0][k].shear_force_N_per_m, events[1][k].shear_force_N_per_m) << k;
    EXPECT_EQ(events[0][k].friction_after, events[1][k].friction_after) << k;
  }
}

TEST(Sequence, EventsBeginWhereInsideOneNodeReachesTheStrengthAndTheOthersStick) {
  const auto config = sequence_case(12, 1.0);
  Sequence sequence(make_problem(config), test::go_on);
  while (sequence.end().empty()) {
    const auto* initial = sequence.next();
    ASSERT_NE(initial, nullptr);
    const auto& state = initial->supercritical;
    EXPECT_NEAR(state.peak_ratio, 1.3 * 1.001, 1e-6);
    for (std::size_t k = 0; k < state.contact.size(); ++k) {
      if (!state.is_inside(state.tractions.x_m[k])) continue;
      EXPECT_EQ(state.contact[k], statics::Contact::stick) << k;
    }
    sequence.record_event(run_from(make_problem(config), *initial, test::go_on));
  }
}

TEST(Sequence, EndsByGlobalSliding) {
  auto config = sequence_case(20);
  config.sequence.to_global_sliding = true;
  Sequence sequence(make_problem(config), test::go_on);
  run_all(sequence, config);
  const auto& events = sequence.events();
  ASSERT_LT(events.size(), 20U);
  EXPECT_EQ(events.back().is_global, 1);
  for (std::size_t k = 0; k + 1 < events.size(); ++k) EXPECT_EQ(events[k].is_global, 0);
  EXPECT_THAT(sequence.end(), HasSubstr("all nodes inside have slipped"));
}

TEST(Sequence, LoadsToTheTimeAtWhichItEnds) {
  auto config = sequence_case(20);
  Sequence unlimited(make_problem(config), test::go_on);
  run_next(unlimited, config);
  unlimited.next();
  const double second_s = unlimited.loading().back().time_s;
  config.sequence.end_s = second_s - 1;
  Sequence sequence(make_problem(config), test::go_on);
  EXPECT_NE(run_next(sequence, config), nullptr);
  EXPECT_EQ(run_next(sequence, config), nullptr);
  const auto& last = sequence.loading().back();
  EXPECT_EQ(last.phase, LoadingPhase::loaded);
  EXPECT_DOUBLE_EQ(last.time_s, second_s - 1);
  expect_balance(sequence.loading(), 1e-11 * last.energies.strain);
}

TEST(Sequence, RowsOfEventsTellWhatSlipped) {
  const auto config = sequence_case(4, 1.0);
  Sequence sequence(make_problem(config), test::go_on);
  while (sequence.end().empty()) {
    const auto* initial = sequence.next();
    const auto result = run_from(make_problem(config), *initial, test::go_on);
    sequence.record_event(result);
    const auto& e = sequence.events().back();
    const auto& before = sequence.loading().end()[-3];
    const auto& after = sequence.loading().back();
    std::set<std::int32_t> nodes;
    for (const auto& onset : result.event.record.onsets) nodes.insert(onset.node);
    double potency_m2 = 0, length_m = 0;
    for (const auto node : nodes) {
      const double a = initial->tributary_m[node];
      potency_m2 += result.event.interface_at_end.slip_m[node] * a;
      length_m += a;
    }
    EXPECT_NEAR(e.potency_m2, potency_m2, 1e-12 * potency_m2);
    EXPECT_NEAR(e.length_m, length_m, 1e-12 * length_m);
    EXPECT_EQ(e.from_x_m, result.event.record.x_m[*nodes.begin()]);
    EXPECT_EQ(e.to_x_m, result.event.record.x_m[*nodes.rbegin()]);
    EXPECT_TRUE(initial->subcritical.is_inside(e.begin_x_m));
    EXPECT_EQ(e.friction_before, before.shear_force_N_per_m / before.normal_force_N_per_m);
    EXPECT_EQ(e.friction_after, after.shear_force_N_per_m / after.normal_force_N_per_m);
    EXPECT_NEAR(e.begin_s, e.shear_m / make_problem(config).shear_speed_m_per_s, 1e-12 * e.begin_s);
    EXPECT_GT(e.stress_drop_Pa, 0);
  }
}

TEST(Sequence, PrecursorsGrowFromAPusherUntilAllSlips) {
  auto config = pushed_block(200);
  config.machine = {.pusher = config.machine.pusher};  // that does not yield
  config.sequence.to_global_sliding = true;
  Sequence sequence(make_problem(config), test::go_on);
  while (sequence.end().empty()) {
    const auto* initial = sequence.next();
    auto with_fields = config;
    with_fields.output.snapshot_times_s = {1e-5, 3e-5};
    const auto result = run_from(make_problem(with_fields), *initial, test::go_on);
    sequence.record_event(result);
    const auto snapshots = test::snapshots_of(result, initial->n_nodes);
    ASSERT_FALSE(snapshots.empty());
    for (const auto& snapshot : snapshots) {
      for (const auto n : boundary::pushed_nodes(initial->mesh, config.machine.pusher))
        EXPECT_EQ(snapshot.v_m_per_s.x[n], 0);
      for (const auto n : initial->mesh.far_edge_nodes) EXPECT_EQ(snapshot.v_m_per_s.y[n], 0);
    }
  }
  const auto& events = sequence.events();
  ASSERT_GT(events.size(), 5U);
  EXPECT_EQ(events.back().is_global, 1);
  EXPECT_TRUE(std::isnan(events.back().nucleation_length_m));  // this law has no length
  // Longer and longer: the longest so far is so a good part of the time, from the pushed end on.
  double longest_m = 0;
  int n_longer = 0;
  for (const auto& e : events) {
    EXPECT_LT(e.from_x_m, e.length_m > 0.03 ? 0.01 : 0.03);
    if (e.length_m > longest_m) ++n_longer;
    longest_m = std::max(longest_m, e.length_m);
  }
  EXPECT_GT(n_longer, 5);
  expect_balance(sequence.loading(), 1e-11 * largest_term(sequence.loading()));
}

TEST(Sequence, UnderADeadLoadKeepsItsNormalForceAndItsBooks) {
  auto in_substeps = pushed_block(6);
  in_substeps.time.interface_substeps = 6;
  for (const auto& config : {pushed_block(6), in_substeps, unevenly_pushed_block(6)}) {
    const bool has_substeps = config.time.interface_substeps > 1;
    Sequence sequence(make_problem(config), test::go_on);
    run_all(sequence, config);
    const auto& rows = sequence.loading();
    ASSERT_EQ(rows.size(), 1 + 3 * 6U);
    const double normal = rows.front().normal_force_N_per_m;
    EXPECT_NEAR(normal, 5e6 * config.plate.width_m, 1e-9 * normal);
    expect_balance(rows, 1e-11 * largest_term(rows));
    for (const auto& row : rows) {
      if (row.phase == LoadingPhase::slip_ends) continue;  // waves
      EXPECT_NEAR(row.normal_force_N_per_m, normal, 1e-10 * normal);
      if (row.phase == LoadingPhase::tilted) continue;
      EXPECT_TRUE(row.shear_height_m > 8e-3 && row.shear_height_m < 16e-3);
      EXPECT_NEAR(row.pressure_moment_N - rows.front().pressure_moment_N,
                  row.shear_force_N_per_m * row.shear_height_m, 1e-10 * normal * config.plate.width_m);
    }
    for (std::size_t k = 3; k < rows.size(); k += 3) {
      ASSERT_EQ(rows[k].phase, LoadingPhase::at_rest);
      EXPECT_TRUE(has_substeps || rows[k].wave_loss_J_per_m > rows[k - 1].wave_loss_J_per_m);
      EXPECT_LT(rows[k].energies.machine, rows[k - 2].energies.machine);  // the spring shortens in an event
    }
    // All of the shear force comes through the spring.
    EXPECT_GT(rows.back().energies.machine, 0.1 * std::pow(rows.back().shear_force_N_per_m, 2) / (2 * 2e9));
  }
}

TEST(Sequence, OnAMachineAboveKeepsItsBooks) {
  auto config = pushed_block(4);
  config.machine = {5e10, 1e11};
  Sequence sequence(make_problem(config), test::go_on);
  run_all(sequence, config);
  const auto& rows = sequence.loading();
  expect_balance(rows, 1e-11 * largest_term(rows));
  EXPECT_NE(rows.back().normal_force_N_per_m, rows.front().normal_force_N_per_m);
}

TEST(Sequence, APusherNeedsNodes) {
  auto config = sequence_case(2);
  config.plate.corner = mesh::Corner::none;
  config.plate.coarsenings = 1;
  config.plate.fine_height_m = 0.02;
  config.machine.pusher = {0.0695, 0.0745};
  EXPECT_THAT(error_of([&] { Sequence(make_problem(config), test::go_on); }),
              HasSubstr("no node lies between"));
}

TEST(Sequence, OfTwoEqualBodiesKeepsTheirSymmetry) {
  // Turned by half a turn the two are each other, and the shear is the same.
  auto config = sequence_case(3);
  config.plate.corner = mesh::Corner::none;
  config.base.kind = input::BaseKind::body;
  config.base.plate = config.plate;
  config.base.material = config.material;
  config.loading.tilt_left_m = config.loading.tilt_right_m = 0.2e-3;
  Sequence sequence(make_problem(config), test::go_on);
  std::size_t n_local = 0;
  while (sequence.end().empty()) {
    const auto* initial = sequence.next();
    const auto result = run_from(make_problem(config), *initial, test::go_on);
    sequence.record_event(result);
    const auto& slip_m = result.event.interface_at_end.slip_m;
    const auto& t_Pa = initial->subcritical.tractions.t_s_Pa;
    const double most_m = *std::ranges::max_element(slip_m), most_Pa = *std::ranges::max_element(t_Pa);
    // Rounding grows some hundredfold from event to event.
    for (std::size_t k = 0, other = slip_m.size() - 1; k < slip_m.size(); ++k, --other) {
      EXPECT_NEAR(slip_m[k], slip_m[other], 1e-6 * most_m) << k;
      EXPECT_NEAR(t_Pa[k], t_Pa[other], 1e-6 * most_Pa) << k;
    }
    if (sequence.events().back().is_global == 0) ++n_local;
  }
  EXPECT_GT(n_local, 0U);
}

TEST(Sequence, GoesOnUnderAStrengthThatLeavesNodesBeyondMuS) {
  auto config = sequence_case(20);
  config.regularisation.relaxed = interface::Relaxed::initial_pressure;
  Sequence sequence(make_problem(config), test::go_on);
  int n_at_rest = 0;
  while (sequence.end().empty()) {
    const double at_rest_m = sequence.loading().back().shear_m;
    const auto* initial = run_next(sequence, config);
    ASSERT_NE(initial, nullptr);
    EXPECT_GE(initial->supercritical.peak_ratio, 1.3 * 1.001 * (1 - 1e-6));
    if (initial->supercritical.shear_m == at_rest_m) ++n_at_rest;
  }
  EXPECT_GT(n_at_rest, 0);
}

// In folders.

Finished start_sequence(const fs::path& dir, const input::Case& config,
                        const SessionHooks& hooks = undisturbed) {
  results::ResultFolder folder(dir, run_work);
  return run_into(folder, make_problem(config), test::with_threads(1), hooks);
}

Finished resume_sequence_in(const fs::path& dir, const SessionHooks& hooks = undisturbed) {
  results::ResultFolder folder(dir, run_work);
  return resume(folder, nullptr, test::with_threads(1), hooks);
}

/// The files of all events and of the loading, which do not depend on when they were written.
std::map<std::string, std::string> tables_in(const fs::path& dir) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    const auto ending = entry.path().extension();
    if (ending == ".csv" || ending == ".h5" || ending == ".toml")
      files[fs::relative(entry.path(), dir).string()] = test::read_file(entry.path());
  }
  return files;
}

/// Ends as by a signal that gives no time.
struct Killed {};

/// Hooks that throw an error where an event has come to a step.
template <class Error>
SessionHooks failing_in(const std::string& event, std::int64_t fails_at, Error error) {
  SessionHooks hooks = undisturbed;
  hooks.progress = [=](const char* part, std::int64_t step, std::int64_t) {
    if (part == event && step >= fails_at) throw error;
  };
  return hooks;
}

class SequenceInAFolder : public test::InFolder {
 protected:
  const fs::path dir_ = folder_ / "out", unfinished_ = dir_ / "unfinished";

  void stop(const input::Case& config, const char* part, std::int64_t step) {
    EXPECT_THROW(start_sequence(dir_, config, stopping_at(part, step)), Interrupted);
    EXPECT_FALSE(is_complete(dir_));
  }
  void expect_refused(const char* told) const {
    EXPECT_THAT(error_of([&] { resume_sequence_in(dir_); }), HasSubstr(told));
  }
  void finish() const {
    resume_sequence_in(dir_);
    EXPECT_TRUE(is_complete(dir_));
  }
  /// That it goes on as if it had never stopped.
  void expect_same_as_whole(const input::Case& config) const {
    finish();
    start_sequence(folder_ / "whole", config);
    EXPECT_EQ(tables_in(dir_), tables_in(folder_ / "whole"));
  }
};

struct Stopped {
  const char* name;
  input::Case config;
  std::size_t n_tables;  ///< of all its files
};

TEST(Sequences, AreTheSameWhereverTheyWereStopped) {
  auto healing = sequence_case(3);
  healing.plate.corner = mesh::Corner::none;  // where edges slip at rest
  healing.loading.mean_pressure_Pa = 5e6;
  healing.material.stiffness_damping_s = 2e-6;
  healing.friction = interface::SlipWeakeningHealing { .mu_s = 0.5, .mu_k = 0.45, .d_c_m = 2e-6 };
  healing.sequence.healing_per_e_fold = 0.02;
  for (const auto& [name, config, n_tables] :
       {Stopped{"plain", sequence_case(3), 3 + 3 * 6},
        {"healing", healing, 3 + 3 * 6},
        {"law with a state", rate_and_state_case(3), 3 + 3 * 7},  // and slow slip before it
        {"law with a state along a path", rate_and_state_path(3), 3 + 3 * 7},
        {"pushed by a spring", unevenly_pushed_block(3), 3 + 3 * 6}}) {
    SCOPED_TRACE(name);
    const test::TemporaryFolder folder;
    start_sequence(folder / "whole", config);
    const auto expected = tables_in(folder / "whole");
    ASSERT_EQ(expected.size(), n_tables);
    for (const auto& [part, step] : {std::pair{"event 1", 1}, {"event 1", 200}, {"event 3", 150}}) {
      const auto dir = folder / fmt::format("stopped in {} at {}", part, step);
      EXPECT_THROW(start_sequence(dir, config, stopping_at(part, step)), Interrupted);
      EXPECT_FALSE(is_complete(dir));
      resume_sequence_in(dir);
      EXPECT_TRUE(is_complete(dir));
      EXPECT_EQ(tables_in(dir), expected) << part << " at " << step;
    }
  }
}

/// A sequence that is complete goes on to a later end, as if it had been asked for from the start.
TEST(Sequences, AreExtended) {
  auto healing = sequence_case(4);
  healing.sequence.healing_per_e_fold = 0.02;
  for (const auto& sample : {std::pair{"plain", sequence_case(4)},
                             {"healing", healing},
                             {"law with a state", rate_and_state_case(3)},
                             {"law with a state along a path", rate_and_state_path(3)},
                             {"ended by time", sequence_case(3)}}) {
    const std::string name = sample.first;
    const auto& longer = sample.second;
    SCOPED_TRACE(name);
    const test::TemporaryFolder folder;
    const auto whole = folder / "whole", extended = folder / "extended";
    const auto events = start_sequence(whole, longer).events;
    auto shorter = longer;
    if (name == "ended by time")
      shorter.sequence.end_s = 0.5 * (events[0].begin_s + events[1].begin_s);
    else
      shorter.sequence.max_events = longer.sequence.max_events - 1;
    EXPECT_LT(start_sequence(extended, shorter).events.size(), events.size());
    const auto go_on = [&](const input::Case& config, const SessionHooks& hooks = undisturbed) {
      results::ResultFolder held(extended, run_work);
      const auto problem = make_problem(config);
      if (!is_done(held, &problem)) resume(held, &problem, test::with_threads(1), hooks);
    };
    go_on(shorter);  // there is nothing to do
    auto other = longer, healed = longer;
    other.time.quiet_s *= 2;
    healed.sequence.healing_per_e_fold += 0.01;
    EXPECT_THAT(error_of([&] { go_on(other); }), HasSubstr("is another case"));
    if (has_static_coefficient(longer.friction)) {
      EXPECT_THAT(error_of([&] { go_on(healed); }), HasSubstr("is another case"));
    }
    const auto part = extended / "events/0001/energy.csv";
    const auto content = test::read_file(part);
    test::write_file(part, content + "1");
    EXPECT_THAT(error_of([&] { go_on(longer); }), HasSubstr("energy.csv"));
    test::write_file(part, content);
    EXPECT_THROW(go_on(longer, stopping_at(fmt::format("event {}", events.size()), 100)), Interrupted);
    EXPECT_TRUE(is_complete(extended));  // what it was
    go_on(longer);
    const auto all = tables_in(extended);
    auto expected = tables_in(whole), found = all;
    for (auto* tables : {&expected, &found})  // others name the case, whose end is another one
      std::erase_if(*tables, [](const auto& file) { return !file.first.ends_with(".csv"); });
    EXPECT_EQ(found, expected);
    EXPECT_TRUE(is_complete(extended));
    EXPECT_THAT(error_of([&] { go_on(shorter); }), HasSubstr("is another case"));
    auto global = longer;
    global.sequence.to_global_sliding = true;
    EXPECT_THAT(error_of([&] { go_on(global); }), HasSubstr("is another case"));
    EXPECT_EQ(tables_in(extended), all);
    fs::remove(extended / "events/0001/energy.csv");
    EXPECT_THAT(error_of([&] { go_on(longer); }), HasSubstr("events/0001/energy.csv: is missing"));
  }
}

TEST(Sequence, SlowSlipThatNoEventEndsNeedsAnEnd) {
  auto config = rate_and_state_case(2);
  const double a = config.friction.parameter("a");
  const auto refused = [&] { return error_of([&] { setup::check(make_problem(config)); }); };
  config.friction.parameter("b") = a;
  EXPECT_THAT(refused(), HasSubstr("no event comes; choose sequence.end_s"));
  // Along x what counts is the weakest.
  const auto along_x = [&](double a_at_end) {
    auto& friction = config.friction_along_x;
    friction.file = "a.csv";
    friction.table = {"x_m,a", {0, config.plate.width_m}, {"a"}, {{a, a_at_end}}};
  };
  along_x(2 * a);
  EXPECT_THAT(refused(), HasSubstr("no event comes"));
  along_x(0.5 * a);
  setup::check(make_problem(config));
  along_x(2 * a);
  config.sequence.end_s = 10;
  setup::check(make_problem(config));
  config.sequence.end_s = infinity;
  config.sequence.path = {{10}, {1e-6}};
  setup::check(make_problem(config));
}

/// Friction that strengthens: rows come until the time at which it ends.
TEST_F(SequenceInAFolder, LongSlowSlipTellsHowFarItHasCome) {
  auto config = rate_and_state_case(2);
  config.plate = {.width_m = 0.01, .height_m = 5e-3, .element_size_m = 1e-3, .corner = mesh::Corner::none};
  config.loading.edge_margin_m = 1e-3;
  config.friction.parameter("b") = 0.005;
  config.sequence.end_s = 1e5;
  std::vector<std::string> notes;
  SessionHooks hooks = undisturbed;
  hooks.note = [&](const std::string& note) { notes.push_back(note); };
  start_sequence(dir_, config, hooks);
  EXPECT_THAT(notes, ::testing::Contains(HasSubstr("slow slip before event 1: 4096 rows to ")));
}

TEST_F(SequenceInAFolder, IsTheSameAfterItWasStoppedBetweenTwoEvents) {
  bool stop = false;
  SessionHooks hooks = undisturbed;
  hooks.request = [&] { return stop ? Request::stop : Request::none; };
  hooks.event_done = [&](std::size_t number, const record::SequenceEvent&) { stop = number == 2; };
  EXPECT_THROW(start_sequence(dir_, sequence_case(3), hooks), Interrupted);
  expect_same_as_whole(sequence_case(3));
}

TEST_F(SequenceInAFolder, SlowSlipThatWasChangedIsRefused) {
  const auto slow = unfinished_ / "slow/0001/interface.h5";
  stop(rate_and_state_case(2), "event 2", 10);
  const auto content = test::read_file(slow);
  test::write_file(slow, content.substr(0, content.size() / 2));
  expect_refused("was changed since it was finished");
  fs::remove(slow);
  expect_refused("was changed since it was finished");
  test::write_file(slow, content);
  finish();
}

TEST_F(SequenceInAFolder, APartThatIsDamagedWhileALaterOneRunsIsNotPublished) {
  for (const char* part :
       {"slow/0001/interface.h5", "events/0001/energy.csv", "events/0001/checksums.sha256"}) {
    fs::remove_all(dir_);
    auto hooks = undisturbed;
    hooks.progress = [&, damaged = false](const char* now, std::int64_t, std::int64_t) mutable {
      if (damaged || now != std::string("event 2")) return;
      test::write_file(unfinished_ / part, test::read_file(unfinished_ / part).substr(0, 100));
      damaged = true;
    };
    EXPECT_THROW(start_sequence(dir_, rate_and_state_case(2), hooks), WriteError) << part;
    EXPECT_FALSE(fs::exists(dir_ / "sequence.json"));
    EXPECT_THAT(test::read_file(unfinished_ / "sequence.json"), HasSubstr("\"failed\""));
  }
}

/// As if the program had been killed before the event's first checkpoint.
TEST_F(SequenceInAFolder, AnEventWithoutACheckpointBeginsAnew) {
  stop(sequence_case(2), "event 2", 10);
  const auto state = unfinished_ / "state";
  std::vector<fs::path> checkpoints;
  for (const auto& entry : fs::directory_iterator(state))
    if (entry.path().filename().string().starts_with("checkpoint")) checkpoints.push_back(entry.path());
  ASSERT_EQ(checkpoints.size(), 2U);  // behind the first event, and in the second
  fs::remove(std::ranges::max(checkpoints));
  test::write_file(unfinished_ / "events/0002/fields.vtkhdf", "left by it");
  expect_same_as_whole(sequence_case(2));
}

TEST_F(SequenceInAFolder, WhatTheFirstEventHasComeToIsKept) {
  const WriteError full("the disk is full");
  EXPECT_THROW(start_sequence(dir_, sequence_case(2), failing_in("event 1", 200, full)), WriteError);
  EXPECT_TRUE(fs::exists(unfinished_ / "events/0001/interface.h5"));
  expect_same_as_whole(sequence_case(2));
}

TEST_F(SequenceInAFolder, SlowSlipGoesOnWhereItWasStopped) {
  const auto config = rate_and_state_path(2);
  std::vector<std::size_t> n_asked;
  for (const int stop_at : {40, 300}) {
    fs::remove_all(dir_);
    fs::remove_all(folder_ / "whole");
    int n = 0;
    SessionHooks hooks = undisturbed;
    hooks.request = [&] { return ++n == stop_at ? Request::stop : Request::none; };
    EXPECT_THROW(start_sequence(dir_, config, hooks), Interrupted);
    EXPECT_FALSE(fs::exists(unfinished_ / "events/0001"));
    hooks.request = [&] { return ++n, Request::none; };
    n = 0;
    results::ResultFolder held(dir_, run_work);
    resume(held, nullptr, test::with_threads(1), hooks);
    n_asked.push_back(static_cast<std::size_t>(n));
    start_sequence(folder_ / "whole", config);
    EXPECT_EQ(tables_in(dir_), tables_in(folder_ / "whole")) << stop_at;
  }
  EXPECT_GT(n_asked[0], n_asked[1] + 200);  // what was slipped before is not slipped again
}

TEST_F(SequenceInAFolder, WhatTheFirstSlowSlipHasComeToIsKept) {
  SessionHooks failing = undisturbed;
  int n_asked = 0;
  failing.request = [&] {
    if (++n_asked == 50) throw WriteError("the disk is full");
    return Request::none;
  };
  EXPECT_THROW(start_sequence(dir_, rate_and_state_case(2), failing), WriteError);
  EXPECT_TRUE(fs::exists(unfinished_ / "slow/0001/interface.h5"));
  expect_same_as_whole(rate_and_state_case(2));
}

TEST_F(SequenceInAFolder, FinishedEventsThatWereChangedAreRefused) {
  const auto events = unfinished_ / "events";
  stop(sequence_case(3), "event 3", 100);
  const auto swap = [&] {
    fs::rename(events / "0001", events / "other");
    fs::rename(events / "0002", events / "0001");
    fs::rename(events / "other", events / "0002");
  };
  swap();
  expect_refused("0001: was changed since it was finished");
  swap();
  fs::rename(events / "0002", folder_ / "0002");
  expect_refused("0002: was changed since it was finished");
  fs::rename(folder_ / "0002", events / "0002");
  const auto text = test::read_file(events / "0001/energy.csv");
  test::write_file(events / "0001/energy.csv", text + "1");
  expect_refused("energy.csv");
  test::write_file(events / "0001/energy.csv", text);
  finish();
  fs::remove(dir_ / "events/0003/interface.h5");
  EXPECT_FALSE(is_complete(dir_));
}

TEST_F(SequenceInAFolder, CountsTheSessionsThatWereKilled) {
  EXPECT_THROW(start_sequence(dir_, sequence_case(3), failing_in("event 1", 100, Killed())), Killed);
  for (const char* event : {"event 1", "event 2", "event 2"})
    EXPECT_THROW(resume_sequence_in(dir_, failing_in(event, 100, Killed())), Killed);
  resume_sequence_in(dir_);
  EXPECT_EQ(sessions_of(dir_ / sequence_file), 5);
  // Those of the sequence until the event has ended.
  EXPECT_EQ(sessions_of(dir_ / "events/0001" / run_file), 3);
  EXPECT_EQ(sessions_of(dir_ / "events/0002" / run_file), 5);
  EXPECT_EQ(sessions_of(dir_ / "events/0003" / run_file), 5);
}

TEST_F(SequenceInAFolder, WhatIsInTheWayIsRefusedBeforeAnythingIsComputed) {
  stop(sequence_case(3), "event 2", 100);
  fs::create_directories(dir_ / "events/0001");
  test::write_file(dir_ / "events/0001/run.json", "mine");
  const auto found = error_of([&] { resume_sequence_in(dir_, failing_in("event 2", 0, Killed())); });
  EXPECT_THAT(found, HasSubstr("0001/run.json: is not of earlier results"));
  EXPECT_EQ(error_of([&] { start_sequence(dir_, sequence_case(3), failing_in("event 1", 0, Killed())); }),
            found);
  fs::remove_all(dir_ / "events");
  finish();
}

TEST_F(SequenceInAFolder, PagesOfAPartOfItAreNoResults) {
  stop(sequence_case(2), "event 2", 100);
  for (const auto& place : {dir_, unfinished_})
    test::write_file(place / "report.html", "<!DOCTYPE html><!-- slipfront report -->\n");
  finish();
  EXPECT_FALSE(fs::exists(dir_ / "report.html"));
}

TEST_F(SequenceInAFolder, AnEventThatDoesNotComeToRestIsRefusedAndKept) {
  auto config = sequence_case(12);
  config.time.end_s = 0.5e-3;
  EXPECT_THAT(error_of([&] { start_sequence(dir_, config); }),
              HasSubstr("event 1 has not come to rest: time.end_s = 0.0005 s was reached"));
  const auto info = nlohmann::json::parse(test::read_file(unfinished_ / sequence_file));
  EXPECT_EQ(info["status"], "failed");
  EXPECT_EQ(info["events"], 0);
  EXPECT_TRUE(fs::exists(unfinished_ / "events/0001/interface.h5"));
}

TEST_F(SequenceInAFolder, AnEventIsGoneOnWithAsPartOfItsSequenceAlone) {
  stop(sequence_case(2), "event 1", 100);
  EXPECT_THAT(error_of([&] { results::ResultFolder held(unfinished_ / "events/0001", run_work); }),
              HasSubstr("another run keeps"));
}

TEST(Sequence, StrengthGrowsWithTheTimeAtRest) {
  auto config = sequence_case(5, 1.0);
  config.sequence.healing_per_e_fold = 0.02;
  config.sequence.healing_time_s = 2;
  const double mu_s = test::law(config).mu_s;
  Sequence sequence(make_problem(config), test::go_on);
  std::vector<double> slipped_at_s;  // [nodes]
  while (sequence.end().empty()) {
    const auto* initial = sequence.next();
    const double now_s = initial->critical_shear_m / make_problem(config).shear_speed_m_per_s;
    const auto& x_m = initial->subcritical.tractions.x_m;
    slipped_at_s.resize(x_m.size());
    const auto laws = friction_at(make_problem(config), x_m, initial->healed);
    double nearest = 0;
    for (std::size_t k = 0; k < x_m.size(); ++k) {
      const double grown = mu_s + 0.02 * std::log(1 + (now_s - slipped_at_s[k]) / 2);
      EXPECT_NEAR(laws[k].parameter("mu_s"), grown, 1e-8) << k;
      const auto& s = initial->supercritical;
      if (s.is_inside(x_m[k]))
        nearest =
            std::max(nearest, s.tractions.t_s_Pa[k] / (s.tractions.p_s_Pa[k] * laws[k].parameter("mu_s")));
    }
    EXPECT_NEAR(nearest, 1 + config.loading.critical_margin, 1e-6);
    const auto result = run_from(make_problem(config), *initial, test::go_on);
    sequence.record_event(result);
    const double rests_s = sequence.loading().back().time_s;
    for (const auto& onset : result.event.record.onsets) slipped_at_s[onset.node] = rests_s;
  }
  expect_balance(sequence.loading(), 1e-10 * largest_work(sequence.loading()));
  // Without healing the same comes earlier.
  config.sequence.healing_per_e_fold = 0;
  Sequence strong_at_once(make_problem(config), test::go_on);
  strong_at_once.next();
  EXPECT_LT(strong_at_once.loading().back().time_s, sequence.events().front().begin_s);
}

TEST(Sequence, AHoldDelaysWhatFollows) {
  auto config = sequence_case(3);
  Sequence straight(make_problem(config), test::go_on);
  run_all(straight, config);
  const double v = make_problem(config).shear_speed_m_per_s, first_s = straight.events()[0].begin_s;
  const double hold_from_s = 0.5 * first_s, hold_s = 1000;
  config.sequence.path = {{hold_from_s, hold_from_s + hold_s, 1e6 + hold_s},
                          {v * hold_from_s, v * hold_from_s, v * 1e6}};
  Sequence held(make_problem(config), test::go_on);
  run_all(held, config);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(held.events()[k].shear_m, straight.events()[k].shear_m, 1e-12) << k;
    EXPECT_NEAR(held.events()[k].begin_s, straight.events()[k].begin_s + hold_s, 1e-3) << k;
  }
  config.sequence.max_events = 100;
  config.sequence.path = {{hold_from_s}, {v * hold_from_s}};
  Sequence ended(make_problem(config), test::go_on);
  EXPECT_EQ(ended.next(), nullptr);
  EXPECT_DOUBLE_EQ(ended.loading().back().time_s, hold_from_s);
  EXPECT_DOUBLE_EQ(ended.loading().back().shear_m, v * hold_from_s);
}

/// Slide, hold, slide: the force relaxes as slip goes on, and the surfaces have aged for what follows.
TEST(Sequence, InAHoldTheForceRelaxesUnderALawWithAState) {
  auto config = rate_and_state_case(2);
  const double v = make_problem(config).shear_speed_m_per_s;
  Sequence straight(make_problem(config), test::go_on);
  straight.next();
  const auto first = straight.loading().back();
  const double hold_from_s = 0.9 * first.time_s, hold_s = 100;
  config.sequence.path = {{hold_from_s, hold_from_s + hold_s, hold_from_s + 2 * hold_s},
                          {v * hold_from_s, v * hold_from_s, v * (hold_from_s + hold_s)}};
  Sequence held(make_problem(config), test::go_on);
  // Mean tractions in the hold, as it begins and as it ends.
  double first_Pa = 0, last_Pa = 0;
  const auto* initial = held.next([&](const record::History& row) {
    const double time_s = row.time_s.front(), ends_Pa = 0.5 * (row.t_Pa.front() + row.t_Pa.back());
    const double sum_Pa = std::reduce(row.t_Pa.begin(), row.t_Pa.end()) - ends_Pa;
    if (time_s < hold_from_s || time_s > hold_from_s + hold_s) return;
    if (first_Pa == 0) first_Pa = sum_Pa;
    last_Pa = sum_Pa;
  });
  ASSERT_NE(initial, nullptr);
  const auto& rows = held.loading();
  // A row where it has turned, within a hundredth of a of the peak at which the hold begins.
  const auto turned = std::ranges::find_if(rows, [&](const auto& row) { return row.time_s > hold_from_s; });
  const auto peak = std::ranges::max_element(rows, {}, [&](const LoadingRow& row) {
    return row.time_s < hold_from_s + 0.5 * hold_s ? row.shear_over_normal : 0;
  });
  ASSERT_NE(turned, rows.end());
  EXPECT_LT(peak->shear_over_normal - turned->shear_over_normal, 2e-4);
  EXPECT_LT(last_Pa, (1 - 3e-5) * first_Pa);
  EXPECT_GT(rows.back().time_s, hold_from_s + hold_s);
  EXPECT_GT(rows.back().shear_over_normal, first.shear_over_normal + 1e-4);  // the aged surfaces are stronger
  expect_balance(rows, 1e-10 * largest_work(rows));
}

TEST(Sequence, SlowSlipLeadsToEventsUnderALawWithAState) {
  const auto config = rate_and_state_case(4);
  Sequence sequence(make_problem(config), test::go_on);
  const double rate_m_per_s = inertia_slip_rate_m_per_s(make_problem(config));
  while (sequence.end().empty()) {
    std::vector<double> psi_before;
    double time_s = -1;
    const auto* initial = sequence.next([&](const record::History& row) {
      psi_before = row.law_states.front();
      EXPECT_GT(row.time_s.front(), std::exchange(time_s, row.time_s.front()));
    });
    ASSERT_NE(initial, nullptr);
    EXPECT_EQ(initial->law_states.front(), psi_before);
    const auto& begins = sequence.loading().back();
    EXPECT_EQ(begins.phase, LoadingPhase::event_begins);
    EXPECT_GE(begins.fastest_slip_rate_m_per_s, rate_m_per_s);
    EXPECT_LE(begins.fastest_slip_rate_m_per_s, 1.1 * rate_m_per_s);
    const auto result = run_from(make_problem(config), *initial, test::go_on);
    // It goes on from the slip rates and the state with which slow slip has ended.
    const auto history = test::history_of(result);
    const std::size_t n = history.x_m.size();
    double fastest = 0;
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_NEAR(history.law_states.front()[k], psi_before[k], 1e-12);
      fastest = std::max(fastest, history.slip_rate_m_per_s[k]);
    }
    EXPECT_NEAR(fastest / begins.fastest_slip_rate_m_per_s, 1, 0.1);
    sequence.record_event(result);
  }
  const auto& rows = sequence.loading();
  EXPECT_GT(std::ranges::count(rows, LoadingPhase::creep, &LoadingRow::phase), 20);
  expect_balance(rows, 1e-10 * largest_work(rows));
  for (const auto& row : rows)
    EXPECT_NEAR(row.time_s, row.shear_m / make_problem(config).shear_speed_m_per_s, 1e-9 * row.time_s);
  // Stick-slip: the force falls in each of the last events, and slip comes to metres a second.
  const auto& events = sequence.events();
  for (std::size_t k = 2; k < events.size(); ++k) {
    EXPECT_EQ(events[k].is_global, 1) << k;
    EXPECT_LT(events[k].friction_after, events[k].friction_before - 0.01) << k;
    EXPECT_GT(events[k].begin_s, events[k - 1].begin_s + 1) << k;
  }
}

TEST(Sequence, TimesOfEventsDependLittleOnTheSlipRateAtWhichInertiaCounts) {
  std::vector<double> last_s;
  for (const double factor : {0.5, 1.0, 2.0}) {
    auto config = rate_and_state_case(4);
    config.sequence.inertia_slip_rate_m_per_s = factor * inertia_slip_rate_m_per_s(make_problem(config));
    Sequence sequence(make_problem(config), test::go_on);
    run_all(sequence, config);
    last_s.push_back(sequence.events().back().begin_s);
  }
  EXPECT_NEAR(last_s[0] / last_s[1], 1, 0.01);
  EXPECT_NEAR(last_s[2] / last_s[1], 1, 0.01);
}

}  // namespace
}  // namespace slipfront::run
