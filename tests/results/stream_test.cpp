// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "base/numbers.hpp"
#include "histories.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "results/table.hpp"
#include "support/files.hpp"
#include "support/results.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
const char* const history_file = history_output.file;
const char* const snapshot_file = snapshot_output.file;
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
  record::History rows(int n) const {
    auto all = made_history(n, x_m_.size());
    all.x_m = x_m_;
    return all;
  }
  std::vector<RowFormat> files() const {
    return {row_format(history_file, history_table(x_m_)), snapshot_format({}, 10, mesh_.n_nodes)};
  }
  void put(ResultStream& stream, const record::History& rows) const {
    stream.sink(history_file).put(rows_of(members_of(rows)));
  }
  void put_snapshot(ResultStream& stream) const {
    stream.sink(snapshot_file).put(test::row_of(stepper_->snapshot()));
  }
  /// What rows and a snapshot with every tenth make of a folder.
  ResultStream::Extents give(ResultStream& stream, int first, int end) {
    for (int k = first; k < end; ++k) {
      put(stream, row(k));
      if (k % 10 == 0) put_snapshot(stream);
    }
    return stream.keep();
  }
  void finish(ResultStream& stream, const std::filesystem::path& dir) {
    stream.finish();
    finish_snapshots(dir / snapshot_file, mesh_);
  }
  /// Those of a run that was not stopped.
  void expect_whole(const std::filesystem::path& dir, int n) {
    const test::TemporaryFolder whole;
    ResultStream stream(whole.path(), files());
    give(stream, 0, n);
    finish(stream, whole.path());
    for (const char* name : {history_file, snapshot_file})
      EXPECT_TRUE(test::read_file(dir / name) == test::read_file(whole / name)) << name;
  }

  mesh::Slabs mesh_;
  std::optional<motion::Stepper> stepper_;
  std::vector<double> x_m_;
};

TEST_F(Stream, KeepsAllItWasGiven) {
  constexpr int n_rows = 4001;
  ResultStream stream(folder_.path(), files());
  EXPECT_THAT(test::names_below(folder_.path()), ElementsAre(history_file));
  const auto extents = give(stream, 0, n_rows);
  EXPECT_EQ(extents.front().bytes,
            files().front().head_bytes + n_rows * (1 + 4 * x_m_.size()) * sizeof(double));
  finish(stream, folder_.path());
  EXPECT_TRUE(equal(test::read_history(folder_ / history_file), rows(n_rows)));
  EXPECT_EQ(std::filesystem::file_size(folder_ / history_file), extents.front().bytes);
  EXPECT_EQ(test::read(folder_ / snapshot_file, "/VTKHDF/Steps/Values").values.size(), 401U);
}

TEST_F(Stream, GoesOnWhereItWasKept) {
  ResultStream::Extents extents;
  {
    ResultStream stream(folder_.path(), files());
    extents = give(stream, 0, 13);
    for (int k = 13; k < 17; ++k) put(stream, row(100 + k));  // of steps that are done again
    put_snapshot(stream);
    stream.keep();
  }
  ResultStream stream(folder_.path(), files(), extents);
  give(stream, 13, 25);
  finish(stream, folder_.path());
  expect_whole(folder_.path(), 25);
}

TEST_F(Stream, GoesOnInFilesThatWereFinished) {
  ResultStream::Extents extents;
  {
    ResultStream stream(folder_.path(), files());
    extents = give(stream, 0, 13);
    give(stream, 13, 15);
    finish(stream, folder_.path());
  }
  ResultStream stream(folder_.path(), files(), extents);
  const RowReader reader(folder_ / history_file, files().front().row_values());  // it is open again
  EXPECT_EQ(reader.n_rows(), 13U);
  give(stream, 13, 25);
  finish(stream, folder_.path());
  expect_whole(folder_.path(), 25);
}

TEST_F(Stream, IsFinishedOrNotWhereverFinishingIsCutOff) {
  ResultStream stream(folder_.path(), files());
  const auto extents = give(stream, 0, 25);
  const auto open = [&](const char* name) { return test::read_file(folder_ / name); };
  const std::map<std::string, std::string> before = {{history_file, open(history_file)},
                                                     {snapshot_file, open(snapshot_file)}};
  finish(stream, folder_.path());
  // All but the last to be written, the first eight bytes.
  for (const auto& [name, text] : before)
    test::write_file(folder_ / name, text.substr(0, 8) + open(name.c_str()).substr(8));
  const RowReader reader(folder_ / history_file, files().front().row_values());
  EXPECT_EQ(reader.n_rows(), 25U);
  ResultStream again(folder_.path(), files(), extents);
  finish(again, folder_.path());
  expect_whole(folder_.path(), 25);
}

TEST_F(Stream, WithoutSnapshotsYetLeavesNoFileOfThem) {
  ResultStream::Extents extents;
  {
    ResultStream stream(folder_.path(), files());
    extents = stream.keep();
    put_snapshot(stream);
    stream.keep();
  }
  const ResultStream stream(folder_.path(), files(), extents);
  EXPECT_THAT(test::names_below(folder_.path()), ElementsAre(history_file));
}

TEST_F(Stream, GoesOnInNoFileThatIsAnother) {
  ResultStream::Extents extents;
  {
    ResultStream stream(folder_.path(), files());
    extents = give(stream, 0, 3);
  }
  const auto error = [&] { return error_of([&] { ResultStream(folder_.path(), files(), extents); }); };
  EXPECT_EQ(error(), "(nothing thrown)");
  const auto file = folder_ / history_file;
  const auto text = test::read_file(file);
  auto changed = text;
  changed.back() = static_cast<char>(changed.back() ^ 1);
  test::write_file(file, changed);
  EXPECT_THAT(error(), HasSubstr("was changed or damaged since the last checkpoint"));
  test::write_file(file, text.substr(0, text.size() - 1));
  EXPECT_THAT(error(), HasSubstr("is shorter than at"));
  std::filesystem::remove(file);
  EXPECT_THAT(error(), HasSubstr("is missing"));
}

TEST_F(Stream, DoesNotFinishAFileThatWasChangedMeanwhile) {
  for (const char* name : {history_file, snapshot_file}) {
    ResultStream stream(folder_.path(), files());
    give(stream, 0, 3);
    auto text = test::read_file(folder_ / name);
    text.back() = static_cast<char>(text.back() ^ 1);
    test::write_file(folder_ / name, text);
    EXPECT_EQ(error_of([&] { stream.finish(); }),
              (folder_ / name).string() +
                  ": is not what was written: it was changed, damaged or removed meanwhile");
  }
}

TEST_F(Stream, ANumberThatIsNotFiniteIsToldByItsColumn) {
  for (const bool goes_on : {false, true}) {
    auto bad = row(3);
    bad.t_Pa.back() = nan;
    std::optional<ResultStream> stream(std::in_place, folder_.path(), files());
    give(*stream, 0, 3);
    put(*stream, bad);
    const auto extents = stream->keep();
    if (goes_on) {
      stream.reset();
      stream.emplace(folder_.path(), files(), extents);
    }
    put(*stream, row(4));
    EXPECT_EQ(error_of([&] { stream->finish(); }).find((folder_ / history_file).string() + ": t_Pa is not"),
              0U);
  }
  ResultStream stream(folder_.path(), files());
  auto bad = row(0);
  bad.time_s.back() = infinity;
  put(stream, bad);
  stream.finish(Numbers::any);  // of what has blown up
  EXPECT_EQ(test::read(folder_ / history_file, "time_s").values.size(), 1U);
}

TEST_F(Stream, AFullDiskIsToldByTheFilesName) {
  std::string error;
  testing::internal::CaptureStderr();
  {
    const test::FileSizeLimit limit(256 * 1024);
    ResultStream stream(folder_.path(), files());
    error = error_of([&] {
      for (int k = 0;; ++k) put(stream, row(k));
    });
  }
  EXPECT_EQ(error, (folder_ / history_file).string() +
                       ": cannot be written (File too large); allow larger files, as by ulimit -f");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Stream, ALinkIsNotFollowed) {
  const test::TemporaryFolder elsewhere;
  std::filesystem::create_symlink(elsewhere / "target", folder_ / history_file);
  const ResultStream stream(folder_.path(), files());
  EXPECT_FALSE(std::filesystem::exists(elsewhere / "target"));
}

}  // namespace
}  // namespace slipfront::results
