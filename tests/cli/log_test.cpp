// SPDX-License-Identifier: BSD-3-Clause
#include "cli/log.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace slipfront::cli {
namespace {

using std::chrono::milliseconds;

/// What is written to standard error, a file here and no terminal, by a clock that is set by hand.
class ProgressLines : public testing::Test {
 protected:
  ProgressLines() { testing::internal::CaptureStderr(); }
  Progress progress(const char* label, std::int64_t total, bool quiet = false, std::int64_t first = 0) {
    return Progress(label, total, quiet, "steps", first, [this] { return now_; });
  }
  std::string text() { return testing::internal::GetCapturedStderr(); }

  Clock::time_point now_;
};

TEST_F(ProgressLines, ArePlainWhereThereIsNoTerminal) {
  auto shown = progress("left", 1000);
  shown.update(5);
  now_ += std::chrono::seconds(20);
  shown.update(50);   // under 10 %
  shown.update(500);  // half
  shown.update(501);  // no further 10 %
  now_ += std::chrono::seconds(20);
  shown.update(1000);
  shown.finish();
  shown.finish();
  EXPECT_EQ(text(), "left: 50 %, 25 steps/s, 20 s to go\nleft: 1000 steps in 40 s\n");
}

TEST_F(ProgressLines, OfWorkThatGoesOnHaveItsOwnRate) {
  auto shown = progress("event", 1'000'000'000, false, 999'999'000);
  now_ += std::chrono::seconds(20);
  shown.update(999'999'500);
  EXPECT_EQ(text(), "event: 99 %, 25 steps/s, 20 s to go\n");
}

TEST_F(ProgressLines, AreAtLeastTenSecondsApart) {
  auto shown = progress("fast", 100);
  for (int step = 1; step <= 50; ++step) {
    now_ += milliseconds(100);
    shown.update(step);
  }
  now_ += std::chrono::seconds(5);
  shown.update(60);
  EXPECT_EQ(text(), "fast: 60 %, 6 steps/s, 6.7 s to go\n");
}

TEST_F(ProgressLines, DoNotAppearWhereQuiet) {
  auto shown = progress("quiet", 10, true);
  now_ += std::chrono::seconds(20);
  shown.update(5);
  shown.note("nobody sees it");
  shown.finish();
  EXPECT_EQ(text(), "");
}

TEST_F(ProgressLines, SayWhereWorkEndedEarly) {
  auto shown = progress("event", 1000), none = progress("none", 0);
  shown.update(400);
  shown.note("note: kept");
  shown.finish();
  none.update(0);
  none.finish();
  EXPECT_EQ(text(), "note: kept\nevent: 400 steps in 0.0 s\nnone: 0 steps in 0.0 s\n");
}

TEST(Durations, AreReadable) {
  for (const auto& [seconds, text] : {std::pair{0.04, "0.0 s"},
                                      {2.5, "2.5 s"},
                                      {9.94, "9.9 s"},
                                      {9.96, "10 s"},
                                      {59.4, "59 s"},
                                      {59.6, "1:00"},
                                      {187, "3:07"},
                                      {3723, "1:02:03"}})
    EXPECT_EQ(duration_text(seconds), text);
}

}  // namespace
}  // namespace slipfront::cli
