// SPDX-License-Identifier: BSD-3-Clause
#include "io/snapshots.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/error.hpp"

namespace slipfront::io {
namespace {

/// Rows that are put together at a time: what is written takes little memory beside the fields themselves.
constexpr std::size_t piece_rows = 32 * 1024;

/// Most rows of a chunk; HDF5 takes chunks below 4 GiB.
constexpr std::size_t most_chunk_rows = 1U << 26U;

/// Writes rows [first_row, first_row + n_rows) of a data set, each filled by fill(row, values).
template <class T, std::size_t width, class Fill>
void write_in_pieces(const hdf5::File& file, const std::string& name, std::size_t first_row,
                     std::size_t n_rows, Fill&& fill) {
  std::vector<T> values;
  for (std::size_t from = 0; from < n_rows; from += piece_rows) {
    const std::size_t n = std::min(piece_rows, n_rows - from);
    values.resize(width * n);
    for (std::size_t k = 0; k < n; ++k) fill(from + k, &values[width * k]);
    hdf5::write_rows(file, name, first_row + from, values);
  }
}

/// Nodes of the left edge of a periodic plate and of the right one, which have the same motion.
std::vector<std::pair<mesh::Node, mesh::Node>> seam(const mesh::Mesh& mesh) {
  std::vector<std::pair<mesh::Node, mesh::Node>> pairs;
  if (mesh.period_m == 0) return pairs;
  for (const auto& grid : mesh::blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j) pairs.emplace_back(grid.node(0, j), grid.node(grid.columns, j));
  return pairs;
}

void write_mesh(const hdf5::File& file, const mesh::Mesh& mesh) {
  constexpr std::uint8_t vtk_quad = 9;
  const std::size_t n_points = mesh.x_m.size(), n_cells = mesh.cells.size();
  const auto write_count = [&](const char* name, std::size_t n) {
    const auto value = static_cast<std::int64_t>(n);
    hdf5::write(file, name, std::span<const std::int64_t>(&value, 1), {1});
  };
  write_count("/VTKHDF/NumberOfPoints", n_points);
  write_count("/VTKHDF/NumberOfCells", n_cells);
  write_count("/VTKHDF/NumberOfConnectivityIds", 4 * n_cells);
  hdf5::create(file, "/VTKHDF/Points", hdf5::Type::float64, {n_points, 3});
  write_in_pieces<double, 3>(file, "/VTKHDF/Points", 0, n_points, [&](std::size_t n, double* point) {
    point[0] = mesh.x_m[n];
    point[1] = mesh.y_m[n];
    point[2] = 0;
  });
  hdf5::create(file, "/VTKHDF/Connectivity", hdf5::Type::int64, {4 * n_cells});
  // The last column of a periodic plate is drawn with nodes of its own.
  const auto joined = seam(mesh);
  const auto right_of = [&](mesh::Node n) {
    return std::ranges::lower_bound(joined, std::pair(n, mesh::Node{0}))->second;
  };
  // Whole cells to a piece: rows of one number here.
  std::vector<std::int64_t> nodes;
  for (std::size_t from = 0; from < n_cells; from += piece_rows) {
    nodes.clear();
    for (std::size_t c = from; c < std::min(from + piece_rows, n_cells); ++c) {
      const mesh::Cell& cell = mesh.cells[c];
      double right_most_m = 0;
      for (const mesh::Node n : cell) right_most_m = std::max(right_most_m, mesh.x_m[n]);
      for (const mesh::Node n : cell) {
        const bool round = mesh.period_m > 0 && right_most_m - mesh.x_m[n] > 0.5 * mesh.period_m;
        nodes.push_back(round ? right_of(n) : n);
      }
    }
    hdf5::write_rows(file, "/VTKHDF/Connectivity", 4 * from, nodes);
  }
  hdf5::create(file, "/VTKHDF/Offsets", hdf5::Type::int64, {n_cells + 1});
  write_in_pieces<std::int64_t, 1>(
      file, "/VTKHDF/Offsets", 0, n_cells + 1,
      [](std::size_t c, std::int64_t* offset) { *offset = static_cast<std::int64_t>(4 * c); });
  hdf5::write(file, "/VTKHDF/Types", std::vector<std::uint8_t>(n_cells, vtk_quad), {n_cells});
}

}  // namespace

SnapshotFile::SnapshotFile(const std::filesystem::path& path, const mesh::Mesh& mesh,
                           const std::filesystem::path& shown)
    : file_(hdf5::create_file(path, shown)), n_points_(mesh.x_m.size()) {
  if (mesh.period_m > 0) {
    source_.resize(n_points_);
    std::iota(source_.begin(), source_.end(), std::size_t{0});
    for (const auto& [left, right] : seam(mesh)) source_[right] = left;
  }
  hdf5::create_group(file_, "/VTKHDF");
  hdf5::set_attribute(file_, "/VTKHDF", "Version", std::array<std::int64_t, 2>{2, 0});
  hdf5::set_ascii_attribute(file_, "/VTKHDF", "Type", "UnstructuredGrid");
  write_mesh(file_, mesh);
  hdf5::create_group(file_, "/VTKHDF/PointData");
}

void SnapshotFile::append_field(const std::string& name, const solid::Field& field) {
  SLIPFRONT_ASSERT(field.size() == n_points_, "a snapshot does not fit its mesh");
  const std::string dataset = "/VTKHDF/PointData/" + name;
  if (time_s_.empty())
    hdf5::create_growing(file_, dataset, {3}, std::clamp<std::size_t>(n_points_, 1, most_chunk_rows),
                         n_points_ <= most_chunk_rows);
  hdf5::add_rows(file_, dataset, n_points_);
  write_in_pieces<double, 3>(file_, dataset, time_s_.size() * n_points_, n_points_,
                             [&](std::size_t n, double* vector) {
                               if (!source_.empty()) n = source_[n];
                               vector[0] = field.x[n];
                               vector[1] = field.y[n];
                               vector[2] = 0;
                             });
}

void SnapshotFile::append(const solve::Snapshot& snapshot) {
  append_field("displacement_m", snapshot.u_m);
  append_field("velocity_m_per_s", snapshot.v_m_per_s);
  time_s_.push_back(snapshot.time_s);
  hdf5::flush(file_);
}

void SnapshotFile::close() {
  const std::size_t n_steps = time_s_.size();
  if (n_steps == 0) return hdf5::close(std::move(file_));  // readers take no grid of zero steps

  // All steps share the one mesh: its offsets stay at zero, only the point data move on.
  std::vector<std::int64_t> data_offsets;
  for (std::size_t k = 0; k < n_steps; ++k) data_offsets.push_back(static_cast<std::int64_t>(k * n_points_));
  const std::vector<std::int64_t> zeros(n_steps, 0), ones(n_steps, 1);
  const auto count = static_cast<std::int64_t>(n_steps);
  hdf5::create_group(file_, "/VTKHDF/Steps");
  hdf5::set_attribute(file_, "/VTKHDF/Steps", "NSteps", std::span<const std::int64_t>(&count, 1));
  hdf5::write(file_, "/VTKHDF/Steps/Values", time_s_, {n_steps});
  hdf5::write(file_, "/VTKHDF/Steps/PartOffsets", zeros, {n_steps});
  hdf5::write(file_, "/VTKHDF/Steps/NumberOfParts", ones, {n_steps});
  hdf5::write(file_, "/VTKHDF/Steps/PointOffsets", zeros, {n_steps});
  hdf5::write(file_, "/VTKHDF/Steps/CellOffsets", zeros, {n_steps, 1});
  hdf5::write(file_, "/VTKHDF/Steps/ConnectivityIdOffsets", zeros, {n_steps, 1});
  hdf5::create_group(file_, "/VTKHDF/Steps/PointDataOffsets");
  for (const char* name : {"displacement_m", "velocity_m_per_s"})
    hdf5::write(file_, std::string("/VTKHDF/Steps/PointDataOffsets/") + name, data_offsets, {n_steps});
  hdf5::close(std::move(file_));
}

void write_snapshots(const std::filesystem::path& path, const mesh::Mesh& mesh,
                     std::span<const solve::Snapshot> snapshots) {
  SnapshotFile file(path, mesh);
  for (const auto& snapshot : snapshots) file.append(snapshot);
  file.close();
}

}  // namespace slipfront::io
