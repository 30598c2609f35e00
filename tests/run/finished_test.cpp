// SPDX-License-Identifier: BSD-3-Clause
#include "run/finished.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <vector>

#include "cases.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

using problem::make_problem;
namespace fs = std::filesystem;

TEST(FinishedRuns, ServeForTheirCaseAlone) {
  const std::vector<input::Case> cases = {test::coarse_case(),
                                          test::coarse_case(interface::EventKind::right)};
  const test::TemporaryFolder folder;
  const FinishedRuns finished(folder / "runs");
  for (const auto& config : cases) {
    const auto initial = setup::make_initial_state(make_problem(config), test::go_on);
    finished.keep(run_from(make_problem(config), initial, test::go_on), initial);
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "runs")) files.push_back(entry.path());
  ASSERT_EQ(files.size(), 2U);
  const auto expect_taken = [&](bool expected) {
    for (const auto& config : cases) {
      Result result;
      InitialState initial;
      EXPECT_EQ(finished.take(make_problem(config), result, initial), expected);
    }
  };
  expect_taken(true);
  EXPECT_FALSE(finished.has(make_problem(test::coarse_case(interface::EventKind::left))));
  // Files that took each other's names.
  fs::rename(files[0], folder / "other");
  fs::rename(files[1], files[0]);
  fs::rename(folder / "other", files[1]);
  expect_taken(false);
  // No files; nor does it wait for someone to write into them.
  for (const auto& file : files) {
    fs::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  }
  expect_taken(false);
}

TEST(FinishedRuns, ServeForTheirTableOfFrictionAlone) {
  auto config = test::coarse_case(), of_other_table = config;
  test::set_table(config, "x_m,mu_k\n0,0.6\n0.2,0.6\n");
  test::set_table(of_other_table, "x_m,mu_k\n0,0.6\n0.2,0.7\n");
  const test::TemporaryFolder folder;
  const FinishedRuns finished(folder / "runs");
  const auto initial = setup::make_initial_state(make_problem(config), test::go_on);
  finished.keep(run_from(make_problem(config), initial, test::go_on), initial);
  EXPECT_TRUE(finished.has(make_problem(config)));
  EXPECT_FALSE(finished.has(make_problem(of_other_table)));
}

}  // namespace
}  // namespace slipfront::run
