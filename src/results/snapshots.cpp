// SPDX-License-Identifier: BSD-3-Clause
#include "results/snapshots.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "solid/element.hpp"

namespace slipfront::results {
namespace {

/// Rows that are put together at a time: what is written takes little memory beside the fields themselves.
constexpr std::size_t piece_rows = 32 * 1024;

/// Most rows of a chunk; HDF5 takes chunks below 4 GiB.
constexpr std::size_t most_chunk_rows = 1U << 26U;

constexpr const char* displacement = "displacement_m";
constexpr const char* velocity = "velocity_m_per_s";
constexpr const char* displacement_text = "displacement of the points, x, y and 0";
constexpr const char* velocity_text =
    "velocity of the points, x, y and 0, half a step before the snapshot's time, in the interface layer half "
    "a "
    "sub-step";

/// Nodes of the left edge of a periodic plate and of the right one, which have the same motion.
std::vector<std::pair<mesh::Node, mesh::Node>> seam(const mesh::Mesh& mesh) {
  std::vector<std::pair<mesh::Node, mesh::Node>> pairs;
  if (mesh.period_m == 0) return pairs;
  for (const auto& grid : mesh::blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j) pairs.emplace_back(grid.node(0, j), grid.node(grid.columns, j));
  return pairs;
}

/// For each point of a periodic plate the one whose values it has: those of the right edge have those of the
/// left one. Empty for others.
std::vector<std::size_t> sources(const mesh::Mesh& mesh) {
  std::vector<std::size_t> source;
  if (mesh.period_m == 0) return source;
  source.resize(mesh.x_m.size());
  std::iota(source.begin(), source.end(), std::size_t{0});
  for (const auto& [left, right] : seam(mesh)) source[right] = left;
  return source;
}

/// Calls f(from, end) for the numbers below n, piece by piece.
template <class F>
void for_pieces(std::size_t n, F&& f) {
  for (std::size_t from = 0; from < n; from += piece_rows) f(from, std::min(from + piece_rows, n));
}

/// Calls f(first row, values) for the points of a mesh, x y z each, piece by piece.
template <class F>
void for_point_pieces(const mesh::Slabs& mesh, F&& f) {
  std::vector<double> values;
  mesh.for_each([&](const mesh::Slab& slab) {
    for_pieces(slab.n_own, [&](std::size_t from, std::size_t end) {
      values.clear();
      for (std::size_t k = from; k < end; ++k)
        values.insert(values.end(), {slab.mesh.x_m[k], slab.mesh.y_m[k], 0.0});
      f(slab.first_node + from, std::span<const double>(values));
    });
  });
}

/// The same for the corners of its cells. The last column of a periodic plate is drawn with nodes of its own.
template <class F>
void for_corner_pieces(const mesh::Slabs& mesh, F&& f) {
  std::vector<std::int64_t> nodes;
  mesh.for_each([&](const mesh::Slab& slab) {
    const auto joined = seam(slab.mesh);
    const auto right_of = [&](mesh::Node n) {
      return std::ranges::lower_bound(joined, std::pair(n, mesh::Node{0}))->second;
    };
    const auto& x_m = slab.mesh.x_m;
    const double period_m = slab.mesh.period_m;
    for_pieces(slab.mesh.cells.size(), [&](std::size_t from, std::size_t end) {
      nodes.clear();
      for (std::size_t c = from; c < end; ++c) {
        const mesh::Cell& cell = slab.mesh.cells[c];
        double right_most_m = 0;
        for (const mesh::Node n : cell) right_most_m = std::max(right_most_m, x_m[n]);
        for (const mesh::Node n : cell) {
          const bool round = period_m > 0 && right_most_m - x_m[n] > 0.5 * period_m;
          nodes.push_back(static_cast<std::int64_t>(slab.first_node) + (round ? right_of(n) : n));
        }
      }
      f(4 * (slab.first_cell + from), std::span<const std::int64_t>(nodes));
    });
  });
}

/// The same for the first corner of each cell in that list, and its end.
template <class F>
void for_offset_pieces(std::size_t n_cells, F&& f) {
  std::vector<std::int64_t> offsets;
  for_pieces(n_cells + 1, [&](std::size_t from, std::size_t end) {
    offsets.clear();
    for (std::size_t c = from; c < end; ++c) offsets.push_back(static_cast<std::int64_t>(4 * c));
    f(from, std::span<const std::int64_t>(offsets));
  });
}

/// The same for a field over the points.
template <class F>
void for_field_pieces(const mesh::Slabs& mesh, const NodeValues& field_of, F&& f) {
  std::vector<double> values;
  mesh.for_each([&](const mesh::Slab& slab) {
    const auto source = sources(slab.mesh);
    const auto field = field_of(slab.first_node, slab.n_own);
    for_pieces(slab.n_own, [&](std::size_t from, std::size_t end) {
      values.clear();
      for (std::size_t k = from; k < end; ++k) {
        const std::size_t node = source.empty() ? k : source[k];
        values.insert(values.end(), {field.x[node], field.y[node], 0.0});
      }
      f(slab.first_node + from, std::span<const double>(values));
    });
  });
}

/// A component of strain or stress, a data set of its own.
struct TensorComponent {
  const char* name;
  const char* unit;
  const char* description;
  bool is_stress;
  double solid::PlaneTensor::*member;
};

using TensorComponents = std::array<TensorComponent, tensor_values_per_cell>;

/// Those that are not 0 by the plane state, which both bodies share.
TensorComponents components(solid::Plane plane) {
  using T = solid::PlaneTensor;
  constexpr TensorComponent strain_zz = {"strain_zz", "1", "strain across the plane, at the cell's centre",
                                         false, &T::zz};
  constexpr TensorComponent stress_zz = {
      "stress_zz_Pa", "Pa", "elastic stress across the plane, at the cell's centre", true, &T::zz};
  return {{{"strain_xx", "1", "strain along x, at the cell's centre", false, &T::xx},
           {"strain_yy", "1", "strain along y, at the cell's centre", false, &T::yy},
           {"strain_xy", "1", "shear strain of the tensor, half the engineering one, at the cell's centre",
            false, &T::xy},
           {"stress_xx_Pa", "Pa", "elastic stress along x, positive in tension, at the cell's centre", true,
            &T::xx},
           {"stress_yy_Pa", "Pa", "elastic stress along y, at the cell's centre", true, &T::yy},
           {"stress_xy_Pa", "Pa", "elastic shear stress, at the cell's centre", true, &T::xy},
           plane == solid::Plane::stress ? strain_zz : stress_zz}};
}

struct StrainAndStress {
  solid::PlaneTensor strain, stress_Pa;
};

StrainAndStress at_centre(const mesh::Mesh& mesh, const mesh::Cell& cell, const solid::Field& u_m,
                          const solid::Material& material) {
  std::array<double, 8> of_nodes{};
  for (std::size_t a = 0; a < 4; ++a) {
    of_nodes[2 * a] = u_m.x[cell[a]];
    of_nodes[2 * a + 1] = u_m.y[cell[a]];
  }
  const auto shape = solid::cell_shape(solid::cell_coordinates(mesh, cell), 0, 0);
  const auto strain = solid::strain(shape, of_nodes, material);
  return {strain, solid::stress_Pa(strain, material)};
}

/// Calls f(component, first cell, values) for strain and stress of the cells, piece by piece.
template <class F>
void for_tensor_pieces(const mesh::Slabs& mesh, std::span<const CellsOfBody> bodies, const NodeValues& u_m,
                       F&& f) {
  if (bodies.empty()) return;
  const auto all = components(bodies.front().material.plane);
  std::array<std::vector<double>, tensor_values_per_cell> values;
  std::size_t body = 0;
  mesh.for_each([&](const mesh::Slab& slab) {
    const auto u_of_slab_m = u_m(slab.first_node, slab.mesh.x_m.size());
    for_pieces(slab.mesh.cells.size(), [&](std::size_t from, std::size_t end) {
      for (auto& column : values) column.clear();
      for (std::size_t c = from; c < end; ++c) {
        while (slab.first_cell + c >= bodies[body].end) ++body;
        const auto at = at_centre(slab.mesh, slab.mesh.cells[c], u_of_slab_m, bodies[body].material);
        for (std::size_t k = 0; k < all.size(); ++k)
          values[k].push_back((all[k].is_stress ? at.stress_Pa : at.strain).*all[k].member);
      }
      for (std::size_t k = 0; k < all.size(); ++k)
        f(all[k], slab.first_cell + from, std::span<const double>(values[k]));
    });
  });
}

constexpr std::uint8_t vtk_quad = 9;

/// The same for the types of the cells, which are one.
template <class F>
void for_type_pieces(std::size_t n_cells, F&& f) {
  for_pieces(n_cells, [&](std::size_t from, std::size_t end) {
    f(from, std::vector<std::uint8_t>(end - from, vtk_quad));
  });
}

void write_mesh(const hdf5::File& file, const mesh::Slabs& mesh) {
  const auto write_count = [&](const char* name, std::size_t n) {
    const auto value = static_cast<std::int64_t>(n);
    hdf5::write(file, name, std::span<const std::int64_t>(&value, 1), {1});
  };
  write_count("/VTKHDF/NumberOfPoints", mesh.n_nodes);
  write_count("/VTKHDF/NumberOfCells", mesh.n_cells);
  write_count("/VTKHDF/NumberOfConnectivityIds", 4 * mesh.n_cells);
  const auto into = [&](const char* name, hdf5::Type type, const hdf5::Shape& shape) {
    hdf5::create(file, name, type, shape);
    return [&file, name](std::size_t row, const auto& values) {
      hdf5::write_rows(file, name, row, std::span(values));
    };
  };
  for_point_pieces(mesh, into("/VTKHDF/Points", hdf5::Type::float64, {mesh.n_nodes, 3}));
  for_corner_pieces(mesh, into("/VTKHDF/Connectivity", hdf5::Type::int64, {4 * mesh.n_cells}));
  for_offset_pieces(mesh.n_cells, into("/VTKHDF/Offsets", hdf5::Type::int64, {mesh.n_cells + 1}));
  for_type_pieces(mesh.n_cells, into("/VTKHDF/Types", hdf5::Type::uint8, {mesh.n_cells}));
}

}  // namespace

SnapshotValues values_of(const motion::Snapshot& snapshot) {
  const auto some_of = [](const solid::Field& field) {
    return [&field](std::size_t first, std::size_t n) {
      solid::Field some(n);
      std::copy_n(field.x.begin() + static_cast<std::ptrdiff_t>(first), n, some.x.begin());
      std::copy_n(field.y.begin() + static_cast<std::ptrdiff_t>(first), n, some.y.begin());
      return some;
    };
  };
  return {snapshot.time_s, some_of(snapshot.u_m), some_of(snapshot.v_m_per_s)};
}

SnapshotFile::SnapshotFile(const std::filesystem::path& path, mesh::Slabs mesh, SnapshotContents contents)
    : file_(hdf5::create_file(path)), mesh_(std::move(mesh)), contents_(std::move(contents)) {
  SLIPFRONT_ASSERT(contents_.bodies.empty() || contents_.bodies.back().end == mesh_.n_cells,
                   "the bodies have all cells");
  hdf5::describe_root(file_, contents_.origin);
  hdf5::create_group(file_, "/VTKHDF");
  hdf5::set_attribute(file_, "/VTKHDF", "Version", std::array<std::int64_t, 2>{2, 0});
  hdf5::set_ascii_attribute(file_, "/VTKHDF", "Type", "UnstructuredGrid");
  write_mesh(file_, mesh_);
  hdf5::create_group(file_, "/VTKHDF/PointData");
  if (!contents_.bodies.empty()) hdf5::create_group(file_, "/VTKHDF/CellData");
}

void SnapshotFile::append_field(const std::string& name, const NodeValues& field) {
  const std::size_t n_points = mesh_.n_nodes;
  const std::string dataset = "/VTKHDF/PointData/" + name;
  if (time_s_.empty()) {
    hdf5::create_growing(file_, dataset, {3}, std::clamp<std::size_t>(n_points, 1, most_chunk_rows),
                         n_points <= most_chunk_rows ? hdf5::Chunks::whole : hdf5::Chunks::any);
    hdf5::set_attribute(file_, dataset, "unit", std::string(name == velocity ? "m/s" : "m"));
    hdf5::set_attribute(file_, dataset, "description",
                        std::string(name == velocity ? velocity_text : displacement_text));
  }
  hdf5::add_rows(file_, dataset, n_points);
  for_field_pieces(mesh_, field, [&](std::size_t row, std::span<const double> values) {
    hdf5::write_rows(file_, dataset, time_s_.size() * n_points + row, values);
  });
}

void SnapshotFile::append_tensors(const NodeValues& u_m) {
  const std::size_t n_cells = mesh_.n_cells;
  for_tensor_pieces(
      mesh_, contents_.bodies, u_m,
      [&](const TensorComponent& component, std::size_t first, std::span<const double> values) {
        const std::string dataset = std::string("/VTKHDF/CellData/") + component.name;
        if (time_s_.empty() && first == 0) {
          hdf5::create_growing(file_, dataset, {}, std::clamp<std::size_t>(n_cells, 1, most_chunk_rows));
          hdf5::set_attribute(file_, dataset, "unit", std::string(component.unit));
          hdf5::set_attribute(file_, dataset, "description", std::string(component.description));
        }
        if (first == 0) hdf5::add_rows(file_, dataset, n_cells);
        hdf5::write_rows(file_, dataset, time_s_.size() * n_cells + first, values);
      });
}

void SnapshotFile::append(const SnapshotValues& snapshot) {
  append_field(displacement, snapshot.u_m);
  append_field(velocity, snapshot.v_m_per_s);
  append_tensors(snapshot.u_m);
  time_s_.push_back(snapshot.time_s);
}

void SnapshotFile::close() {
  const std::size_t n_steps = time_s_.size();
  if (n_steps == 0) return hdf5::close(std::move(file_));  // readers take no grid of zero steps

  // All steps share the one mesh: its offsets stay at zero, only the point data move on.
  std::vector<std::int64_t> data_offsets;
  for (std::size_t k = 0; k < n_steps; ++k)
    data_offsets.push_back(static_cast<std::int64_t>(k * mesh_.n_nodes));
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
  for (const char* name : {displacement, velocity})
    hdf5::write(file_, std::string("/VTKHDF/Steps/PointDataOffsets/") + name, data_offsets, {n_steps});
  if (!contents_.bodies.empty()) {
    std::vector<std::int64_t> cell_offsets;
    for (std::size_t k = 0; k < n_steps; ++k)
      cell_offsets.push_back(static_cast<std::int64_t>(k * mesh_.n_cells));
    hdf5::create_group(file_, "/VTKHDF/Steps/CellDataOffsets");
    for (const auto& component : components(contents_.bodies.front().material.plane))
      hdf5::write(file_, std::string("/VTKHDF/Steps/CellDataOffsets/") + component.name, cell_offsets,
                  {n_steps});
  }
  hdf5::close(std::move(file_));
}

void write_snapshots(const std::filesystem::path& path, const mesh::Slabs& mesh,
                     std::span<const motion::Snapshot> snapshots, const SnapshotContents& contents) {
  SnapshotFile file(path, mesh, contents);
  for (const auto& snapshot : snapshots) file.append(values_of(snapshot));
  file.close();
  if (snapshots.empty()) return;
  const WrittenSnapshots written(path, mesh, contents);
  for (std::size_t k = 0; k < snapshots.size(); ++k) written.require(k, values_of(snapshots[k]));
  written.require_steps(snapshots.size());
}

WrittenSnapshots::WrittenSnapshots(const std::filesystem::path& path, mesh::Slabs mesh,
                                   SnapshotContents contents)
    : file_(hdf5::open_written_file(path)), mesh_(std::move(mesh)), contents_(std::move(contents)) {
  hdf5::require_root_described(file_, contents_.origin);
  // Whole numbers are read as doubles, which hold them exactly.
  const auto require_numbers = [&](const char* name) {
    return [this, name](std::size_t row, const auto& numbers) {
      hdf5::require_rows(file_, name, row, std::vector<double>(numbers.begin(), numbers.end()));
    };
  };
  for_point_pieces(mesh_, [&](std::size_t row, std::span<const double> values) {
    hdf5::require_rows(file_, "/VTKHDF/Points", row, values);
  });
  for_corner_pieces(mesh_, require_numbers("/VTKHDF/Connectivity"));
  for_offset_pieces(mesh_.n_cells, require_numbers("/VTKHDF/Offsets"));
  for_type_pieces(mesh_.n_cells, require_numbers("/VTKHDF/Types"));
}

void WrittenSnapshots::require(std::size_t step, const SnapshotValues& snapshot) const {
  hdf5::require_rows(file_, "/VTKHDF/Steps/Values", step, std::span(&snapshot.time_s, 1));
  const auto require_field = [&](const char* name, const NodeValues& field) {
    for_field_pieces(mesh_, field, [&](std::size_t row, std::span<const double> values) {
      hdf5::require_rows(file_, name, step * mesh_.n_nodes + row, values);
    });
  };
  require_field("/VTKHDF/PointData/displacement_m", snapshot.u_m);
  require_field("/VTKHDF/PointData/velocity_m_per_s", snapshot.v_m_per_s);
  for_tensor_pieces(mesh_, contents_.bodies, snapshot.u_m,
                    [&](const TensorComponent& component, std::size_t first, std::span<const double> values) {
                      hdf5::require_rows(file_, std::string("/VTKHDF/CellData/") + component.name,
                                         step * mesh_.n_cells + first, values);
                    });
}

void WrittenSnapshots::require_steps(std::size_t n) const {
  for (const char* name : {"/VTKHDF/PointData/displacement_m", "/VTKHDF/PointData/velocity_m_per_s"})
    hdf5::require_length(file_, name, n * mesh_.n_nodes);
}

}  // namespace slipfront::results
