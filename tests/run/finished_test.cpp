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

namespace fs = std::filesystem;

class KeptRuns : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& config : cases_) {
      const auto initial = make_initial_state(config, test::go_on);
      finished_.keep(run_from(config, initial, test::go_on), initial);
    }
    for (const auto& entry : fs::directory_iterator(folder_ / "runs")) files_.push_back(entry.path());
    ASSERT_EQ(files_.size(), 2U);
  }

  bool take(std::size_t k) {
    Result result;
    InitialState initial;
    return finished_.take(cases_[k], result, initial);
  }

  std::vector<input::Case> cases_ = {test::coarse_case(), test::coarse_case(interface::EventKind::right)};
  test::TemporaryFolder folder_;
  FinishedRuns finished_{folder_ / "runs"};
  std::vector<fs::path> files_;
};

TEST_F(KeptRuns, ServeForTheirCase) {
  EXPECT_TRUE(take(0));
  EXPECT_TRUE(take(1));
  EXPECT_FALSE(finished_.has(test::coarse_case(interface::EventKind::left)));
}

TEST_F(KeptRuns, DoNotServeForAnotherWhoseNameTheyTook) {
  fs::rename(files_[0], folder_ / "other");
  fs::rename(files_[1], files_[0]);
  fs::rename(folder_ / "other", files_[1]);
  EXPECT_FALSE(take(0));
  EXPECT_FALSE(take(1));
}

TEST_F(KeptRuns, ThatAreNoFilesDoNotServe) {
  for (const auto& file : files_) {
    fs::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  }
  EXPECT_FALSE(take(0));  // nor does it wait for someone to write into them
  EXPECT_FALSE(take(1));
}

}  // namespace
}  // namespace slipfront::run
