// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/bases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "input/pressure.hpp"
#include "support/files.hpp"

namespace slipfront::kammer2012 {
namespace {

TEST(Bases, HaveThePapersNominalPressure) {
  const double wanted_Pa = input::nominal_pressure_Pa(paper_cases(true).front().config);
  for (const auto& base : base_options())
    for (const auto& c : cases_on(base, true)) {
      EXPECT_NEAR(input::nominal_pressure_Pa(c.config), wanted_Pa, 1e-2 * wanted_Pa) << base.name;
      EXPECT_EQ(input::has_base_body(c.config), base.material.has_value());
      EXPECT_NO_THROW(run::check(c.config));
    }
  EXPECT_DOUBLE_EQ(cases_on(base_options().front(), true).front().config.loading.tilt_left_m,
                   2 * input::Case{}.loading.tilt_left_m);
  EXPECT_FALSE(base_options().back().material);
}

TEST(Bases, EqualBodiesChangeNoPressure) {
  BasesOptions options;
  options.quick = true;
  const auto result = study_bases(options, [](std::size_t, std::size_t) { return true; });
  ASSERT_EQ(result.bases.size(), base_options().size());
  const auto &own = result.bases.front(), &rigid = result.bases.back();
  EXPECT_NEAR(own.pressure_change.along, 0, 1e-3);
  EXPECT_NEAR(own.pressure_change.against, 0, 1e-3);
  EXPECT_LT(rigid.pressure_change.against, -0.05);
  EXPECT_GT(rigid.pressure_change.along, 0.2);
  EXPECT_GT(rigid.speed_ratio.median, 1);
  EXPECT_LT(own.speed_ratio.median, 1);

  const test::TemporaryFolder folder;
  write_bases(folder.path(), result);
  const auto json = nlohmann::json::parse(test::read_file(folder.path() / "bases.json"));
  EXPECT_TRUE(json["quick"]);
  EXPECT_EQ(json["bases"].size(), result.bases.size());
  EXPECT_EQ(json["bases"][0]["events"].size(), 4U);
  const auto points = test::read_file(folder.path() / "bases_points.csv");
  std::size_t n_points = 0;
  for (const auto& on : result.bases) n_points += on.main_fronts.n_points;
  EXPECT_GE(static_cast<std::size_t>(std::ranges::count(points, '\n')), n_points + 1);
}

}  // namespace
}  // namespace slipfront::kammer2012
