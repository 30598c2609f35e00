// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "files/checksum.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "mesh/plate.hpp"
#include "results/hdf5.hpp"
#include "results/history.hpp"
#include "results/snapshots.hpp"
#include "support/files.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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
    const auto mesh = std::make_shared<const mesh::Mesh>(mesh::make_plate(plate));
    mesh_ = mesh::in_one_slab(mesh);
    stepper_.emplace(*mesh, solid::Material{}, interface::ContactModel{interface::VelocityWeakening{}},
                     motion::TimeStepping{});
    for (const auto n : mesh->interface_nodes) x_m_.push_back(mesh->x_m[n]);
  }

  record::History row(int k) const {
    record::History h;
    h.time_s = {1e-6 * k};
    double value = k;
    for (const auto& field : record::history_fields) (h.*field.member).assign(x_m_.size(), value += 0.1);
    return h;
  }

  /// What is read from the file that is made of the rows.
  record::History written_history() const {
    write_history(folder_ / "interface.h5", ResultStream::history_file(folder_.path()), x_m_);
    return read_history(folder_ / "interface.h5");
  }

  mesh::Slabs mesh_;
  std::optional<motion::Stepper> stepper_;
  std::vector<double> x_m_;
  test::TemporaryFolder folder_;
};

TEST_F(Stream, KeepsAllItWasGiven) {
  const auto n_rows = static_cast<int>(3 * history_block_rows(x_m_.size()) + 1);  // the last block is short
  {
    ResultStream stream(folder_.path());
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("history.raw", "snapshots.raw"));
    for (int k = 0; k < n_rows; ++k) {
      stream.sample(row(k));
      if (k % 1000 == 0) stream.snapshot(*stepper_);
    }
    const auto lengths = stream.keep();
    EXPECT_EQ(lengths.history.bytes, n_rows * (1 + 4 * x_m_.size()) * sizeof(double));
  }
  const auto history = written_history();
  EXPECT_EQ(history.x_m, x_m_);
  ASSERT_EQ(history.time_s.size(), static_cast<std::size_t>(n_rows));
  for (int k = 0; k < n_rows; ++k) {
    ASSERT_EQ(history.time_s[k], 1e-6 * k);
    for (std::size_t i = 0; i < x_m_.size(); ++i) {
      ASSERT_EQ(history.slip_m[k * x_m_.size() + i], row(k).slip_m[i]);
      ASSERT_EQ(history.p_Pa[k * x_m_.size() + i], row(k).p_Pa[i]);
    }
  }
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
  const auto history = written_history();
  ASSERT_EQ(history.time_s.size(), 5U);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(history.time_s[k], 1e-6 * k);
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
  EXPECT_EQ(written_history().time_s.size(), 2U);
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
