// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "files/checksum.hpp"
#include "histories.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "results/hdf5.hpp"
#include "results/history.hpp"
#include "results/snapshots.hpp"
#include "support/files.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A plate at rest, whose samples are made up.
class Stream : public test::InFolder {
 protected:
  Stream() {
    mesh::Plate plate;
    plate.element_size_m = 10e-3;
    plate.corner = mesh::Corner::none;
    const auto mesh = std::make_shared<const mesh::Mesh>(mesh::make_plate(plate));
    mesh_ = mesh::in_one_slab(mesh);
    stepper_.emplace(*mesh, solid::Material{}, interface::ContactModel{interface::VelocityWeakening{}},
                     motion::TimeStepping{});
    for (const auto n : mesh->interface_nodes) x_m_.push_back(mesh->x_m[n]);
  }

  record::History row(int k) const { return made_history(1, x_m_.size(), k); }

  void expect_rows(int n) const {
    write_history(folder_ / "interface.h5", ResultStream::history_file(folder_.path()), x_m_);
    auto expected = made_history(n, x_m_.size());
    expected.x_m = x_m_;
    EXPECT_TRUE(equal(read_history(folder_ / "interface.h5"), expected));
  }

  mesh::Slabs mesh_;
  std::optional<motion::Stepper> stepper_;
  std::vector<double> x_m_;
};

TEST_F(Stream, KeepsAllItWasGiven) {
  const auto n_rows = static_cast<int>(3 * history_block_rows(x_m_.size()) + 1);  // the last block is short
  {
    ResultStream stream(folder_.path());
    EXPECT_THAT(test::names_below(folder_.path()), ElementsAre("history.raw", "snapshots.raw"));
    for (int k = 0; k < n_rows; ++k) {
      stream.sample(row(k));
      if (k % 1000 == 0) stream.snapshot(*stepper_);
    }
    const auto lengths = stream.keep();
    EXPECT_EQ(lengths.history.bytes, n_rows * (1 + 4 * x_m_.size()) * sizeof(double));
  }
  expect_rows(n_rows);
  const auto n_snapshots = static_cast<std::size_t>((n_rows + 999) / 1000);
  write_snapshots(folder_ / "fields.vtkhdf", mesh_,
                  read_snapshots(ResultStream::snapshot_file(folder_.path()), mesh_.n_nodes));
  const auto file = hdf5::open_file(folder_ / "fields.vtkhdf");
  EXPECT_EQ(hdf5::read(file, "/VTKHDF/Steps/Values").values.size(), n_snapshots);
}

TEST_F(Stream, GoesOnWhereItWasKept) {
  ResultStream::Extents lengths;
  {
    ResultStream stream(folder_.path());
    for (int k = 0; k < 3; ++k) stream.sample(row(k));
    stream.snapshot(*stepper_);
    lengths = stream.keep();
    for (int k = 3; k < 7; ++k) stream.sample(row(100 + k));  // of steps that are done again
    stream.snapshot(*stepper_);
    stream.keep();
  }
  {
    ResultStream stream(folder_.path(), lengths);
    for (int k = 3; k < 5; ++k) stream.sample(row(k));
    stream.keep();
  }
  expect_rows(5);
  EXPECT_EQ(read_snapshots(ResultStream::snapshot_file(folder_.path()), mesh_.n_nodes).time_s.size(), 1U);
}

TEST_F(Stream, GoesOnInNoFileThatIsTooShort) {
  { ResultStream(folder_.path()).keep(); }
  EXPECT_THAT(error_of([&] {
                ResultStream(folder_.path(), {{8, ""}, {0, ""}, {}});
              }),
              HasSubstr("is shorter than at"));
  std::filesystem::remove(ResultStream::history_file(folder_.path()));
  EXPECT_THAT(error_of([&] {
                ResultStream(folder_.path(), {{0, files::sha256("")}, {0, files::sha256("")}, {}});
              }),
              HasSubstr("is missing"));
}

TEST_F(Stream, LeavesOutARecordThatWasCutOff) {
  {
    ResultStream stream(folder_.path());
    for (int k = 0; k < 3; ++k) stream.sample(row(k));
    stream.keep();
  }
  const auto raw = ResultStream::history_file(folder_.path());
  std::filesystem::resize_file(raw, std::filesystem::file_size(raw) - 1);
  expect_rows(2);
}

TEST_F(Stream, AFullDiskIsToldByTheFilesName) {
  std::string error;
  testing::internal::CaptureStderr();
  {
    const test::FileSizeLimit limit(256 * 1024);
    ResultStream stream(folder_.path());
    error = error_of([&] {
      for (int k = 0;; ++k) stream.sample(row(k));
    });
  }
  EXPECT_EQ(error, ResultStream::history_file(folder_.path()).string() +
                       ": cannot be written (File too large); free space there");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Stream, AFileThatIsThereOrALinkIsNotReplaced) {
  const test::TemporaryFolder elsewhere;
  std::filesystem::create_symlink(elsewhere / "target", ResultStream::history_file(folder_.path()));
  EXPECT_THAT(error_of([&] { ResultStream stream(folder_.path()); }),
              HasSubstr("cannot be created (File exists)"));
  EXPECT_FALSE(std::filesystem::exists(elsewhere / "target"));
}

}  // namespace
}  // namespace slipfront::results
