// SPDX-License-Identifier: BSD-3-Clause
#include "io/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "io/results.hpp"
#include "mesh/plate.hpp"
#include "support.hpp"

namespace slipfront::io {
namespace {

using test::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::set<std::string> names_in(const std::filesystem::path& dir) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(dir))
    names.insert(entry.path().filename().string());
  return names;
}

/// A plate at rest, whose samples are made up.
class Stream : public testing::Test {
 protected:
  Stream() {
    mesh::Plate plate;
    plate.element_size_m = 10e-3;
    plate.corner = mesh::Corner::none;
    mesh_ = mesh::make_plate(plate);
    stepper_.emplace(mesh_, solid::Material{}, interface::ContactModel{interface::VelocityWeakening{}},
                     solve::TimeStepping{});
    for (const auto n : mesh_.lower) x_m_.push_back(mesh_.x_m[n]);
  }

  fronts::History row(int k) const {
    fronts::History h;
    h.time_s = {1e-6 * k};
    h.slip_m.assign(x_m_.size(), k + 0.1);
    h.slip_rate_m_per_s.assign(x_m_.size(), k + 0.2);
    h.t_Pa.assign(x_m_.size(), k + 0.3);
    h.p_Pa.assign(x_m_.size(), k + 0.4);
    return h;
  }

  mesh::Mesh mesh_;
  std::optional<solve::Stepper> stepper_;
  std::vector<double> x_m_;
  test::TemporaryFolder folder_;
};

TEST_F(Stream, PublishesAllItWasGiven) {
  const auto n_rows = static_cast<int>(3 * history_block_rows(x_m_.size()) + 1);  // the last block is short
  {
    ResultStream stream(folder_.path(), x_m_, mesh_, true);
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("fields.vtkhdf.part", "interface.h5.part"));
    for (int k = 0; k < n_rows; ++k) {
      stream.sample(row(k));
      if (k % 1000 == 0) stream.snapshot(*stepper_);
    }
    stream.publish();
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("fields.vtkhdf", "interface.h5"));
  }
  EXPECT_THAT(names_in(folder_.path()), ElementsAre("fields.vtkhdf", "interface.h5"));
  const auto history = read_history(folder_ / "interface.h5");
  EXPECT_EQ(history.x_m, x_m_);
  ASSERT_EQ(history.time_s.size(), static_cast<std::size_t>(n_rows));
  for (int k = 0; k < n_rows; ++k) {
    ASSERT_EQ(history.time_s[k], 1e-6 * k);
    for (std::size_t i = 0; i < x_m_.size(); ++i) {
      ASSERT_EQ(history.slip_m[k * x_m_.size() + i], k + 0.1);
      ASSERT_EQ(history.p_Pa[k * x_m_.size() + i], k + 0.4);
    }
  }
  const auto file = hdf5::open_file(folder_ / "fields.vtkhdf");
  EXPECT_EQ(hdf5::read(file, "/VTKHDF/Steps/Values").values.size(),
            static_cast<std::size_t>((n_rows + 999) / 1000));
}

TEST_F(Stream, LeavesEarlierResultsUntilItPublishes) {
  for (const char* name : {"interface.h5", "fields.vtkhdf", "run.json", "notes.txt"})
    write_text(folder_ / name, "earlier");
  {
    ResultStream stream(folder_.path(), x_m_, mesh_, true);
    stream.sample(row(0));
  }
  EXPECT_THAT(names_in(folder_.path()),
              ElementsAre("fields.vtkhdf", "interface.h5", "notes.txt", "run.json"));
  EXPECT_EQ(test::read_file(folder_ / "interface.h5"), "earlier");
  {
    ResultStream stream(folder_.path(), x_m_, mesh_, true);
    stream.sample(row(0));
    stream.publish();
  }
  // No snapshot was taken: there are no fields.
  EXPECT_THAT(names_in(folder_.path()), ElementsAre("interface.h5", "notes.txt"));
  EXPECT_EQ(read_history(folder_ / "interface.h5").time_s.size(), 1U);
}

TEST_F(Stream, AFullDiskIsToldOnceByTheFilesName) {
  std::string error;
  testing::internal::CaptureStderr();
  {
    const test::FileSizeLimit limit(256 * 1024);
    ResultStream stream(folder_.path(), x_m_, mesh_, false);
    error = error_of([&] {
      for (int k = 0;; ++k) stream.sample(row(k));
    });
  }
  EXPECT_THAT(error, StartsWith((folder_ / "interface.h5").string() + ": cannot write "));
  EXPECT_THAT(error, HasSubstr("check that the disk is not full"));
  EXPECT_THAT(names_in(folder_.path()), IsEmpty());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // HDF5 prints nothing itself
}

TEST_F(Stream, AFullDiskIsToldForSnapshots) {
  const test::FileSizeLimit limit(256 * 1024);
  ResultStream stream(folder_.path(), x_m_, mesh_, true);
  EXPECT_THAT(error_of([&] {
                for (;;) stream.snapshot(*stepper_);
              }),
              StartsWith((folder_ / "fields.vtkhdf").string() + ": cannot write "));
}

TEST_F(Stream, AFolderThatIsNotThereIsToldAtOnce) {
  EXPECT_EQ(error_of([&] { ResultStream(folder_ / "none", x_m_, mesh_, false); }),
            (folder_ / "none/interface.h5").string() +
                ": cannot be created; check that its folder exists and can be written");
}

}  // namespace
}  // namespace slipfront::io
