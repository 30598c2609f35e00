// SPDX-License-Identifier: BSD-3-Clause
#include "results/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>

#include "files/files.hpp"
#include "histories.hpp"
#include "mesh/plate.hpp"
#include "results/hdf5.hpp"
#include "results/history.hpp"
#include "results/snapshots.hpp"
#include "support/files.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
using test::FileSizeLimit;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using HistoryFiles = test::InFolder;
using TextFiles = test::InFolder;
using SnapshotFiles = test::InFolder;

void write_axes(const hdf5::File& file) {
  hdf5::write(file, "time_s", std::vector<double>{0, 1}, {2});
  hdf5::write(file, "x_m", std::vector<double>{0, 1, 2}, {3});
}

TEST_F(HistoryFiles, DataSetsHaveShapeUnitAndDescription) {
  write_history(folder_ / "interface.h5", made_history(2, 3));
  const hdf5::File file = hdf5::open_file(folder_ / "interface.h5");
  const std::vector<std::pair<std::string, std::string>> units = {
      {"time_s", "s"}, {"x_m", "m"},  {"slip_m", "m"}, {"slip_rate_m_per_s", "m/s"},
      {"t_Pa", "Pa"},  {"p_Pa", "Pa"}};
  for (const auto& [name, unit] : units) {
    EXPECT_EQ(hdf5::text_attribute(file, name, "unit"), unit);
    EXPECT_FALSE(hdf5::text_attribute(file, name, "description").empty());
  }
  EXPECT_THAT(hdf5::read(file, "time_s").shape, ElementsAre(2));
  EXPECT_THAT(hdf5::read(file, "x_m").shape, ElementsAre(3));
  EXPECT_THAT(hdf5::read(file, "t_Pa").shape, ElementsAre(2, 3));
  EXPECT_EQ(hdf5::read(file, "t_Pa").values[3], 3.4);  // row 1, column 0
}

TEST_F(HistoryFiles, GrowsToTheSameAsWrittenAtOnce) {
  constexpr std::size_t n_nodes = 100;
  const std::size_t block = history_block_rows(n_nodes);
  ASSERT_GT(block, 1U);
  // Blocks shorter and longer than a chunk, more than one chunk of times, and an end within a chunk.
  HistoryFile file(folder_ / "grown.h5", made_history(0, n_nodes).x_m);
  std::size_t rows = 0;
  for (const std::size_t n : {std::size_t{1}, block, 2 * block + 3, std::size_t{1500}, std::size_t{0}}) {
    file.append(made_history(n, n_nodes, rows));
    rows += n;
  }
  file.close();
  EXPECT_TRUE(equal(read_history(folder_ / "grown.h5"), made_history(rows, n_nodes)));
}

TEST_F(HistoryFiles, EqualHistoriesMakeEqualFiles) {
  for (const char* name : {"a.h5", "b.h5"}) write_history(folder_ / name, made_history(70, 50));
  EXPECT_EQ(test::read_file(folder_ / "a.h5"), test::read_file(folder_ / "b.h5"));
}

TEST_F(HistoryFiles, ReadsBackBitwise) {
  for (const std::size_t rows : {0, 2}) {
    write_history(folder_ / "interface.h5", made_history(rows, 3));
    EXPECT_TRUE(equal(read_history(folder_ / "interface.h5"), made_history(rows, 3))) << rows;
  }
}

TEST_F(HistoryFiles, OtherNumericTypesAreRead) {
  hdf5::File file = hdf5::create_file(folder_ / "other.h5");
  write_axes(file);
  for (const char* name : {"slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa"})
    hdf5::write(file, name, std::vector<std::int64_t>{1, 2, 3, 4, 5, 6}, {2, 3});
  hdf5::close(std::move(file));
  EXPECT_THAT(read_history(folder_ / "other.h5").p_Pa, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(HistoryFiles, MissingOrMisshapedDataIsNamed) {
  const auto path = folder_ / "interface.h5";
  const std::vector<double> six = {1, 2, 3, 4, 5, 6};
  const std::pair<std::function<void(const hdf5::File&)>, const char*> cases[] = {
      {[](const hdf5::File&) {}, "has no data set time_s; check that it is the right file"},
      {write_axes, "has no data set slip_m; check that it is the right file"},
      {[&](const hdf5::File& file) {
         write_axes(file);
         hdf5::write(file, "slip_m", six, {3, 2});
       },
       "slip_m has the shape [3, 2]; with time_s and x_m it must be [2, 3]"},
      {[&](const hdf5::File& file) {
         hdf5::write(file, "time_s", six, {2, 3});
       },
       "time_s has 2 dimensions; it must have one"},
      {[](const hdf5::File& file) {
         hdf5::write(file, "time_s", std::vector<double>{0, 2, 2}, {3});
       },
       "time_s is 2 at index 2; its values must be finite and ascending"},
      {[](const hdf5::File& file) { hdf5::create_group(file, "time_s"); },
       "has no data set time_s; check that it is the right file"}};
  for (const auto& [fill, message] : cases) {
    hdf5::File file = hdf5::create_file(path);
    fill(file);
    hdf5::close(std::move(file));
    EXPECT_EQ(error_of([&] { read_history(path); }), path.string() + ": " + message);
  }
}

TEST_F(HistoryFiles, ForeignAndTruncatedFilesAreRefused) {
  const auto path = folder_ / "interface.h5";
  EXPECT_EQ(error_of([&] { read_history(path); }), path.string() + ": does not exist; check the path");
  test::write_file(path, "no HDF5");
  EXPECT_EQ(error_of([&] { read_history(path); }),
            path.string() + ": cannot be read; check that it is a complete HDF5 file");
  write_history(path, made_history(2, 3));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THAT(error_of([&] { read_history(path); }), StartsWith(path.string() + ": cannot be read"));
}

TEST_F(HistoryFiles, HDF5PrintsNothingItself) {
  testing::internal::CaptureStderr();
  error_of([&] { read_history(folder_ / "none.h5"); });
  error_of([&] { write_history(folder_ / "none" / "interface.h5", made_history(2, 3)); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(TextFiles, IntoAMissingFolderIsRefused) {
  const auto none = folder_ / "none";
  EXPECT_EQ(error_of([&] { write_history(none / "interface.h5", made_history(2, 3)); }),
            (none / "interface.h5").string() +
                ": cannot be created (No such file or directory); check that its folder can be written");
  EXPECT_THAT(
      error_of([&] { write_static(none / "static.csv", {}); }),
      HasSubstr(": cannot be created (No such file or directory); check that its folder can be written"));
  EXPECT_THAT(error_of([&] { write_fronts(none / "fronts.csv", {}); }), HasSubstr("cannot be created"));
  EXPECT_THAT(error_of([&] {
                write_snapshots(none / "fields.vtkhdf",
                                mesh::in_one_slab(std::make_shared<const mesh::Mesh>()), SnapshotSeries());
              }),
              HasSubstr("cannot be created"));
}

TEST_F(TextFiles, FollowNoLink) {
  const test::TemporaryFolder elsewhere;
  test::write_file(elsewhere / "precious", "x");
  std::filesystem::create_directory_symlink(elsewhere.path(), folder_ / "link");
  const std::vector<std::function<void(const std::filesystem::path&)>> writers = {
      [](const auto& file) { write_history(file, made_history(2, 3)); },
      [](const auto& file) { write_static(file, {}); },
      [](const auto& file) {
        write_snapshots(file, mesh::in_one_slab(std::make_shared<const mesh::Mesh>()), SnapshotSeries());
      },
      [](const auto& file) { files::make_folder(file); },
      [&](const auto& file) { files::move_file(folder_ / "file", file); },
      [&](const auto& file) { files::move_file(file, folder_ / "file"); },
      [](const auto& file) { files::remove_file(file); },
      [](const auto& file) { files::PlacedFile{file}; },
      [](const auto& file) { files::sync_file(file); }};
  test::write_file(folder_ / "file", "x");
  for (std::size_t k = 0; k < writers.size(); ++k)
    EXPECT_THAT(error_of([&, k] { writers[k](folder_ / "link" / "precious"); }),
                HasSubstr("(Not a directory); check"))
        << k;
  for (const char* name : {"interface.h5", "static.csv"})
    std::filesystem::create_symlink(elsewhere / "precious", folder_ / name);
  write_history(folder_ / "interface.h5", made_history(2, 3));
  write_static(folder_ / "static.csv", {});
  EXPECT_EQ(test::read_file(elsewhere / "precious"), "x");
  EXPECT_THAT(test::names_below(elsewhere.path()), ElementsAre("precious"));
}

TEST_F(TextFiles, AFullDiskIsNoticed) {
  const auto history = made_history(1, 20000);
  const record::StaticState state = {history.x_m, history.x_m, history.x_m};
  std::string history_error, static_error;
  {
    const FileSizeLimit limit(64 * 1024);
    history_error = error_of([&] { write_history(folder_ / "interface.h5", history); });
    static_error = error_of([&] { write_static(folder_ / "static.csv", state); });
  }
  EXPECT_THAT(history_error, HasSubstr("check that the disk is not full"));
  EXPECT_THAT(static_error,
              HasSubstr("static.csv.new: cannot be written (File too large); free space there"));
}

TEST_F(TextFiles, OfTextThatFailsLeavesWhatWasThere) {
  files::write_text(folder_ / "a.csv", "earlier");
  const auto write = [&] {
    files::write_text(folder_ / "a.csv", [](files::OutputFile& output) {
      output.write("half");
      throw WriteError("a full disk");
    });
  };
  EXPECT_EQ(error_of(write), "a full disk");
  EXPECT_EQ(test::read_file(folder_ / "a.csv"), "earlier");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.csv.new"));
}

TEST_F(TextFiles, HasARowPerNodeAtFullPrecision) {
  write_static(folder_ / "static.csv",
               {{0, 0.1}, {1.0 / 3, -2}, {4e6, std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_EQ(test::read_file(folder_ / "static.csv"),
            "x_m,t_s_Pa,p_s_Pa\n"
            "0,0.3333333333333333,4000000\n"
            "0.1,-2,\n");
}

TEST_F(TextFiles, HasARowPerFrontAndNodeWithUndefinedValuesEmpty) {
  fronts::FrontPoint first, second;
  first.x_m = 0.1;
  first.onset_s = 1e-6;
  second = {7, 0.2, 2e-6, 1584.5, 1, 2, 3, 4, 5, 6, 7, 8, 0.5, true, fronts::SpeedKind::front};
  fronts::Front left, right;
  left.id = 0;
  left.direction = -1;
  left.points = {first};
  right.id = 1;
  right.direction = 1;
  right.points = {first, second};
  write_fronts(folder_ / "fronts.csv", std::vector{left, right});
  EXPECT_EQ(
      test::read_file(folder_ / "fronts.csv"),
      "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,U_s_J_per_m3,"
      "U_r_J_per_m3,speed_kind\n"
      "0,0.1,1e-06,-1,,,,,,,,,,path_end\n"
      "1,0.1,1e-06,1,,,,,,,,,,path_end\n"
      "1,0.2,2e-06,1,1584.5,1,2,3,4,5,6,7,8,front\n");
}

/// Two cells side by side and an orphan, node 6.
mesh::Slabs two_cells() {
  mesh::Mesh mesh;
  mesh.x_m = {0, 1, 2, 0, 1, 2, 9};
  mesh.y_m = {0, 0, 0, 1, 1, 1, 9};
  mesh.cells = {{0, 1, 4, 3}, {1, 2, 5, 4}};
  return mesh::in_one_slab(std::make_shared<const mesh::Mesh>(mesh));
}

motion::Snapshot snapshot(double time_s, double offset) {
  motion::Snapshot result;
  result.time_s = time_s;
  for (int i = 0; i < 7; ++i) {
    result.u_m.x.push_back(offset + i);
    result.u_m.y.push_back(offset - i);
    result.v_m_per_s.x.push_back(10 * offset + i);
    result.v_m_per_s.y.push_back(10 * offset - i);
  }
  return result;
}

// The layout is that of the VTKHDF specification, version 2.0, for a temporal unstructured grid.
TEST_F(SnapshotFiles, WritesTheMeshOnceAndAStepPerSnapshot) {
  const auto path = folder_ / "fields.vtkhdf";
  write_snapshots(path, two_cells(), series_of(std::vector{snapshot(1e-5, 100), snapshot(2e-5, 200)}));
  const hdf5::File file = hdf5::open_file(path);
  const auto values = [&](const std::string& name) { return hdf5::read(file, "/VTKHDF/" + name).values; };
  const auto shape = [&](const std::string& name) { return hdf5::read(file, "/VTKHDF/" + name).shape; };
  EXPECT_THAT(values("NumberOfPoints"), ElementsAre(7));
  EXPECT_THAT(values("NumberOfCells"), ElementsAre(2));
  EXPECT_THAT(values("NumberOfConnectivityIds"), ElementsAre(8));
  EXPECT_THAT(shape("Points"), ElementsAre(7, 3));
  EXPECT_EQ(values("Points")[3 * 4 + 1], 1.0);  // y of node 4
  EXPECT_THAT(values("Connectivity"), ElementsAre(0, 1, 4, 3, 1, 2, 5, 4));
  EXPECT_THAT(values("Offsets"), ElementsAre(0, 4, 8));
  EXPECT_THAT(values("Types"), ElementsAre(9, 9));
  EXPECT_THAT(values("Steps/Values"), ElementsAre(1e-5, 2e-5));
  for (const char* name : {"PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    EXPECT_THAT(values(std::string("Steps/") + name), ElementsAre(0, 0)) << name;
  EXPECT_THAT(values("Steps/NumberOfParts"), ElementsAre(1, 1));
  EXPECT_THAT(shape("Steps/CellOffsets"), ElementsAre(2, 1));
  for (const char* field : {"displacement_m", "velocity_m_per_s"}) {
    EXPECT_THAT(values(std::string("Steps/PointDataOffsets/") + field), ElementsAre(0, 7));
    EXPECT_THAT(shape(std::string("PointData/") + field), ElementsAre(14, 3));
  }
  const std::vector<double> u = values("PointData/displacement_m");
  EXPECT_EQ(u[3 * 2], 102.0);        // first step, node 2, x
  EXPECT_EQ(u[3 * 2 + 1], 98.0);     // y
  EXPECT_EQ(u[3 * 2 + 2], 0.0);      // z
  EXPECT_EQ(u[3 * (7 + 2)], 202.0);  // second step
  EXPECT_EQ(values("PointData/velocity_m_per_s")[3 * (7 + 6) + 1], 1994.0);
}

TEST_F(SnapshotFiles, LargeFieldsArePutTogetherFromPieces) {
  mesh::Plate plate;
  plate.element_size_m = plate.width_m / 400;
  plate.corner = mesh::Corner::none;
  plate.sides = mesh::Sides::periodic;
  const auto mesh = mesh::make_plate(plate);
  const auto n = static_cast<std::size_t>(mesh.n_nodes());
  ASSERT_GT(n, 65536U);  // twice the piece
  motion::Snapshot snapshot;
  snapshot.u_m = snapshot.v_m_per_s = solid::Field(n);
  for (std::size_t k = 0; k < n; ++k) {
    snapshot.u_m.x[k] = static_cast<double>(k);
    snapshot.v_m_per_s.y[k] = -static_cast<double>(k);
  }
  write_snapshots(folder_ / "fields.vtkhdf", mesh::in_one_slab(std::make_shared<const mesh::Mesh>(mesh)),
                  series_of(std::vector{snapshot, snapshot}));
  const hdf5::File file = hdf5::open_file(folder_ / "fields.vtkhdf");
  const auto points = hdf5::read(file, "/VTKHDF/Points").values;
  const auto connectivity = hdf5::read(file, "/VTKHDF/Connectivity").values;
  const auto offsets = hdf5::read(file, "/VTKHDF/Offsets").values;
  const auto u = hdf5::read(file, "/VTKHDF/PointData/displacement_m").values;
  const auto v = hdf5::read(file, "/VTKHDF/PointData/velocity_m_per_s").values;
  ASSERT_EQ(points.size(), 3 * n);
  ASSERT_EQ(connectivity.size(), 4 * mesh.cells.size());
  ASSERT_EQ(offsets.size(), mesh.cells.size() + 1);
  ASSERT_EQ(u.size(), 6 * n);
  for (std::size_t k = 0; k < n; ++k) {
    ASSERT_EQ(points[3 * k], mesh.x_m[k]);
    ASSERT_EQ(points[3 * k + 1], mesh.y_m[k]);
    // The right edge moves as the left one.
    const std::size_t same = k % 401 == 400 ? k - 400 : k;
    for (const std::size_t step : {std::size_t{0}, n}) {
      ASSERT_EQ(u[3 * (step + k)], static_cast<double>(same));
      ASSERT_EQ(v[3 * (step + k) + 1], -static_cast<double>(same));
    }
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    ASSERT_EQ(offsets[c + 1], 4.0 * static_cast<double>(c + 1));
    const double first = connectivity[4 * c];
    ASSERT_EQ(first, mesh.cells[c][0]);
    ASSERT_EQ(connectivity[4 * c + 1], first + 1);  // across the seam too
    ASSERT_EQ(connectivity[4 * c + 2], first + 402);
    ASSERT_EQ(connectivity[4 * c + 3], first + 401);
  }
}

TEST_F(SnapshotFiles, WithoutSnapshotsHoldsTheMesh) {
  write_snapshots(folder_ / "fields.vtkhdf", two_cells(), SnapshotSeries());
  const hdf5::File file = hdf5::open_file(folder_ / "fields.vtkhdf");
  EXPECT_THAT(hdf5::read(file, "/VTKHDF/Points").shape, ElementsAre(7, 3));
  EXPECT_THAT(error_of([&] { hdf5::read(file, "/VTKHDF/Steps/Values"); }), HasSubstr("has no data set"));
}

}  // namespace
}  // namespace slipfront::results
