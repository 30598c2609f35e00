// SPDX-License-Identifier: BSD-3-Clause
#include "run/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cases.hpp"
#include "files/checksum.hpp"
#include "input/schema.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "problem/source.hpp"
#include "run/checkpoint.hpp"
#include "sessions.hpp"
#include "support/files.hpp"
#include "support/interruption.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;
using problem::make_problem;
using test::coarse_case;
using test::error_of;
using test::prestressed_case;
using test::stopping_at;
using test::undisturbed;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// All files of a folder but its checksums; of run.json all but what measures or counts sessions.
std::map<std::string, std::string> results_in(const fs::path& dir) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(dir))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), dir).string()] = test::read_file(entry.path());
  files.erase(files::checksum_list);
  files.erase(".slipfront.lock");
  auto run = nlohmann::json::parse(files.at("run.json"));
  for (const char* key : {"wall_s", "node_updates_per_s", "sessions"}) run.erase(key);
  run["statics"].erase("wall_s");
  files["run.json"] = run.dump();
  return files;
}

void expect_same(const std::map<std::string, std::string>& files,
                 const std::map<std::string, std::string>& expected) {
  EXPECT_EQ(files.size(), expected.size());
  for (const auto& [name, bytes] : expected)
    EXPECT_TRUE(files.contains(name) && files.at(name) == bytes) << name;
}

Finished start(const fs::path& dir, const input::Case& config, const SessionHooks& hooks = undisturbed) {
  results::ResultFolder held(dir, run_work);
  return run_into(held, make_problem(config), test::with_threads(1), hooks);
}

Finished resume(const fs::path& dir, const SessionHooks& hooks = undisturbed,
                const input::Case* expected = nullptr, int threads = 1) {
  results::ResultFolder held(dir, run_work);
  std::optional<Problem> compared;
  if (expected != nullptr) compared = make_problem(*expected);
  return run::resume(held, compared ? &*compared : nullptr, test::with_threads(threads), hooks);
}

/// Results of a whole run.
std::map<std::string, std::string> results_of(const input::Case& config) {
  const test::TemporaryFolder folder;
  start(folder.path(), config);
  return results_in(folder.path());
}

/// One case of each kind of state that has to be kept.
std::vector<std::pair<const char*, input::Case>> kinds() {
  std::vector<std::pair<const char*, input::Case>> list;
  const auto add = [&](const char* name, input::Case config, auto&& change) {
    change(config);
    config.output.snapshot_times_s = {0, 20e-6, 90e-6};
    config.output.snapshot_interval_s = 35e-6;
    config.output.energy_interval_s = 7e-6;
    config.probes.x_m = {0.1013, 0.0507, 0.15, 0.033};
    config.probes.y_m = {0, 0.0123, 0.1, has_base_body(config) ? -0.02 : 0.07};
    config.probes.interval_s = 1.7e-6;
    config.output.moment_rate = true;
    list.emplace_back(name, config);
  };
  using interface::EventKind;
  add("left, relief", coarse_case(EventKind::left), [](input::Case& c) {
    c.trigger.duration_s = 30e-6;
    c.plate.corner = mesh::Corner::relief;
  });
  add("fillet, plain step", coarse_case(), [](input::Case& c) {
    c.plate.corner = mesh::Corner::fillet;
    c.time.interface_substeps = 1;
  });
  add("predictor-corrector", coarse_case(), [](input::Case& c) {
    c.contact = interface::ContactAlgorithm::predictor_corrector;
    c.friction = interface::VelocityWeakening { .mu_k = 1.0 };
  });
  add("delayed strength", coarse_case(), [](input::Case& c) {
    c.regularisation.relaxed = interface::Relaxed::strength;
    c.regularisation.time_s = 1e-6;
  });
  add("delayed pressure", coarse_case(), [](input::Case& c) {
    c.regularisation.relaxed = interface::Relaxed::pressure;
    c.regularisation.length_m = 1e-6;
    c.regularisation.slip_rate_m_per_s = 0.1;
  });
  add("friction by a table", prestressed_case(), [](input::Case& c) {
    test::set_table(c, "x_m,mu_k\n0,0.6\n0.1,0.5\n0.15,0.7\n0.2,0.7\n");
    c.friction_along_x.between_rows = input::BetweenRows::stepwise;
  });
  add("random friction", prestressed_case(), [](input::Case& c) {
    c.friction = interface::SlipWeakening {};
    c.friction_along_x.random_key = "d_c_m";
  });
  add("patch weakened", prestressed_case(),
      [](input::Case& c) { c.nucleation.form = interface::NucleationForm::weakened; });
  add("two bodies", prestressed_case(), [](input::Case& c) {
    c.base.kind = input::BaseKind::body;
    c.base.plate.height_m = 0.05;
    c.base.plate.sides = mesh::Sides::periodic;
    c.base.material = {.youngs_modulus_Pa = 9e9, .density_kg_per_m3 = 2000, .stiffness_damping_s = 0};
    c.friction = interface::SlipWeakening {};
  });
  add("absorbing", prestressed_case(), [](input::Case& c) {
    c.plate.sides = mesh::Sides::absorbing;
    c.plate.top = mesh::Top::absorbing;
  });
  add("graded", coarse_case(), [](input::Case& c) {
    c.plate.coarsenings = 1;
    c.plate.fine_height_m = 0.04;
  });
  add("single precision", coarse_case(),
      [](input::Case& c) { c.time.precision = motion::Precision::single_precision; });
  add("plain stepper", coarse_case(), [](input::Case& c) { c.time.stepper = motion::StepperKind::plain; });
  return list;
}

TEST(Session, GoesOnAsIfItHadNeverStopped) {
  for (const auto& [name, config] : kinds()) {
    SCOPED_TRACE(name);
    const auto expected = results_of(config);
    {
      const test::TemporaryFolder folder;
      EXPECT_EQ(start(folder.path(), config, stopping_at("event", 50)).last.result.event.end,
                motion::EventEnd::interrupted);
      EXPECT_EQ(resume(folder.path(), stopping_at("event", 100), nullptr, 2).last.result.event.steps, 100);
      resume(folder.path(), undisturbed, &config);
      expect_same(results_in(folder.path()), expected);
      EXPECT_EQ(nlohmann::json::parse(test::read_file(folder / "run.json"))["sessions"], 3);
      files::require_intact(folder.path());
    }
    // From a step at which it is not asked as a rule.
    const test::TemporaryFolder folder;
    std::optional<test::InterruptionAfter> after;
    auto hooks = undisturbed;
    hooks.progress = [&](const char*, std::int64_t, std::int64_t) {
      if (!after) after.emplace(22);
    };
    hooks.request = [&] { return after && after->is_wanted() ? Request::stop : Request::none; };
    const auto begun = start(folder.path(), config, hooks);
    EXPECT_EQ(begun.last.result.event.end, motion::EventEnd::interrupted);
    EXPECT_NE(begun.last.result.event.steps % 50, 0);
    after.reset();
    resume(folder.path());
    expect_same(results_in(folder.path()), expected);
  }
}

TEST(Session, GoesOnWithARamp) {
  const auto config = test::ramped_case();
  const test::TemporaryFolder folder;
  std::int64_t total = 0;
  auto hooks = stopping_at("ramp", 2000);
  hooks.progress = [&, inner = hooks.progress](const char* part, std::int64_t step, std::int64_t n) {
    total = n;
    inner(part, step, n);
  };
  EXPECT_THROW(start(folder.path(), config, hooks), Interrupted);
  // Behind the common state, which then has to be kept as well.
  EXPECT_THROW(resume(folder.path(), stopping_at("ramp", total - 1000)), Interrupted);
  resume(folder.path());
  expect_same(results_in(folder.path()), results_of(config));
}

/// An interrupted run with two checkpoints.
class InterruptedRun : public testing::Test {
 protected:
  InterruptedRun() {
    results::ResultFolder held(folder_.path(), run_work);
    auto options = test::with_threads(1);
    options.keep_every_s = 20e-6;
    run_into(held, make_problem(config_), options, stopping_at("event", 100));
  }
  std::vector<fs::path> checkpoints() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_ / "unfinished/state"))
      if (entry.path().filename().string().starts_with("checkpoint-")) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  std::string resume_error(const input::Case* expected = nullptr) {
    return error_of([&] {
      auto hooks = undisturbed;
      hooks.note = [&](const std::string& note) { notes_ += note; };
      resume(folder_.path(), hooks, expected);
    });
  }
  input::Case config_ = coarse_case();
  test::TemporaryFolder folder_;
  std::string notes_;
};

TEST_F(InterruptedRun, TakesTheCheckpointBeforeADamagedOne) {
  ASSERT_EQ(checkpoints().size(), 2U);  // the last ones
  const auto last = checkpoints().back();
  auto bytes = test::read_file(last);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  test::write_file(last, bytes);
  EXPECT_EQ(resume_error(), test::accepted);
  EXPECT_THAT(notes_, HasSubstr("is damaged"));
  expect_same(results_in(folder_.path()), results_of(config_));
}

TEST(Session, AddsTheWallTimeOfItsSessions) {
  constexpr double slept_s = 0.1;  // longer than the steps take
  const test::TemporaryFolder folder;
  auto options = test::with_threads(1);
  options.keep_every_s = 20e-6;
  auto hooks = stopping_at("event", 100);
  hooks.progress = [=, inner = hooks.progress](const char* part, std::int64_t step, std::int64_t n) {
    std::this_thread::sleep_for(std::chrono::duration<double>(slept_s));
    inner(part, step, n);
  };
  {
    results::ResultFolder held(folder.path(), run_work);
    run_into(held, make_problem(coarse_case()), options, hooks);
  }
  EXPECT_GT(resume(folder.path(), stopping_at("event", 101)).last.result.stepping_wall_s, slept_s);
}

TEST_F(InterruptedRun, BeginsAnewWithoutAnyCheckpoint) {
  for (const auto& file : checkpoints()) fs::remove(file);
  EXPECT_EQ(resume_error(), test::accepted);
  expect_same(results_in(folder_.path()), results_of(config_));
}

TEST_F(InterruptedRun, RefusesAnotherCase) {
  auto other = config_;
  other.friction = interface::VelocityWeakening { .mu_k = 0.8 };
  EXPECT_THAT(resume_error(&other),
              HasSubstr("is another case than the one that was begun, which has \"mu_k = "));
  const auto file = folder_ / "unfinished/case.resolved.toml";
  test::write_file(file, input::to_toml(other));
  EXPECT_THAT(resume_error(), StartsWith(file.string() + ": is another case"));
}

TEST(Session, RefusesAnotherTableOfFriction) {
  const test::TemporaryFolder folder;
  auto config = prestressed_case();
  test::set_table(config, "x_m,mu_k\n0,0.6\n0.2,0.7\n");
  start(folder.path(), config, stopping_at("event", 50));
  const auto unfinished = folder / "unfinished", file = unfinished / problem::friction_file;
  test::write_file(file, "x_m,mu_k\n0,0.6\n0.2,0.8\n");
  EXPECT_EQ(error_of([&] { resume(folder.path()); }),
            file.string() + ": was changed since the run was begun; restore it, or start a new run");
  EXPECT_THAT(error_of([&] {
                require_same_case(make_problem(config).source, problem::read_problem(unfinished).source);
              }),
              HasSubstr("the table of its friction: is another case"));
}

TEST_F(InterruptedRun, RefusesAnotherProgram) {
  Checkpoints checkpoints(folder_ / "unfinished/state");
  CheckpointHead head;
  head.program = "slipfront 0.0.1";
  checkpoints.keep(head, [](results::OutputArchive&) {});
  EXPECT_EQ(this->checkpoints().size(), 2U);  // the oldest has gone
  EXPECT_THAT(resume_error(), HasSubstr("was begun by slipfront 0.0.1, and this is slipfront "));
}

TEST_F(InterruptedRun, RefusesAStateThatDoesNotFit) {
  auto kept = Checkpoints(folder_ / "unfinished/state").last([](const std::string&) {});
  ASSERT_TRUE(kept);
  double spent_s = 0;
  kept->body(spent_s);
  const InitialState whole = read_initial_state(kept->body, make_problem(config_));
  const auto keep = [&](auto... parts) {
    Checkpoints(folder_ / "unfinished/state").keep(kept->head, [&](results::OutputArchive& archive) {
      archive(spent_s, parts...);
    });
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<const char*, std::function<void(InitialState&)>> changes[] = {
      {"a plate", [](InitialState& s) { s.tributary_m.pop_back(); }},
      {"a plate", [](InitialState& s) { ++s.n_nodes; }},
      {"an initial state", [](InitialState& s) { s.subcritical.contact.pop_back(); }},
      {"an initial state", [](InitialState& s) { s.subcritical.contact[1] = statics::Contact{7}; }},
      {"an initial state", [](InitialState& s) { s.subcritical.tractions.x_m[1] *= 1.01; }},
      {"an initial state", [](InitialState& s) { s.supercritical.tractions.p_s_Pa.pop_back(); }},
      {"an initial state", [](InitialState& s) { s.supercritical.tractions.t_s_Pa[1] = nan; }},
      {"an initial state", [](InitialState& s) { s.supercritical.u_m.x.push_back(0); }},
      {"an initial state", [](InitialState& s) { s.critical_shear_m = nan; }},
      {"an initial state", [](InitialState& s) {
         s.ramp.emplace(motion::Ramp{s.subcritical, s.supercritical, {}, 0, false});
       }}};
  for (const auto& [what, change] : changes) {
    InitialState initial = whole;
    change(initial);
    keep(initial);
    EXPECT_EQ(resume_error(), fmt::format("{}: the saved state has {} of another case, or was changed; start "
                                          "a new run",
                                          checkpoints().back().string(), what));
  }
  keep(whole, std::vector<double>(7));  // another event's state
  EXPECT_NE(resume_error(), test::accepted);
}

TEST_F(InterruptedRun, RefusesAHistoryThatIsShorterThanItWas) {
  fs::resize_file(folder_ / "unfinished/interface.h5", 80);
  EXPECT_THAT(resume_error(), HasSubstr("is shorter than at the last checkpoint"));
}

TEST(Session, ThereMustBeARunToGoOnWith) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { resume(folder.path()); }), HasSubstr("holds no unfinished run"));
}

TEST(Session, TellsHowItStands) {
  const test::TemporaryFolder folder;
  const auto file = folder / "unfinished/run.json";
  auto hooks = stopping_at("event", 50);
  std::string status;
  hooks.request = [&, inner = hooks.request] {
    if (fs::exists(file)) status = nlohmann::json::parse(test::read_file(file))["status"];
    return inner();
  };
  start(folder.path(), coarse_case(), hooks);
  EXPECT_EQ(status, "running");
  const auto run = nlohmann::json::parse(test::read_file(file));
  EXPECT_EQ(run["status"], "interrupted");
  EXPECT_THAT(run["reason"].get<std::string>(), StartsWith("interrupted at t = "));
}

TEST(SuitableThreads, AreOneForSmallPlates) {
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  EXPECT_EQ(suitable_threads(make_problem(test::coarse_case(interface::EventKind::left, 1e-3))), 1);
  EXPECT_EQ(suitable_threads(make_problem(test::coarse_case(interface::EventKind::left, 2.0 / 3e3))),
            std::min(2, processors));
  EXPECT_EQ(suitable_threads(make_problem(test::coarse_case(interface::EventKind::left, 1e-4))),
            std::min(4, processors));
}

}  // namespace
}  // namespace slipfront::run
