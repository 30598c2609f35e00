// SPDX-License-Identifier: BSD-3-Clause
#include "results/snapshots.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "files/files.hpp"
#include "results/hdf5.hpp"
#include "results/outputs.hpp"
#include "solid/element.hpp"

namespace slipfront::results {
namespace {

/// Rows that are put together at a time: what is written takes little memory beside the fields themselves.
constexpr std::size_t piece_rows = 32 * 1024;

constexpr const char* points = "/VTKHDF/Points";
constexpr const char* connectivity = "/VTKHDF/Connectivity";
constexpr const char* offsets = "/VTKHDF/Offsets";
constexpr const char* types = "/VTKHDF/Types";

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

solid::StrainAndStress at_centre(const mesh::Mesh& mesh, const mesh::Cell& cell, const solid::Field& u_m,
                                 const solid::Material& material,
                                 const std::optional<solid::UniformStress>& further, double time_s) {
  std::array<double, 8> of_nodes{};
  for (std::size_t a = 0; a < 4; ++a) {
    of_nodes[2 * a] = u_m.x[cell[a]];
    of_nodes[2 * a + 1] = u_m.y[cell[a]];
  }
  const auto shape = solid::cell_shape(solid::cell_coordinates(mesh, cell), 0, 0);
  return solid::strain_and_stress(shape, of_nodes, material, further, time_s);
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
  const auto joined = seam(slab.mesh, slab.first_node);
  const auto right_of = [&](std::size_t n) {
    return std::ranges::lower_bound(joined, std::pair(n, std::size_t{0}))->second;
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
        const auto number = slab.first_node + n;
        nodes.push_back(static_cast<std::int64_t>(round ? right_of(number) : number));
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

/// Strain and stress of the cells. @param u_m  of the slab's nodes @param first_row  of the snapshot
template <class F>
void for_tensors(const mesh::Slab& slab, const SnapshotContents& contents, const solid::Field& u_m,
                 double time_s, std::size_t first_row, F&& f) {
  const auto& bodies = contents.bodies;
  const auto all = components(bodies.front().material.plane);
  std::array<std::vector<double>, tensor_values_per_cell> values;
  std::size_t body = 0;
  for_pieces(0, slab.mesh.cells.size(), [&](std::size_t from, std::size_t end) {
    for (auto& column : values) column.clear();
    for (std::size_t c = from; c < end; ++c) {
      while (slab.first_cell + c >= bodies[body].end) ++body;
      const auto at = at_centre(slab.mesh, slab.mesh.cells[c], u_m, bodies[body].material,
                                contents.further_stress, time_s);
      for (std::size_t k = 0; k < all.size(); ++k)
        values[k].push_back((all[k].is_stress ? at.stress_Pa : at.strain).*all[k].member);
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      f(cell_data(all[k]), first_row + slab.first_cell + from, std::span<const double>(values[k]));
  });
}

/// What a file holds behind its rows, in this order.
std::vector<std::string> data_behind(const SnapshotContents& contents) {
  std::vector<std::string> names = {points, connectivity, offsets, types};
  if (!contents.bodies.empty())
    for (const auto& component : components(contents.bodies.front().material.plane))
      names.push_back(cell_data(component));
  return names;
}

/// Calls f for all that lies behind the rows, of the share of a writer.
template <class F>
void for_share(const Writer& writer, int number, const mesh::Slabs& mesh, const SnapshotContents& contents,
               RowReader& rows, std::size_t n_steps, F&& f) {
  if (number >= writer.count) return;
  const auto first = [&](int k) {
    return mesh.n_slabs * static_cast<std::size_t>(k) / static_cast<std::size_t>(writer.count);
  };
  mesh.for_some(first(number), first(number + 1), [&](const mesh::Slab& slab) {
    for_points(slab, f);
    for_corners(slab, f);
    for_cells(slab, f);
    if (contents.bodies.empty()) return;
    for (std::size_t k = 0; k < n_steps; ++k) {
      solid::Field u_m;  // cells reach into the next slab
      u_m.x = rows.read(k, 1 + slab.first_node, slab.mesh.x_m.size());
      u_m.y = rows.read(k, 1 + mesh.n_nodes + slab.first_node, slab.mesh.x_m.size());
      for_tensors(slab, contents, u_m, rows.read(k, 0, 1).front(), k * mesh.n_cells, f);
    }
  });
}

/// Makes all data sets, and fills those that are not as long as the mesh.
void describe(const hdf5::File& file, const hdf5::Rows& rows, const mesh::Slabs& mesh,
              const SnapshotContents& contents) {
  hdf5::create_group(file, "/VTKHDF");
  hdf5::set_attribute(file, "/VTKHDF", "Version", std::array<std::int64_t, 2>{2, 0});
  hdf5::set_ascii_attribute(file, "/VTKHDF", "Type", "UnstructuredGrid");
  const auto write = [&](const std::string& name, const std::vector<std::int64_t>& values,
                         hdf5::Shape shape = {}) {
    shape.insert(shape.begin(), values.size());
    hdf5::write(file, name, values, shape);
  };
  write("/VTKHDF/NumberOfPoints", {static_cast<std::int64_t>(mesh.n_nodes)});
  write("/VTKHDF/NumberOfCells", {static_cast<std::int64_t>(mesh.n_cells)});
  write("/VTKHDF/NumberOfConnectivityIds", {static_cast<std::int64_t>(4 * mesh.n_cells)});
  hdf5::create(file, points, hdf5::Type::float64, {mesh.n_nodes, 3});
  hdf5::create(file, connectivity, hdf5::Type::int64, {4 * mesh.n_cells});
  hdf5::create(file, offsets, hdf5::Type::int64, {mesh.n_cells + 1});
  hdf5::create(file, types, hdf5::Type::uint8, {mesh.n_cells});

  // All steps share the one mesh: its offsets stay at zero, only the data move on.
  const std::vector<std::int64_t> zeros(rows.n, 0), ones(rows.n, 1);
  const auto n_steps = static_cast<std::int64_t>(rows.n);
  hdf5::create_group(file, "/VTKHDF/Steps");
  hdf5::set_attribute(file, "/VTKHDF/Steps", "NSteps", std::span<const std::int64_t>(&n_steps, 1));
  hdf5::create_view(file, "/VTKHDF/Steps/Values", {rows.n}, rows, {{}});
  write("/VTKHDF/Steps/PartOffsets", zeros);
  write("/VTKHDF/Steps/NumberOfParts", ones);
  write("/VTKHDF/Steps/PointOffsets", zeros);
  write("/VTKHDF/Steps/CellOffsets", zeros, {1});
  write("/VTKHDF/Steps/ConnectivityIdOffsets", zeros, {1});
  const auto finish_data = [&](const std::string& kind, const std::string& name, std::size_t n,
                               const char* unit, const char* description) {
    hdf5::set_attribute(file, "/VTKHDF/" + kind + "/" + name, "unit", std::string(unit));
    hdf5::set_attribute(file, "/VTKHDF/" + kind + "/" + name, "description", std::string(description));
    std::vector<std::int64_t> first_rows;
    for (std::size_t k = 0; k < rows.n; ++k) first_rows.push_back(static_cast<std::int64_t>(k * n));
    write("/VTKHDF/Steps/" + kind + "Offsets/" + name, first_rows);
  };
  hdf5::create_group(file, "/VTKHDF/PointData");
  hdf5::create_group(file, "/VTKHDF/Steps/PointDataOffsets");
  const auto create_motion = [&](const char* name, std::size_t first, const char* unit,
                                 const char* description) {
    const auto n = mesh.n_nodes;
    hdf5::create_view(file, std::string("/VTKHDF/PointData/") + name, {rows.n * n, 3}, rows,
                      {{first, n, 0}, {first + n, n, 1}});
    finish_data("PointData", name, n, unit, description);
  };
  create_motion("displacement_m", 1, "m", "displacement of the points, x, y and 0");
  create_motion("velocity_m_per_s", 1 + 2 * mesh.n_nodes, "m/s",
                "velocity of the points, x, y and 0, half a step before the snapshot's time, in the "
                "interface layer half a sub-step");
  if (contents.bodies.empty()) return;
  hdf5::create_group(file, "/VTKHDF/CellData");
  hdf5::create_group(file, "/VTKHDF/Steps/CellDataOffsets");
  for (const auto& component : components(contents.bodies.front().material.plane)) {
    hdf5::create(file, cell_data(component), hdf5::Type::float64, {rows.n * mesh.n_cells});
    finish_data("CellData", component.name, mesh.n_cells, component.unit, component.description);
  }
}

/// Where rows of a data set lie in their file.
template <class T>
std::uint64_t place_of(const Layout& layout, const std::string& name, std::size_t first_row,
                       std::span<const T> values) {
  const auto& place = layout.place_of(name);
  SLIPFRONT_ASSERT(values.size_bytes() % place.row_bytes == 0 &&
                       first_row + values.size_bytes() / place.row_bytes <= place.n_rows,
                   "rows of a data set, all within it");
  return place.offset + first_row * place.row_bytes;
}

}  // namespace

RowFormat snapshot_format(const Origin& origin, std::size_t n_snapshots, std::size_t n_nodes) {
  constexpr std::size_t data_sets_of_steps = 7 + tensor_values_per_cell;
  return {.file = snapshot_output.file,
          .head_bytes = head_bytes(origin, sizeof(std::int64_t) * data_sets_of_steps * n_snapshots),
          .names = {"time", "u_x_m", "u_y_m", "v_x_m_per_s", "v_y_m_per_s"},
          .n_places = n_nodes};
}

Seam seam(const mesh::Mesh& mesh, std::size_t first) {
  Seam pairs;
  if (mesh.period_m == 0) return pairs;
  for (const auto& grid : mesh::blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j) {
      const auto left = first + static_cast<std::size_t>(grid.first) +
                        static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.stride());
      pairs.emplace_back(left, left + static_cast<std::size_t>(grid.columns));
    }
  return pairs;
}

void close_seam(std::span<double> values, std::size_t place, std::size_t n_nodes, const Seam& seam) {
  for (std::size_t first = 0; first < motion::n_motion_components * n_nodes; first += n_nodes) {
    auto pair = std::ranges::lower_bound(seam, place - std::min(place, first), {}, &Seam::value_type::second);
    for (; pair != seam.end() && first + pair->second < place + values.size(); ++pair) {
      const auto right = first + pair->second - place;
      values[right] = values[right - (pair->second - pair->first)];
    }
  }
}

void finish_snapshots(const std::filesystem::path& path, const mesh::Slabs& mesh,
                      const SnapshotContents& contents, const Writer& writer) {
  SLIPFRONT_ASSERT(contents.bodies.empty() || contents.bodies.back().end == mesh.n_cells,
                   "the bodies have all cells");
  std::optional<RowReader> reader;
  std::optional<Layout> layout;
  std::size_t n_steps = 0;
  writer.together([&] {
    const auto row_values = snapshot_format({}, 0, mesh.n_nodes).row_values();
    reader.emplace(path, row_values);
    n_steps = reader->n_rows();
    const hdf5::Rows rows{rows_name, n_steps, row_values};
    layout.emplace(
        path, reader->head_bytes(), rows, contents.origin,
        [&](const hdf5::File& file) { describe(file, rows, mesh, contents); }, data_behind(contents));
  });
  writer.together([&] {
    if (writer.leads()) files::PlacedFile(path).reserve(layout->bytes());
  });
  writer.together([&] {
    files::PlacedFile file(path);
    for_share(writer, writer.number, mesh, contents, *reader, n_steps,
              [&](const std::string& name, std::size_t row, const auto& values) {
                file.write_at(place_of(*layout, name, row, values), std::as_bytes(values));
              });
    file.sync();
    file.close();
  });
  writer.together([&] {
    // What another rank has written.
    const bool takes_part = writer.number < writer.count;
    for_share(writer, takes_part ? (writer.number + 1) % writer.count : writer.number, mesh, contents,
              *reader, n_steps, [&](const std::string& name, std::size_t row, const auto& values) {
                require_bytes(path, place_of(*layout, name, row, values), std::as_bytes(values));
              });
    if (writer.leads()) layout->finish();
  });
}

}  // namespace slipfront::results
