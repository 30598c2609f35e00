// SPDX-License-Identifier: BSD-3-Clause
#include "advice/needs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "advice/info.hpp"
#include "cases.hpp"
#include "interface/friction/rate_and_state.hpp"

namespace slipfront::run {
namespace {

using problem::make_problem;
using test::coarse_case;
using test::error_of;
using test::go_on;
using ::testing::AllOf;
using ::testing::HasSubstr;

advice::Needs needs_of(const input::Case& config) {
  return advice::needs(make_problem(config), advice::estimated_size(make_problem(config)));
}

TEST(Needs, DiskIsWhatTheFilesTake) {
  // Of 2 mm: files whose heads are small.
  auto config = coarse_case(interface::EventKind::spontaneous, 2e-3);
  config.time.quiet_s = 1;
  config.time.end_s = 1e-3;
  config.output.history_interval_s = 2e-6;
  config.output.snapshot_times_s = {0, 10e-6, 20e-6, 30e-6, 40e-6};
  const test::TemporaryFolder folder;
  const auto initial = setup::make_initial_state(make_problem(config), go_on);
  write(folder.path(), run_from(make_problem(config), initial, go_on), initial);
  const auto size_of = [&](const char* name) {
    return static_cast<double>(std::filesystem::file_size(folder / name));
  };
  const advice::Needs n = needs_of(config);
  EXPECT_NEAR(n.of(results::history_output).bytes / size_of("interface.h5"), 1, 0.3);
  EXPECT_NEAR(n.of(results::snapshot_output).bytes / size_of("fields.vtkhdf"), 1, 0.3);
  EXPECT_NEAR(n.energy_bytes / size_of("energy.csv"), 1, 0.3);
}

TEST(Needs, EstimatesAgreeWithTheMesh) {
  auto config = coarse_case(interface::EventKind::spontaneous, 1e-3);
  const auto exact = advice::info(make_problem(config)).needs, estimated = needs_of(config);
  EXPECT_NEAR(estimated.memory_bytes() / exact.memory_bytes(), 1, 0.3);
  EXPECT_NEAR(static_cast<double>(estimated.steps) / static_cast<double>(exact.steps), 1, 0.3);
  const auto& history = results::history_output;
  EXPECT_NEAR(estimated.of(history).bytes / exact.of(history).bytes, 1, 0.3);
  config.base.kind = input::BaseKind::body;
  config.base.plate.height_m = config.plate.height_m;
  EXPECT_NEAR(needs_of(config).statics_bytes / estimated.statics_bytes, 2, 0.3);
}

TEST(Needs, OfOneAmongManyIsItsPart) {
  const auto config = coarse_case(interface::EventKind::left, 0.5e-3);
  const auto size = advice::estimated_size(make_problem(config));
  const auto of = [&](const advice::Holder& holder) {
    return advice::needs(make_problem(config), size, holder).memory_bytes();
  };
  EXPECT_LT(of({4, 1, false}), 0.5 * of({}));
  EXPECT_GT(of({4, 1, true}),
            advice::needs(make_problem(config), size).statics_bytes);  // which it solves alone
  EXPECT_GT(of({4, 4, true}), of({4, 1, true}));
}

TEST(Needs, CountTheStateOfAFrictionLaw) {
  auto config = coarse_case();
  const double without = needs_of(config).of(results::history_output).bytes;
  config.friction = interface::RateAndStateSlip {};
  EXPECT_NEAR(needs_of(config).of(results::history_output).bytes / without, 5.0 / 4,
              1e-2);  // but for the times
}

TEST(Info, OfRanksIsOfTheirSubdomains) {
  const auto config = coarse_case(interface::EventKind::left, 1e-3);
  const auto one = *advice::info(make_problem(config), 1).shared,
             three = *advice::info(make_problem(config), 3).shared;
  EXPECT_EQ(three.partition.n_subdomains(), 3);
  EXPECT_LT(three.memory_bytes, three.root_memory_bytes);
  EXPECT_LT(three.efficiency, one.efficiency);
  EXPECT_GT(three.bytes_per_step, 0);
  EXPECT_THROW(advice::info(make_problem(config), 1000), UserError);
}

TEST(Needs, CountTheStepsOfTheRamp) {
  auto config = coarse_case(interface::EventKind::left, 5e-3);
  EXPECT_EQ(needs_of(config).ramp_steps, 0);
  config.loading.method = statics::LoadingMethod::ramp;
  config.loading.shear_speed_m_per_s = 5e-3;
  const auto predicted = static_cast<double>(advice::info(make_problem(config)).needs.ramp_steps);
  EXPECT_NEAR(
      predicted / static_cast<double>(setup::make_initial_state(make_problem(config), go_on).ramp->steps), 1,
      0.3);
}

TEST(Needs, RefuseStepsBeyondCounting) {
  auto config = coarse_case(interface::EventKind::left);
  config.time.end_s = 1e9;
  EXPECT_THAT(error_of([&] { needs_of(config); }), HasSubstr("time.end_s = 1e+09 takes"));
  config.time.end_s = 1e-4;
  config.loading.method = statics::LoadingMethod::ramp;
  for (const double speed : {1e-20, 1e-300}) {
    config.loading.shear_speed_m_per_s = speed;
    EXPECT_THAT(error_of([&] { advice::info(make_problem(config)); }),
                HasSubstr("loading.shear_speed_m_per_s = 1e-"));
    EXPECT_THAT(error_of([&] { setup::make_initial_state(make_problem(config), go_on); }),
                HasSubstr("loading.shear_speed_m_per_s"));
  }
}

TEST(RequireFit, NamesWhatToChange) {
  const test::TemporaryFolder folder;
  const auto message = [&](const input::Case& config) {
    return error_of([&] { advice::require_fit(make_problem(config), folder / "to be/made"); });
  };
  auto config = coarse_case();
  EXPECT_EQ(message(config), test::accepted);
  config.time.end_s = 1e5;
  config.output.energy_interval_s = 1e5;
  EXPECT_THAT(message(config), AllOf(HasSubstr("GB on disk"), HasSubstr("output.history_interval_s")));
  config.output.history_interval_s = 1e5;
  EXPECT_EQ(message(config), test::accepted);
  config.output.energy_interval_s = 1e-6;
  EXPECT_THAT(message(config), AllOf(HasSubstr("of memory"), HasSubstr("output.energy_interval_s")));
  config.output.energy_interval_s = 1e5;
  for (int k = 0; k < 2'000'000; ++k) config.output.snapshot_times_s.push_back(1e-3 * k);
  config.plate.element_size_m = 0.5e-3;
  EXPECT_THAT(message(config), AllOf(HasSubstr("GB on disk"), HasSubstr("fewer output.snapshot_times_s")));
  EXPECT_FALSE(std::filesystem::exists(folder / "to be"));
  config.plate.element_size_m = 1e-6;
  config.time.end_s = 1e-4;
  EXPECT_THAT(message(config), AllOf(HasSubstr("of memory"), HasSubstr("plate.element_size_m")));
}

}  // namespace
}  // namespace slipfront::run
