// SPDX-License-Identifier: BSD-3-Clause
#include "results/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <numeric>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "files/files.hpp"
#include "histories.hpp"
#include "mesh/plate.hpp"
#include "results/table.hpp"
#include "support/files.hpp"
#include "support/results.hpp"

namespace slipfront::results {
namespace {

using test::error_of, test::FileSizeLimit;
using test::read, test::read_history, test::text_of, test::write_history, test::write_snapshots;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using HistoryFiles = test::InFolder;
using TextFiles = test::InFolder;
using SnapshotFiles = test::InFolder;

TEST_F(HistoryFiles, DataSetsHaveShapeUnitAndDescription) {
  const auto file = folder_ / "interface.h5";
  write_history(file, made_history(2, 3));
  const std::vector<std::pair<std::string, std::string>> units = {
      {"time_s", "s"}, {"x_m", "m"},  {"slip_m", "m"}, {"slip_rate_m_per_s", "m/s"},
      {"t_Pa", "Pa"},  {"p_Pa", "Pa"}};
  for (const auto& [name, unit] : units) {
    EXPECT_EQ(text_of(file, name, "unit"), unit);
    EXPECT_FALSE(text_of(file, name, "description").empty());
  }
  EXPECT_EQ(text_of(file, "/", "program"), "slipfront");
  EXPECT_THAT(read(file, "time_s").shape, ElementsAre(2));
  EXPECT_THAT(read(file, "x_m").shape, ElementsAre(3));
  EXPECT_THAT(read(file, "t_Pa").shape, ElementsAre(2, 3));
  EXPECT_EQ(read(file, "t_Pa").values[3], 3.4);  // row 1, column 0
}

TEST_F(HistoryFiles, TextsOfAnyLengthFitIntoTheHead) {
  for (const std::size_t n : {std::size_t{100}, std::size_t{1} << 20U}) {
    const std::string name = std::to_string(n), title(n, 't'), text(3 * n, 'c');
    const std::vector<record::ProbePlace> places = {{std::string(n, 'p'), 1, 2}, {"q", 3, 4}};
    const auto table = probe_table(places, {title, text});
    RowFile rows(folder_ / name, table.head_bytes());
    std::vector<double> row(table.row_values());
    std::iota(row.begin(), row.end(), 0);
    rows.write(row);
    rows.sync();
    finish(folder_ / name, table);
    EXPECT_EQ(text_of(folder_ / name, "/", "case"), text);
    EXPECT_THAT(read(folder_ / name, "y_m").values, ElementsAre(2, 4));
    EXPECT_THAT(read(folder_ / name, "u_y_m").values, ElementsAre(3, 4));
  }
}

TEST_F(HistoryFiles, ReadsBackBitwise) {
  for (const std::size_t rows : {0, 2}) {
    const auto file = folder_ / std::to_string(rows);
    write_history(file, made_history(rows, 3));
    EXPECT_TRUE(equal(read_history(file), made_history(rows, 3))) << rows;
  }
}

TEST_F(HistoryFiles, HDF5PrintsNothingItself) {
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of([&] { hdf5::open_file(folder_ / "none.h5", "name"); }),
              StartsWith("name: HDF5 cannot"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(HistoryFiles, GroupsCarryNoTime) {
  const auto file = hdf5::create_file(folder_ / "groups.h5", "groups.h5");
  hdf5::create_group(file, "/group");
  for (const char* name : {"/", "/group"}) {
    const hdf5::Handle group(H5Gopen2(file.handle.get(), name, H5P_DEFAULT), H5Gclose);
    H5O_info_t info{};
    ASSERT_GE(H5Oget_info2(group.get(), &info, H5O_INFO_TIME), 0);
    EXPECT_EQ(info.ctime, 0) << name;
  }
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
}

TEST_F(TextFiles, FollowNoLink) {
  const test::TemporaryFolder elsewhere;
  test::write_file(elsewhere / "precious", "x");
  std::filesystem::create_directory_symlink(elsewhere.path(), folder_ / "link");
  const std::vector<std::function<void(const std::filesystem::path&)>> writers = {
      [](const auto& file) { write_history(file, made_history(2, 3)); },
      [](const auto& file) { write_static(file, {}); },
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
  std::filesystem::create_symlink(elsewhere / "precious", folder_ / "static.csv");
  write_static(folder_ / "static.csv", {});
  EXPECT_EQ(test::read_file(elsewhere / "precious"), "x");
  EXPECT_THAT(test::names_below(elsewhere.path()), ElementsAre("precious"));
}

TEST_F(TextFiles, AFullDiskIsNoticed) {
  const auto history = made_history(1, 40000);
  const record::StaticState state = {history.x_m, history.x_m, history.x_m};
  std::string history_error, static_error;
  {
    const FileSizeLimit limit(128 * 1024);
    history_error = error_of([&] { write_history(folder_ / "interface.h5", history); });
    static_error = error_of([&] { write_static(folder_ / "static.csv", state); });
  }
  EXPECT_THAT(history_error,
              HasSubstr("interface.h5: cannot be written (File too large); allow larger files"));
  EXPECT_THAT(static_error,
              HasSubstr("static.csv.new: cannot be written (File too large); allow larger files"));
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
  write_static(folder_ / "static.csv", {{0, 0.1}, {1.0 / 3, -2}, {4e6, 5e6}},
               std::vector<NamedColumn>{{"mu_s", {0.5, nan}}});
  EXPECT_EQ(test::read_file(folder_ / "static.csv"),
            "x_m,t_s_Pa,p_s_Pa,mu_s\n"
            "0,0.3333333333333333,4000000,0.5\n"
            "0.1,-2,5000000,\n");
}

TEST_F(TextFiles, HoldFiniteNumbersAndEmptyFieldsWhereTheyMayBeMissing) {
  const auto is_refused = [&](const char* name, const char* column, auto&& write) {
    EXPECT_THROW(write(Numbers::finite), BlowUp) << column;
    EXPECT_THAT(error_of([&] { write(Numbers::finite); }),
                StartsWith((folder_ / name).string() + ": " + column + " is not finite"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
    write(Numbers::any);  // of what has blown up
    EXPECT_TRUE(std::filesystem::remove(folder_ / name));
  };
  for (const double value : {nan, infinity, -infinity}) {
    record::Energies energies;
    energies.friction_work = value;
    is_refused("energy.csv", "friction_work_J_per_m", [&](Numbers numbers) {
      write_energies(folder_ / "energy.csv", std::vector{energies}, numbers);
    });
    record::LoadingRow row;
    row.shear_over_normal = value;
    is_refused("loading.csv", "shear_over_normal",
               [&](Numbers numbers) { write_loading(folder_ / "loading.csv", std::vector{row}, numbers); });
    record::SequenceEvent event;
    event.max_slip_m = value;
    is_refused("events.csv", "max_slip_m",
               [&](Numbers numbers) { write_events(folder_ / "events.csv", std::vector{event}, numbers); });
  }
  record::SequenceEvent event;
  write_events(folder_ / "events.csv", std::vector{event});  // begin_x_m and others are not known
  EXPECT_TRUE(std::filesystem::remove(folder_ / "events.csv"));
  event.begin_x_m = infinity;
  is_refused("events.csv", "begin_x_m",
             [&](Numbers numbers) { write_events(folder_ / "events.csv", std::vector{event}, numbers); });
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
  write_snapshots(folder_.path(), two_cells(), std::vector{snapshot(1e-5, 100), snapshot(2e-5, 200)});
  const auto file = folder_ / "fields.vtkhdf";
  const auto values = [&](const std::string& name) { return read(file, "/VTKHDF/" + name).values; };
  const auto shape = [&](const std::string& name) { return read(file, "/VTKHDF/" + name).shape; };
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
  write_snapshots(folder_.path(), mesh::in_one_slab(std::make_shared<const mesh::Mesh>(mesh)),
                  std::vector{snapshot, snapshot}, {}, seam(mesh));
  const auto file = folder_ / "fields.vtkhdf";
  const auto points = read(file, "/VTKHDF/Points").values;
  const auto connectivity = read(file, "/VTKHDF/Connectivity").values;
  const auto offsets = read(file, "/VTKHDF/Offsets").values;
  const auto u = read(file, "/VTKHDF/PointData/displacement_m").values;
  const auto v = read(file, "/VTKHDF/PointData/velocity_m_per_s").values;
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

}  // namespace
}  // namespace slipfront::results
