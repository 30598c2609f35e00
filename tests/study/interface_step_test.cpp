// SPDX-License-Identifier: BSD-3-Clause
#include "study/interface_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/error.hpp"
#include "input/schema.hpp"
#include "support/files.hpp"

namespace slipfront::study {
namespace {

using Kind = Stepping::Kind;

input::Case coarse_case() {
  input::Case config;
  config.plate.element_size_m = 2.5e-3;
  config.fronts.l_star_m = 2.5e-3;
  config.event = interface::EventKind::left;
  return config;
}

TEST(InterfaceStepStudy, ChoosesTheCheapestOfWhatItTries) {
  const InterfaceStepOptions options{.rows = {2, 4, 400},  // the last does not fit
                                     .substeps = {4, 8},
                                     .tolerance = 0.1};
  const auto study =
      study_interface_step(coarse_case(), options, [](std::size_t, std::size_t) { return true; });
  const auto of = [&](Kind kind) {
    std::vector<Stepping> list;
    std::ranges::copy_if(study.all, std::back_inserter(list), [&](const auto& s) { return s.kind == kind; });
    return list;
  };
  const auto plain = of(Kind::plain), layer = of(Kind::layer), both = of(Kind::extrapolated);
  ASSERT_EQ(plain.size(), 4U);
  ASSERT_EQ(layer.size(), 4U);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(study.counts.n_runs, 3U + 4U + 4U);
  EXPECT_GE(study.stations.size(), 10U);
  EXPECT_EQ(study.stations.size(), study.v_tip_m_per_s.size());

  // The cost in node updates.
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(plain[k].cost, std::exp2(k), 1e-12);
  // 2 rows of cells hold three rows of nodes of 40 that move: 3 (n - 1)/40 more, corners and sides alike.
  EXPECT_NEAR(layer[0].cost, 1 + 3 * 3 / 40.0, 1e-3);
  EXPECT_NEAR(layer[1].cost, 1 + 3 * 7 / 40.0, 1e-3);

  // Smaller steps come nearer to the limit.
  EXPECT_GT(plain[0].median_error, 0.02);
  for (int k = 1; k < 4; ++k) EXPECT_LT(plain[k].median_error, plain[k - 1].median_error);
  for (const auto& s : study.all) EXPECT_LE(s.median_error, s.p90_error);
  EXPECT_GT(study.median_order, 1);

  // Linear in the sub-step.
  EXPECT_EQ(both[0].cost, layer[0].cost + layer[1].cost);
  for (std::size_t k = 0; k < study.stations.size(); ++k) {
    const double expected = 2 * layer[1].v_tip_m_per_s[k] - layer[0].v_tip_m_per_s[k];
    if (std::isfinite(expected)) {
      EXPECT_EQ(both[0].v_tip_m_per_s[k], expected);
    }
  }

  // The cheapest within the tolerance.
  ASSERT_GE(study.chosen, 0);
  const auto& chosen = study.all[study.chosen];
  EXPECT_NE(chosen.kind, Kind::extrapolated);
  EXPECT_LE(chosen.p90_error, 0.1);
  for (const auto& s : study.all) {
    if (s.kind == Kind::extrapolated || s.cost >= chosen.cost) continue;
    EXPECT_TRUE(s.p90_error > 0.1 || 10 * s.n_stations < 9 * static_cast<int>(study.stations.size()));
  }

  test::TemporaryFolder folder;
  write_interface_step(folder.path(), coarse_case(), study);
  const auto config = input::read_case(folder / "chosen.toml", {});
  EXPECT_EQ(config.time.interface_substeps, chosen.substeps);
  EXPECT_EQ(config.time.step_factor, chosen.step_factor);
  EXPECT_EQ(config.event, interface::EventKind::left);
  EXPECT_EQ(std::ranges::count(test::read_file(folder / "interface_step.csv"), '\n'),
            1 + static_cast<std::int64_t>(study.all.size()));
  // A study that chooses nothing leaves no case of an earlier one.
  auto none = study;
  none.chosen = -1;
  write_interface_step(folder.path(), coarse_case(), none);
  EXPECT_FALSE(std::filesystem::exists(folder / "chosen.toml"));
}

TEST(InterfaceStepStudy, ChoosesAWayThatIsComparedAtNineTenthsOfTheStations) {
  InterfaceStep result;
  result.options.tolerance = 0.01;
  result.stations.resize(20);
  const auto way = [](Kind kind, double cost, double p90_error, int n_stations) {
    return Stepping{.kind = kind, .cost = cost, .p90_error = p90_error, .n_stations = n_stations};
  };
  result.all = {way(Kind::layer, 1, 0.01, 17), way(Kind::layer, 2, 0.011, 20),
                way(Kind::extrapolated, 3, 0, 20)};
  EXPECT_EQ(cheapest(result), -1);
  result.all.push_back(way(Kind::plain, 5, 0, 20));
  result.all.push_back(way(Kind::layer, 4, 0.01, 18));
  EXPECT_EQ(cheapest(result), 4);
}

TEST(InterfaceStepStudy, CanBeInterrupted) {
  EXPECT_THROW(study_interface_step(coarse_case(), {}, [](std::size_t, std::size_t) { return false; }),
               Interrupted);
}

}  // namespace
}  // namespace slipfront::study
