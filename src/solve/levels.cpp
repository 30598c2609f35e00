// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "solve/level.hpp"

namespace slipfront::solve {

namespace {

/// For each cell, whether it is among the `rows` rows of cells next to the interface, counted in cells.
std::vector<bool> cells_next_to_interface(const mesh::Mesh& mesh, int rows) {
  std::vector<bool> near(mesh.cells.size(), false), reached(mesh.n_nodes(), false);
  for (const auto n : mesh.lower) reached[n] = true;
  for (int row = 0; row < rows; ++row) {
    const auto reached_before = reached;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      if (near[c] || std::ranges::none_of(mesh.cells[c], [&](mesh::Node n) { return reached_before[n]; }))
        continue;
      near[c] = true;
      for (const auto n : mesh.cells[c]) reached[n] = true;
    }
  }
  return near;
}

/// Nodes of short rows that make a band worth its while.
constexpr int nodes_per_band = 1500;

std::optional<std::size_t> place(const std::vector<mesh::Node>& nodes, mesh::Node n) {
  const auto found = std::ranges::find(nodes, n);
  if (found == nodes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - nodes.begin());
}

/// The last row of the first band: with the nodes marked, and with those whose neighbours are not all in the
/// rows beside their own.
int last_row_of_first_band(const Level& level, const mesh::Grid& grid, const std::vector<bool>& marked) {
  const int stride = grid.stride();
  int last = 0;
  for (std::size_t n = 0; n < marked.size(); ++n)
    if (marked[n]) last = std::max(last, static_cast<int>(n) / stride);
  const auto& irregular = level.part.irregular;
  for (std::size_t r = 0; r < irregular.size(); ++r)
    for (auto k = irregular.first[r]; k < irregular.first[r + 1]; ++k) {
      const int row = irregular.node[r] / stride, other = irregular.neighbour[k] / stride;
      if (std::abs(row - other) > 1) last = std::max({last, row, other});
    }
  return last;
}

/// Divides a level's lists, all of them in the order of rows, into bands that end after the rows given.
void set_bands(Level& level, const mesh::Grid& grid, std::vector<int> last_rows) {
  std::size_t stencil = 0, edges = 0, irregular = 0, dashpots = 0;
  int first_row = 0;
  for (const int last_row : last_rows) {
    Band band;
    band.first_row = first_row;
    band.last_row = last_row;
    const auto take = [&](std::size_t& next, std::size_t n, auto&& row_of) {
      const auto begin = next;
      while (next < n && row_of(next) <= last_row) ++next;
      return solid::Span{static_cast<int>(begin), static_cast<int>(next)};
    };
    band.stencil =
        take(stencil, level.part.stencil.size(), [&](std::size_t k) { return level.part.stencil[k].row; });
    band.edges.begin = static_cast<int>(edges);
    for (int k = band.stencil.begin; k < band.stencil.end; ++k)
      if (solid::is_horizontal_edge(level.part.stencil[k])) ++edges;
    band.edges.end = static_cast<int>(edges);
    const auto& node = level.part.irregular.node;
    const auto row_of_irregular = [&](std::size_t r) { return node[r] / grid.stride(); };
    band.irregular = take(irregular, node.size(), row_of_irregular);
    band.dashpots = take(dashpots, level.dashpots.size(),
                         [&](std::size_t k) { return row_of_irregular(level.dashpots[k].at); });
    band.has_top = last_row == grid.rows;
    level.bands.push_back(band);
    first_row = last_row + 1;
  }
}

/// Gives each absorbing node a dashpot where it moves: with the interface, with a coarser level's shared
/// nodes, or with its level.
void set_dashpots(Levels& levels, const mesh::Mesh& mesh, const solid::Material& material,
                  const Plate& plate) {
  const double c_L = solid::longitudinal_speed_m_per_s(material), c_S = solid::shear_speed_m_per_s(material);
  for (const auto& [n, side_m, top_m] : mesh.absorbing) {
    const std::size_t l = levels.level_of_node[n];
    auto& level = levels.level[l];
    const double factor = 0.5 * level.step_s * material.density_kg_per_m3 / plate.op.mass_kg[n];
    Dashpot dashpot{0, n, factor * (c_L * side_m + c_S * top_m), factor * (c_S * side_m + c_L * top_m)};
    if (const auto i = place(mesh.lower, n)) {
      dashpot.at = *i;
      levels.contact_dashpots.push_back(dashpot);
    } else if (const auto k = l > 0 ? place(levels.level[l - 1].shared.node, n) : std::nullopt) {
      dashpot.at = *k;
      levels.level[l - 1].shared.dashpots.push_back(dashpot);
    } else {
      const auto row = place(level.part.irregular.node, n);
      SLIPFRONT_ASSERT(row, "an absorbing node without a block row");
      dashpot.at = *row;
      level.takes_push[*row] = false;
      level.dashpots.push_back(dashpot);
    }
  }
  for (auto& level : levels.level) std::ranges::sort(level.dashpots, {}, &Dashpot::at);
}

}  // namespace

std::vector<NodeRun> runs_of(std::span<const mesh::Node> nodes) {
  std::vector<NodeRun> runs;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (k > 0 && nodes[k] == nodes[k - 1] + 1) {
      ++runs.back().count;
    } else {
      runs.push_back({k, nodes[k], 1});
    }
  }
  return runs;
}

void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time) {
  if (time.interface_rows >= mesh.grid.rows)
    throw UserError(
        "time.interface_rows = {} does not fit below the loaded edge of a mesh of {} rows; choose fewer",
        time.interface_rows, mesh.grid.rows);
}

Levels make_levels(const mesh::Mesh& mesh, const solid::Material& material, const Plate& plate,
                   const TimeStepping& time, double step_s) {
  require_rows_fit(mesh, time);
  const int substeps = time.interface_substeps;
  const auto& op = plate.op;
  Levels levels;
  levels.level.resize(substeps > 1 ? 2 : 1);
  const std::size_t n_levels = levels.level.size();
  std::vector<std::uint8_t> level_of_cell(mesh.cells.size(), 0);
  if (n_levels > 1) {
    const auto near = cells_next_to_interface(mesh, time.interface_rows);
    for (std::size_t c = 0; c < near.size(); ++c) level_of_cell[c] = near[c] ? 1 : 0;
  }
  // A node moves with the finest of its cells.
  auto& level_of_node = levels.level_of_node;
  level_of_node.assign(mesh.n_nodes(), 0);
  levels.is_orphan = mesh::orphans(mesh);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) level_of_node[n] = std::max(level_of_node[n], level_of_cell[c]);
  std::vector<bool> in_contact(mesh.n_nodes(), false), is_shared(mesh.n_nodes(), false);
  for (const auto n : mesh.lower) in_contact[n] = true;

  for (std::size_t l = 0; l < n_levels; ++l) {
    auto& level = levels.level[l];
    level.period = l + 1 == n_levels ? 1 : substeps;
    level.step_s = step_s * level.period / substeps;
    level.damping_work = {level.step_s, plate.damping_s,
                          material.density_kg_per_m3 * mesh.grid.spacing_m * mesh.grid.spacing_m};
    std::vector<bool> in_level(mesh.cells.size());
    for (std::size_t c = 0; c < in_level.size(); ++c) in_level[c] = level_of_cell[c] == l;
    const int edge_row = n_levels > 1 ? time.interface_rows : 0;
    level.part = n_levels > 1 ? solid::make_part(mesh, material, op, in_level, edge_row) : op.whole;
    const auto& irregular = level.part.irregular;
    std::vector<bool> shared(mesh.n_nodes(), false), in_cells(mesh.n_nodes(), false);
    for (std::size_t c = 0; c < in_level.size(); ++c) {
      if (!in_level[c]) continue;
      for (const auto n : mesh.cells[c]) {
        in_cells[n] = true;
        if (level_of_node[n] > l && !op.is_top[n]) shared[n] = true;
      }
    }
    std::vector<mesh::Node> top;
    for (const auto n : mesh.top) {
      if (level_of_node[n] == l) level.top.push_back(n);
      if (in_cells[n]) top.push_back(n);
    }
    auto& s = level.shared;
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      if (!shared[n]) continue;
      const auto row = std::ranges::lower_bound(irregular.node, n);
      s.node.push_back(n);
      s.irregular_row.push_back(row != irregular.node.end() && *row == n
                                    ? static_cast<std::int32_t>(row - irregular.node.begin())
                                    : -1);
      is_shared[n] = true;
    }
    s.runs = runs_of(s.node);
    s.u_before_m = s.push_m_per_s = s.steady_m_per_s2 = solid::Field(s.node.size());
    for (const auto& row : level.part.stencil)
      if (solid::is_horizontal_edge(row))
        level.edge_kick_m_per_s.emplace_back(2 * static_cast<std::size_t>(mesh.grid.stride()));
    for (const auto n : irregular.node) {
      level.takes_push.push_back(!shared[n]);
      level.moves.push_back(!in_contact[n] && !is_shared[n]);
    }
    level.top_rows = solid::assemble_rows(mesh, material, top, {}, in_level);
    level.top_force_N.resize(top.size());
    level.a_x.resize(irregular.size());
    level.a_y.resize(irregular.size());
  }
  set_dashpots(levels, mesh, material, plate);

  for (std::size_t l = 0; l < n_levels; ++l) {
    auto& level = levels.level[l];
    if (l > 0) {
      set_bands(level, mesh.grid, {mesh.grid.rows});
      continue;
    }
    // The work of landing nodes needs the places of their neighbours after the step.
    std::vector<bool> marked(mesh.n_nodes(), false);
    for (const auto& cell : mesh.cells)
      if (std::ranges::any_of(cell, [&](mesh::Node n) { return in_contact[n]; }))
        for (const auto n : cell) marked[n] = true;
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
      if (level_of_node[n] > 0) marked[n] = true;
    std::vector<bool> single(mesh.grid.rows + 1, false);
    single[mesh.grid.rows] = true;
    for (const auto n : level.part.irregular.node) single[n / mesh.grid.stride()] = true;
    const int most_rows = std::max(1, nodes_per_band / mesh.grid.stride());
    int row = last_row_of_first_band(level, mesh.grid, marked);
    std::vector<int> last_rows{row};
    while (row < mesh.grid.rows) {
      const int first = ++row;
      while (row - first + 1 < most_rows && !single[row] && !single[row + 1]) ++row;
      last_rows.push_back(row);
    }
    set_bands(level, mesh.grid, last_rows);
  }
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (!levels.is_orphan[n] && !op.is_top[n])
      levels.node_updates_per_step += substeps / levels.level[level_of_node[n]].period;
  return levels;
}

}  // namespace slipfront::solve
