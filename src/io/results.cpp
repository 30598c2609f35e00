// SPDX-License-Identifier: BSD-3-Clause
#include "io/results.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
#include "io/hdf5.hpp"

namespace slipfront::io {
namespace {

using fronts::History;

/// A data set of interface.h5.
struct Column {
  const char* name;
  std::vector<double> History::*values;
  const char* unit;
  const char* description;
};

constexpr std::array<Column, 2> axes = {{
    {"time_s", &History::time_s, "s", "time since the start of the event"},
    {"x_m", &History::x_m, "m", "position along the interface from the left edge"},
}};
constexpr std::array<Column, 4> matrices = {{
    {"slip_m", &History::slip_m, "m", "displacement of the plate along x since the start, [times, nodes]"},
    {"slip_rate_m_per_s", &History::slip_rate_m_per_s, "m/s",
     "velocity of the plate along x, [times, nodes]"},
    {"t_Pa", &History::t_Pa, "Pa", "tangential traction, positive against sliding to +x, [times, nodes]"},
    {"p_Pa", &History::p_Pa, "Pa", "contact pressure, positive in compression, [times, nodes]"},
}};

/// What a run writes.
constexpr std::array<const char*, 7> result_files = {"case.resolved.toml", "run.json",   "interface.h5",
                                                     "fronts.csv",         "static.csv", "energy.csv",
                                                     "fields.vtkhdf"};

void write_column(const hdf5::File& file, const Column& column, const History& history,
                  const hdf5::Shape& shape) {
  hdf5::write(file, column.name, history.*column.values, shape);
  hdf5::set_attribute(file, column.name, "unit", std::string(column.unit));
  hdf5::set_attribute(file, column.name, "description", std::string(column.description));
}

std::vector<double> read_axis(const hdf5::File& file, const Column& column) {
  hdf5::Array array = hdf5::read(file, column.name);
  const std::string path = file.path.string();
  if (array.shape.size() != 1)
    throw UserError("{}: {} has {} dimensions; it must have one", path, column.name, array.shape.size());
  for (std::size_t i = 0; i < array.values.size(); ++i)
    if (!std::isfinite(array.values[i]) || (i > 0 && array.values[i] <= array.values[i - 1]))
      throw UserError("{}: {} is {} at index {}; its values must be finite and ascending", path, column.name,
                      array.values[i], i);
  return std::move(array.values);
}

std::vector<double> read_matrix(const hdf5::File& file, const Column& column, const hdf5::Shape& shape) {
  hdf5::Array array = hdf5::read(file, column.name);
  if (array.shape != shape) {
    std::string lengths;
    for (const hsize_t length : array.shape)
      lengths += fmt::format("{}{}", lengths.empty() ? "" : ", ", length);
    throw UserError("{}: {} has the shape [{}]; with time_s and x_m it must be [{}, {}]", file.path.string(),
                    column.name, lengths, shape[0], shape[1]);
  }
  return std::move(array.values);
}

/// A field of a CSV file; empty where the value is undefined.
std::string field(double value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

/// (x, y) pairs as the (x, y, 0) triples that VTK wants.
std::vector<double> triples(const std::vector<double>& x, const std::vector<double>& y) {
  SLIPFRONT_ASSERT(x.size() == y.size(), "components of a vector field differ in length");
  std::vector<double> result;
  result.reserve(3 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result.insert(result.end(), {x[i], y[i], 0.0});
  return result;
}

}  // namespace

void write_text(const std::filesystem::path& file, std::string_view text) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text << std::flush;
  if (!stream)
    throw UserError("{}: cannot be written ({}); check that its folder exists and can be written",
                    file.string(), std::strerror(errno));
}

void prepare_output_folder(const std::filesystem::path& dir, bool overwrite) {
  claim_output_folder(dir, overwrite);
  remove_results(dir);
}

std::filesystem::path claim_output_folder(const std::filesystem::path& dir, bool overwrite) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(dir, error);
  if (fs::exists(status) && !fs::is_directory(status))
    throw UserError("output folder {}: is a file; choose another name", dir.string());
  fs::path made;
  for (fs::path p = dir; !p.empty() && !fs::exists(p, error); p = p.parent_path()) made = p;
  fs::create_directories(dir, error);
  if (error)
    throw UserError("output folder {}: cannot be made ({}); choose another place", dir.string(),
                    error.message());
  if (::access(dir.c_str(), W_OK | X_OK) != 0)
    throw UserError("output folder {}: cannot be written ({}); choose another place", dir.string(),
                    std::strerror(errno));
  const bool empty = fs::is_empty(dir, error);
  if (error)
    throw UserError("output folder {}: cannot be read ({}); choose another place", dir.string(),
                    error.message());
  if (!empty && !overwrite)
    throw UserError(
        "output folder {}: is not empty; choose another or pass --overwrite to replace a run's results",
        dir.string());
  for (const char* name : result_files)
    if (fs::is_directory(fs::symlink_status(dir / name, error)))
      throw UserError("{}: is a folder where a result file is to go; move it away", (dir / name).string());
  return made;
}

void remove_results(const std::filesystem::path& dir) {
  std::error_code error;
  for (const char* name : result_files) {
    const auto file = dir / name;
    std::filesystem::remove(file, error);
    if (error)
      throw UserError("{}: cannot be removed ({}); remove it by hand", file.string(), error.message());
  }
}

void write_history(const std::filesystem::path& path, const History& history) {
  const hdf5::Shape shape = {history.time_s.size(), history.x_m.size()};
  hdf5::File file = hdf5::create_file(path);
  for (const Column& axis : axes) write_column(file, axis, history, {(history.*axis.values).size()});
  for (const Column& matrix : matrices) write_column(file, matrix, history, shape);
  hdf5::close(std::move(file));
}

History read_history(const std::filesystem::path& path) {
  const hdf5::File file = hdf5::open_file(path);
  History history;
  for (const Column& axis : axes) history.*axis.values = read_axis(file, axis);
  const hdf5::Shape shape = {history.time_s.size(), history.x_m.size()};
  for (const Column& matrix : matrices) history.*matrix.values = read_matrix(file, matrix, shape);
  return history;
}

void write_static(const std::filesystem::path& file, const fronts::StaticState& state) {
  SLIPFRONT_ASSERT(state.t_s_Pa.size() == state.x_m.size() && state.p_s_Pa.size() == state.x_m.size(),
                   "columns of the static state differ in length");
  std::string text = "x_m,t_s_Pa,p_s_Pa\n";
  for (std::size_t i = 0; i < state.x_m.size(); ++i)
    text += fmt::format("{},{},{}\n", field(state.x_m[i]), field(state.t_s_Pa[i]), field(state.p_s_Pa[i]));
  write_text(file, text);
}

void write_energies(const std::filesystem::path& file, std::span<const solve::Energies> energies) {
  std::string text =
      "time_s,strain_J_per_m,kinetic_J_per_m,top_work_J_per_m,trigger_work_J_per_m,prestress_work_J_per_m,"
      "friction_work_J_per_m,contact_work_J_per_m,damping_work_J_per_m,boundary_work_J_per_m,"
      "coupling_work_J_per_m,imbalance_J_per_m\n";
  for (const auto& e : energies)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", field(e.time_s), field(e.strain),
                        field(e.kinetic), field(e.top_work), field(e.trigger_work), field(e.prestress_work),
                        field(e.friction_work), field(e.contact_work), field(e.damping_work),
                        field(e.boundary_work), field(e.coupling_work),
                        field(solve::imbalance_J_per_m(e, energies.front())));
  write_text(file, text);
}

void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts) {
  std::string text =
      "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
      "U_s_J_per_m3,U_r_J_per_m3\n";
  for (const fronts::Front& front : fronts)
    for (const fronts::FrontPoint& point : front.points)
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", front.id, field(point.x_m),
                      field(point.onset_s), front.direction, field(point.v_tip_m_per_s), field(point.t_s_Pa),
                      field(point.p_s_Pa), field(point.t_d_Pa), field(point.p_d_Pa), field(point.t_r_Pa),
                      field(point.p_r_Pa), field(point.U_s_J_per_m3), field(point.U_r_J_per_m3));
  write_text(file, text);
}

void write_snapshots(const std::filesystem::path& path, const mesh::Mesh& mesh,
                     std::span<const Snapshot> snapshots) {
  constexpr std::uint8_t vtk_quad = 9;
  const auto n_points = static_cast<std::int64_t>(mesh.x_m.size());
  const auto n_cells = static_cast<std::int64_t>(mesh.cells.size());
  std::vector<std::int64_t> connectivity, offsets = {0};
  // The last column of a periodic plate is drawn with nodes of its own.
  std::vector<std::pair<mesh::Node, mesh::Node>> seam;  // nodes of the left edge and of the right one
  for (const auto& grid : mesh::blocks(mesh))
    for (int j = 0; mesh.period_m > 0 && j <= grid.rows; ++j)
      seam.emplace_back(grid.node(0, j), grid.node(grid.columns, j));
  const auto right_of = [&](mesh::Node n) {
    return std::ranges::lower_bound(seam, n, {}, &std::pair<mesh::Node, mesh::Node>::first)->second;
  };
  for (mesh::Cell cell : mesh.cells) {
    double right_most_m = 0;
    for (const mesh::Node n : cell) right_most_m = std::max(right_most_m, mesh.x_m[n]);
    for (mesh::Node& n : cell)
      if (mesh.period_m > 0 && right_most_m - mesh.x_m[n] > 0.5 * mesh.period_m) n = right_of(n);
    connectivity.insert(connectivity.end(), cell.begin(), cell.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  const auto n_connectivity = static_cast<std::int64_t>(connectivity.size());
  const std::vector<std::uint8_t> types(mesh.cells.size(), vtk_quad);
  const auto one = [](const std::int64_t& value) { return std::span<const std::int64_t>(&value, 1); };

  hdf5::File file = hdf5::create_file(path);
  hdf5::create_group(file, "/VTKHDF");
  hdf5::set_attribute(file, "/VTKHDF", "Version", std::array<std::int64_t, 2>{2, 0});
  hdf5::set_ascii_attribute(file, "/VTKHDF", "Type", "UnstructuredGrid");
  hdf5::write(file, "/VTKHDF/NumberOfPoints", one(n_points), {1});
  hdf5::write(file, "/VTKHDF/NumberOfCells", one(n_cells), {1});
  hdf5::write(file, "/VTKHDF/NumberOfConnectivityIds", one(n_connectivity), {1});
  hdf5::write(file, "/VTKHDF/Points", triples(mesh.x_m, mesh.y_m), {mesh.x_m.size(), 3});
  hdf5::write(file, "/VTKHDF/Connectivity", connectivity, {connectivity.size()});
  hdf5::write(file, "/VTKHDF/Offsets", offsets, {offsets.size()});
  hdf5::write(file, "/VTKHDF/Types", types, {types.size()});
  hdf5::create_group(file, "/VTKHDF/PointData");

  if (snapshots.empty()) return hdf5::close(std::move(file));  // readers take no grid of zero steps

  // All steps share the one mesh: its offsets stay at zero, only the point data move on.
  const std::size_t n_steps = snapshots.size();
  std::vector<double> times_s;
  std::vector<std::int64_t> data_offsets;
  for (const Snapshot& snapshot : snapshots) {
    data_offsets.push_back(static_cast<std::int64_t>(times_s.size()) * n_points);
    times_s.push_back(snapshot.time_s);
  }
  const std::vector<std::int64_t> zeros(n_steps, 0), ones(n_steps, 1);
  hdf5::create_group(file, "/VTKHDF/Steps");
  hdf5::set_attribute(file, "/VTKHDF/Steps", "NSteps", one(static_cast<std::int64_t>(n_steps)));
  hdf5::write(file, "/VTKHDF/Steps/Values", times_s, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/PartOffsets", zeros, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/NumberOfParts", ones, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/PointOffsets", zeros, {n_steps});
  hdf5::write(file, "/VTKHDF/Steps/CellOffsets", zeros, {n_steps, 1});
  hdf5::write(file, "/VTKHDF/Steps/ConnectivityIdOffsets", zeros, {n_steps, 1});
  hdf5::create_group(file, "/VTKHDF/Steps/PointDataOffsets");

  const auto write_field = [&](const std::string& name, auto components) {
    const std::string dataset = "/VTKHDF/PointData/" + name;
    hdf5::create(file, dataset, {n_steps * mesh.x_m.size(), 3});
    hdf5::write(file, "/VTKHDF/Steps/PointDataOffsets/" + name, data_offsets, {n_steps});
    for (std::size_t k = 0; k < n_steps; ++k) {
      std::vector<double> values = components(snapshots[k]);
      SLIPFRONT_ASSERT(values.size() == 3 * mesh.x_m.size(), "a snapshot does not fit its mesh");
      for (const auto& [left, right] : seam)
        std::copy_n(values.begin() + 3 * left, 3, values.begin() + 3 * right);
      hdf5::write_rows(file, dataset, k * mesh.x_m.size(), values);
    }
  };
  write_field("displacement_m", [](const Snapshot& s) { return triples(s.u_x_m, s.u_y_m); });
  write_field("velocity_m_per_s", [](const Snapshot& s) { return triples(s.v_x_m_per_s, s.v_y_m_per_s); });
  hdf5::close(std::move(file));
}

}  // namespace slipfront::io
