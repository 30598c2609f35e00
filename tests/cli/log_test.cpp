// SPDX-License-Identifier: BSD-3-Clause
#include "cli/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

namespace slipfront::cli {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

// The test's standard error is captured to a file, so it is no terminal.
TEST(Progress, WritesPlainLinesWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    Progress progress("left", 1000);
    progress.update(5);
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    progress.update(50);   // under 10 %
    progress.update(500);  // half
    progress.update(501);  // no further 10 %
    progress.update(1000);
    progress.finish();
    progress.finish();
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, ContainsRegex("^left: 50 %, [0-9.e+]+ steps/s, 0\\.[0-9] s to go\n"
                                  "left: 1000 steps in 0\\.[0-9] s\n$"));
}

TEST(Progress, OfWorkThatGoesOnHasItsOwnRate) {
  testing::internal::CaptureStderr();
  Progress progress("event", 1'000'000'000, false, "steps", 999'999'000);
  std::this_thread::sleep_for(std::chrono::milliseconds(110));
  progress.update(999'999'500);
  const std::string text = testing::internal::GetCapturedStderr();
  // 500 steps in more than 0.1 s, and as many to go.
  EXPECT_THAT(text, ContainsRegex("^event: 99 %, [0-9.e+]+ steps/s, [0-9.]+ s to go\n$"));
  EXPECT_LT(std::stod(text.substr(text.find(", ") + 2)), 5000);
}

TEST(Progress, NotesAreLinesOfTheirOwn) {
  testing::internal::CaptureStderr();
  Progress progress("left", 1000);
  progress.update(5);
  progress.note("note: kept");
  Progress("left", 1000, true).note("nobody sees it");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "note: kept\n");
}

TEST(Progress, DrawsAtMostTenTimesASecond) {
  testing::internal::CaptureStderr();
  {
    Progress progress("fast", 100);
    for (int step = 1; step <= 100; ++step) progress.update(step);  // far less than 0.1 s
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, IsSilentWhereQuiet) {
  testing::internal::CaptureStderr();
  {
    Progress progress("quiet", 10, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    progress.update(5);
    progress.finish();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, SaysWhereWorkEndedEarly) {
  testing::internal::CaptureStderr();
  Progress progress("event", 1000);
  progress.update(400);
  progress.finish();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("event: 400 steps in "));
}

TEST(Progress, NoStepsAtAllDoNoHarm) {
  testing::internal::CaptureStderr();
  Progress progress("none", 0);
  progress.update(0);
  progress.finish();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("none: 0 steps in "));
}

TEST(Durations, AreReadable) {
  EXPECT_EQ(duration_text(0.04), "0.0 s");
  EXPECT_EQ(duration_text(2.5), "2.5 s");
  EXPECT_EQ(duration_text(9.94), "9.9 s");
  EXPECT_EQ(duration_text(9.96), "10 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1:00");
  EXPECT_EQ(duration_text(187), "3:07");
  EXPECT_EQ(duration_text(3723), "1:02:03");
}

}  // namespace
}  // namespace slipfront::cli
