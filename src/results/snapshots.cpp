// SPDX-License-Identifier: BSD-3-Clause
#include "results/snapshots.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "files/files.hpp"
#include "results/hdf5.hpp"
#include "solid/element.hpp"

namespace slipfront::results {
namespace {

/// Rows that are put together at a time: what is written takes little memory beside the fields themselves.
constexpr std::size_t piece_rows = 32 * 1024;

constexpr const char* points = "/VTKHDF/Points";
constexpr const char* connectivity = "/VTKHDF/Connectivity";
constexpr const char* offsets = "/VTKHDF/Offsets";
constexpr const char* types = "/VTKHDF/Types";
constexpr const char* displacement = "/VTKHDF/PointData/displacement_m";
constexpr const char* velocity = "/VTKHDF/PointData/velocity_m_per_s";

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

/// Calls f(from, end) for the numbers [begin, end), piece by piece.
template <class F>
void for_pieces(std::size_t begin, std::size_t end, F&& f) {
  for (std::size_t from = begin; from < end; from += piece_rows) f(from, std::min(from + piece_rows, end));
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

std::string cell_data(const TensorComponent& component) {
  return std::string("/VTKHDF/CellData/") + component.name;
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

constexpr std::uint8_t vtk_quad = 9;

// What a file holds of a slab: calls f(data set, first row, values), piece by piece.

/// Points, x y z each.
template <class F>
void for_points(const mesh::Slab& slab, F&& f) {
  std::vector<double> values;
  for_pieces(0, slab.n_own, [&](std::size_t from, std::size_t end) {
    values.clear();
    for (std::size_t k = from; k < end; ++k)
      values.insert(values.end(), {slab.mesh.x_m[k], slab.mesh.y_m[k], 0.0});
    f(points, slab.first_node + from, std::span<const double>(values));
  });
}

/// Corners of the cells. The last column of a periodic plate is drawn with nodes of its own.
template <class F>
void for_corners(const mesh::Slab& slab, F&& f) {
  std::vector<std::int64_t> nodes;
  const auto joined = seam(slab.mesh);
  const auto right_of = [&](mesh::Node n) {
    return std::ranges::lower_bound(joined, std::pair(n, mesh::Node{0}))->second;
  };
  const auto& x_m = slab.mesh.x_m;
  const double period_m = slab.mesh.period_m;
  for_pieces(0, slab.mesh.cells.size(), [&](std::size_t from, std::size_t end) {
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
    f(connectivity, 4 * (slab.first_cell + from), std::span<const std::int64_t>(nodes));
  });
}

/// Where each cell's corners end in their list, and for the first cell where they begin; and its type.
template <class F>
void for_cells(const mesh::Slab& slab, F&& f) {
  const auto first = slab.first_cell, end_of_slab = first + slab.mesh.cells.size();
  std::vector<std::int64_t> ends;
  for_pieces(first == 0 ? 0 : first + 1, end_of_slab + 1, [&](std::size_t from, std::size_t end) {
    ends.clear();
    for (std::size_t c = from; c < end; ++c) ends.push_back(static_cast<std::int64_t>(4 * c));
    f(offsets, from, std::span<const std::int64_t>(ends));
  });
  for_pieces(first, end_of_slab, [&](std::size_t from, std::size_t end) {
    const std::vector<std::uint8_t> quads(end - from, vtk_quad);
    f(types, from, std::span<const std::uint8_t>(quads));
  });
}

/// A field over the points. @param first_row  of the snapshot
template <class F>
void for_field(const mesh::Slab& slab, const char* name, const solid::Field& field, std::size_t first_row,
               F&& f) {
  const auto source = sources(slab.mesh);
  std::vector<double> values;
  for_pieces(0, slab.n_own, [&](std::size_t from, std::size_t end) {
    values.clear();
    for (std::size_t k = from; k < end; ++k) {
      const std::size_t node = source.empty() ? k : source[k];
      values.insert(values.end(), {field.x[node], field.y[node], 0.0});
    }
    f(name, first_row + slab.first_node + from, std::span<const double>(values));
  });
}

/// Strain and stress of the cells. @param u_m  of the slab's nodes @param first_row  of the snapshot
template <class F>
void for_tensors(const mesh::Slab& slab, std::span<const CellsOfBody> bodies, const solid::Field& u_m,
                 std::size_t first_row, F&& f) {
  const auto all = components(bodies.front().material.plane);
  std::array<std::vector<double>, tensor_values_per_cell> values;
  std::size_t body = 0;
  for_pieces(0, slab.mesh.cells.size(), [&](std::size_t from, std::size_t end) {
    for (auto& column : values) column.clear();
    for (std::size_t c = from; c < end; ++c) {
      while (slab.first_cell + c >= bodies[body].end) ++body;
      const auto at = at_centre(slab.mesh, slab.mesh.cells[c], u_m, bodies[body].material);
      for (std::size_t k = 0; k < all.size(); ++k)
        values[k].push_back((all[k].is_stress ? at.stress_Pa : at.strain).*all[k].member);
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      f(cell_data(all[k]), first_row + slab.first_cell + from, std::span<const double>(values[k]));
  });
}

/// What a file holds, but for what does not grow with the mesh.
struct FileData {
  const mesh::Slabs& mesh;
  const SnapshotSeries& series;
  const SnapshotContents& contents;

  /// Of the share of a writer.
  template <class F>
  void for_share(int number, int count, F&& f) const {
    if (number >= count) return;
    const auto first = [&](int k) {
      return mesh.n_slabs * static_cast<std::size_t>(k) / static_cast<std::size_t>(count);
    };
    mesh.for_some(first(number), first(number + 1), [&](const mesh::Slab& slab) { for_slab(slab, f); });
  }

 private:
  template <class F>
  void for_slab(const mesh::Slab& slab, F&& f) const {
    for_points(slab, f);
    for_corners(slab, f);
    for_cells(slab, f);
    const bool has_tensors = !contents.bodies.empty();
    for (std::size_t k = 0; k < series.time_s.size(); ++k) {
      // Cells reach into the next slab.
      const auto u_m = series.u_m(k, slab.first_node, has_tensors ? slab.mesh.x_m.size() : slab.n_own);
      for_field(slab, displacement, u_m, k * mesh.n_nodes, f);
      if (has_tensors) for_tensors(slab, contents.bodies, u_m, k * mesh.n_cells, f);
      for_field(slab, velocity, series.v_m_per_s(k, slab.first_node, slab.n_own), k * mesh.n_nodes, f);
    }
  }
};

/// Makes the file with all data sets, and fills those that are not as long as the mesh.
void lay_out(const std::filesystem::path& path, const FileData& data) {
  const auto& mesh = data.mesh;
  const auto& series = data.series;
  const auto& contents = data.contents;
  auto file = hdf5::create_file(path);
  hdf5::describe_root(file, contents.origin);
  hdf5::create_group(file, "/VTKHDF");
  hdf5::set_attribute(file, "/VTKHDF", "Version", std::array<std::int64_t, 2>{2, 0});
  hdf5::set_ascii_attribute(file, "/VTKHDF", "Type", "UnstructuredGrid");
  const auto write_count = [&](const char* name, std::size_t n) {
    const auto value = static_cast<std::int64_t>(n);
    hdf5::write(file, name, std::span<const std::int64_t>(&value, 1), {1});
  };
  write_count("/VTKHDF/NumberOfPoints", mesh.n_nodes);
  write_count("/VTKHDF/NumberOfCells", mesh.n_cells);
  write_count("/VTKHDF/NumberOfConnectivityIds", 4 * mesh.n_cells);
  hdf5::create(file, points, hdf5::Type::float64, {mesh.n_nodes, 3});
  hdf5::create(file, connectivity, hdf5::Type::int64, {4 * mesh.n_cells});
  hdf5::create(file, offsets, hdf5::Type::int64, {mesh.n_cells + 1});
  hdf5::create(file, types, hdf5::Type::uint8, {mesh.n_cells});
  hdf5::create_group(file, "/VTKHDF/PointData");
  if (!contents.bodies.empty()) hdf5::create_group(file, "/VTKHDF/CellData");
  const std::size_t n_steps = series.time_s.size();
  if (n_steps == 0) return hdf5::close(std::move(file));  // readers take no grid of zero steps

  // All steps share the one mesh: its offsets stay at zero, only the data move on.
  const std::vector<std::int64_t> zeros(n_steps, 0), ones(n_steps, 1);
  const auto count = static_cast<std::int64_t>(n_steps);
  hdf5::create_group(file, "/VTKHDF/Steps");
  hdf5::set_attribute(file, "/VTKHDF/Steps", "NSteps", std::span<const std::int64_t>(&count, 1));
  hdf5::write(file, "/VTKHDF/Steps/Values", series.time_s, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/PartOffsets", zeros, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/NumberOfParts", ones, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/PointOffsets", zeros, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/CellOffsets", zeros, {n_steps, 1});
  hdf5::write(file, "/VTKHDF/Steps/ConnectivityIdOffsets", zeros, {n_steps, 1});
  const auto create = [&](const std::string& name, const hdf5::Shape& of_step, const char* unit,
                          const char* description) {
    auto shape = of_step;
    shape.front() *= n_steps;
    hdf5::create(file, name, hdf5::Type::float64, shape);
    hdf5::set_attribute(file, name, "unit", std::string(unit));
    hdf5::set_attribute(file, name, "description", std::string(description));
  };
  const auto write_offsets = [&](const std::string& name, std::size_t rows) {
    std::vector<std::int64_t> first_rows;
    for (std::size_t k = 0; k < n_steps; ++k) first_rows.push_back(static_cast<std::int64_t>(k * rows));
    hdf5::write(file, name, first_rows, {n_steps});
  };
  create(displacement, {mesh.n_nodes, 3}, "m", "displacement of the points, x, y and 0");
  create(velocity, {mesh.n_nodes, 3}, "m/s",
         "velocity of the points, x, y and 0, half a step before the snapshot's time, in the interface layer "
         "half a sub-step");
  hdf5::create_group(file, "/VTKHDF/Steps/PointDataOffsets");
  write_offsets("/VTKHDF/Steps/PointDataOffsets/displacement_m", mesh.n_nodes);
  write_offsets("/VTKHDF/Steps/PointDataOffsets/velocity_m_per_s", mesh.n_nodes);
  if (!contents.bodies.empty()) {
    hdf5::create_group(file, "/VTKHDF/Steps/CellDataOffsets");
    for (const auto& component : components(contents.bodies.front().material.plane)) {
      create(cell_data(component), {mesh.n_cells}, component.unit, component.description);
      write_offsets(std::string("/VTKHDF/Steps/CellDataOffsets/") + component.name, mesh.n_cells);
    }
  }
  hdf5::close(std::move(file));
}

/// Puts numbers into the data sets of a file that is laid out.
class Filler {
 public:
  explicit Filler(const std::filesystem::path& path) : layout_(hdf5::open_written_file(path)), file_(path) {}

  template <class T>
  void write_rows(const std::string& name, std::size_t first_row, std::span<const T> values) {
    const auto place = place_of(name);
    SLIPFRONT_ASSERT(values.size_bytes() % place.row_bytes == 0 &&
                         first_row + values.size_bytes() / place.row_bytes <= place.n_rows,
                     "rows of a data set, all within it");
    file_.write_at(place.offset + first_row * place.row_bytes, std::as_bytes(values));
  }
  void close() {
    file_.sync();
    file_.close();
  }

 private:
  hdf5::Place place_of(const std::string& name) {
    const auto [at, is_new] = places_.try_emplace(name);
    if (is_new) at->second = hdf5::place_of(layout_, name);
    return at->second;
  }

  hdf5::File layout_;
  files::PlacedFile file_;
  std::map<std::string, hdf5::Place> places_;
};

/// Compares what lay_out has written.
void require_layout(const hdf5::File& file, const FileData& data) {
  hdf5::require_root_described(file, data.contents.origin);
  const auto n_steps = data.series.time_s.size();
  if (n_steps == 0) return;
  hdf5::require_rows(file, "/VTKHDF/Steps/Values", 0, data.series.time_s);
  for (const char* name : {displacement, velocity})
    hdf5::require_length(file, name, n_steps * data.mesh.n_nodes);
}

}  // namespace

SnapshotSeries series_of(std::span<const motion::Snapshot> snapshots) {
  const auto some_of = [snapshots](solid::Field motion::Snapshot::*member) {
    return [snapshots, member](std::size_t k, std::size_t first, std::size_t n) {
      const auto& field = snapshots[k].*member;
      solid::Field some(n);
      std::copy_n(field.x.begin() + static_cast<std::ptrdiff_t>(first), n, some.x.begin());
      std::copy_n(field.y.begin() + static_cast<std::ptrdiff_t>(first), n, some.y.begin());
      return some;
    };
  };
  SnapshotSeries series{{}, some_of(&motion::Snapshot::u_m), some_of(&motion::Snapshot::v_m_per_s)};
  for (const auto& snapshot : snapshots) series.time_s.push_back(snapshot.time_s);
  return series;
}

void write_snapshots(const std::filesystem::path& path, const mesh::Slabs& mesh, const SnapshotSeries& series,
                     const SnapshotContents& contents, const Writer& writer) {
  SLIPFRONT_ASSERT(contents.bodies.empty() || contents.bodies.back().end == mesh.n_cells,
                   "the bodies have all cells");
  const FileData data{mesh, series, contents};
  writer.together([&] {
    if (!writer.leads()) return;
    lay_out(path, data);
    files::PlacedFile(path).reserve();
  });
  writer.together([&] {
    Filler filler(path);
    data.for_share(writer.number, writer.count,
                   [&](const std::string& name, std::size_t row, const auto& values) {
                     filler.write_rows(name, row, values);
                   });
    filler.close();
  });
  writer.together([&] {
    const auto file = hdf5::open_written_file(path);
    if (writer.leads()) require_layout(file, data);
    if (writer.number >= writer.count) return;
    // What another rank has written.
    data.for_share((writer.number + 1) % writer.count, writer.count,
                   [&](const std::string& name, std::size_t row, const auto& values) {
                     // Whole numbers are read as doubles, which hold them exactly.
                     hdf5::require_rows(file, name, row, std::vector<double>(values.begin(), values.end()));
                   });
  });
}

}  // namespace slipfront::results
