// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "boundary/boundary.hpp"
#include "boundary/dashpot.hpp"
#include "motion/level.hpp"
#include "solid/element.hpp"

namespace slipfront::motion {

namespace {

/// For each cell, whether it is among the `rows` rows of cells next to the interface, counted in cells.
std::vector<bool> cells_next_to_interface(const mesh::Mesh& mesh, int rows) {
  std::vector<bool> near(mesh.cells.size(), false), reached(mesh.n_nodes(), false);
  for (const auto n : mesh.interface_nodes) reached[n] = true;
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

/// Least damping beta_R with which blocks take steps of their own, in steps of the lowest one. Undamped, the
/// coupling feeds resonant modes, which grow by some thousandths in a step; 0.02 was enough wherever it was
/// tried (docs/mesh.md).
constexpr double min_damping_in_steps = 0.05;

/// The block to which each cell belongs; the transition between two blocks belongs to the lower one. All
/// cells of a mesh that knows no grid are in one block.
std::vector<int> block_of_cells(const mesh::Mesh& mesh) {
  const auto grids = mesh::blocks(mesh);
  std::vector<int> block;
  for (const auto& cell : mesh.cells) {
    const auto lowest = *std::ranges::min_element(cell);
    const auto above = std::ranges::upper_bound(grids, lowest, {}, &mesh::Grid::first);
    block.push_back(static_cast<int>(above - grids.begin()) - 1);
  }
  return block;
}

/// Nodes of short rows that make a band worth its while.
constexpr int nodes_per_band = 1500;

std::optional<std::size_t> place(const std::vector<mesh::Node>& nodes, mesh::Node n) {
  const auto found = std::ranges::find(nodes, n);
  if (found == nodes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - nodes.begin());
}

/// The last row of the first band: with the nodes marked and with general rows, whose neighbours may be
/// farther away than the next row.
int last_row_of_first_band(const StepLevel& level, const solid::Operator& op,
                           const std::vector<bool>& marked) {
  int last = 0;
  for (std::size_t n = 0; n < marked.size(); ++n)
    if (marked[n]) last = std::max(last, op.row_of(static_cast<mesh::Node>(n)));
  for (const auto n : level.stiffness.general.node()) last = std::max(last, op.row_of(n));
  return last;
}

/// Neighbouring nodes among irregular ones that are treated alike.
std::vector<NodeRun> irregular_runs(const StepLevel& level, solid::Span irregular, const BodyMotion& body) {
  std::vector<NodeRun> runs;
  for (int r = irregular.begin; r < irregular.end; ++r) {
    const bool is_owned = body.is_owned(level.irregular[r]);
    const bool goes_on = r > irregular.begin && level.irregular[r] == level.irregular[r - 1] + 1 &&
                         is_owned == runs.back().is_owned &&
                         level.takes_impulse[r] == level.takes_impulse[r - 1] &&
                         level.moves[r] == level.moves[r - 1];
    if (goes_on) {
      ++runs.back().count;
    } else {
      runs.push_back({static_cast<std::size_t>(r), level.irregular[r], 1, is_owned});
    }
  }
  return runs;
}

/// Divides a level's lists, all of them in the order of rows, into bands that end after the rows given.
void set_bands(StepLevel& level, const BodyMotion& body, const std::vector<int>& last_rows) {
  const auto& op = body.op;
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
    band.stencil = take(stencil, level.stiffness.stencil.size(),
                        [&](std::size_t k) { return level.stiffness.stencil[k].row; });
    band.edges.begin = static_cast<int>(edges);
    for (int k = band.stencil.begin; k < band.stencil.end; ++k)
      if (solid::is_horizontal_edge(level.stiffness.stencil[k])) ++edges;
    band.edges.end = static_cast<int>(edges);
    const auto row_of_irregular = [&](std::size_t r) {
      return r < level.stiffness.general.size() ? 0 : op.row_of(level.irregular[r]);
    };
    band.irregular = take(irregular, level.irregular.size(), row_of_irregular);
    band.runs = irregular_runs(level, band.irregular, body);
    band.dashpots = take(dashpots, level.dashpots.size(),
                         [&](std::size_t k) { return row_of_irregular(level.dashpots[k].at); });
    band.has_top = last_row + 1 == op.n_rows();
    level.bands.push_back(band);
    first_row = last_row + 1;
  }
}

/// Gives each edge node a dashpot where it moves: with the interface, with a coarser level's shared nodes, or
/// with its level.
void set_dashpots(StepLevels& levels, const mesh::Mesh& mesh, const solid::Material& material,
                  const BodyMotion& body) {
  for (const auto& edge : body.boundary.nodes) {
    const auto n = edge.node;
    const std::size_t l = levels.level_of_node[n];
    auto& level = levels.level[l];
    auto dashpot = boundary::make_dashpot(edge, material, body.op.mass_kg[n], level.step_s);
    dashpot.spring = body.springs.place(n);
    if (const auto i = place(mesh.interface_nodes, n)) {
      SLIPFRONT_ASSERT(!edge.spring_x_N_per_m && !edge.spring_y_N_per_m, "a machine springs the interface");
      dashpot.at = *i;
      levels.contact_dashpots.push_back(dashpot);
    } else if (const auto k = l > 0 ? place(levels.level[l - 1].shared.node, n) : std::nullopt) {
      dashpot.at = *k;
      levels.level[l - 1].shared.dashpots.push_back(dashpot);
    } else {
      const auto row = place(level.irregular, n);
      SLIPFRONT_ASSERT(row, "an edge node with a shared stencil");
      dashpot.at = *row;
      level.takes_impulse[*row] = false;
      level.dashpots.push_back(dashpot);
    }
  }
  for (auto& level : levels.level) std::ranges::sort(level.dashpots, {}, &boundary::Dashpot::at);
}

}  // namespace

std::vector<NodeRun> runs_of(std::span<const mesh::Node> nodes, const BodyMotion& body) {
  std::vector<NodeRun> runs;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool is_owned = body.is_owned(nodes[k]);
    if (k > 0 && nodes[k] == nodes[k - 1] + 1 && is_owned == runs.back().is_owned) {
      ++runs.back().count;
    } else {
      runs.push_back({k, nodes[k], 1, is_owned});
    }
  }
  return runs;
}

void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time, std::string_view table) {
  if (mesh.grid.columns == 0 || time.interface_rows < mesh.grid.rows) return;
  const bool is_graded = !mesh.coarser.empty();
  throw UserError("{} = {} needs {} rows of {}elements at the interface, the {} has {}; choose {}a larger {}",
                  Key("time.interface_rows"), time.interface_rows, time.interface_rows + 1,
                  is_graded ? "the smallest " : "", table, mesh.grid.rows,
                  time.interface_rows > 1 ? "fewer, or " : "",
                  Key(fmt::format("{}.{}", table, is_graded ? "fine_height_m" : "height_m")))
      .about("plate.element_size_m");
}

std::vector<int> block_ratios(const mesh::Mesh& mesh, const solid::Material& material,
                              const boundary::Boundary& boundary, const TimeStepping& time,
                              double stable_step_s) {
  const double damping_s = material.stiffness_damping_s;
  std::vector<int> ratios(1 + mesh.coarser.size(), 1);
  const bool damped = damping_s >= min_damping_in_steps * time.step_factor * stable_step_s;
  if (!time.local_steps || mesh.coarser.empty() || !damped) return ratios;
  // The largest frequency of its free cells bounds a block's from above. Squares do so the more closely the
  // more of them there are: what the lowest block's squares show is no more than what larger ones would.
  const double h = mesh.grid.spacing_m;
  const double of_square = solid::cell_frequency_rad_per_s({0, 0, h, 0, h, h, 0, h}, material);
  const double overestimate = std::max(1.0, stable_step_s / solid::stable_step_s(of_square, damping_s));
  const auto block_of_cell = block_of_cells(mesh);
  for (std::size_t b = 1; b < ratios.size(); ++b) {
    std::vector<bool> in_block;
    for (const int of_cell : block_of_cell) in_block.push_back(of_cell == static_cast<int>(b));
    std::vector<bool> of_block(mesh.n_nodes(), false);
    for (std::size_t c = 0; c < in_block.size(); ++c)
      if (in_block[c])
        for (const auto n : mesh.cells[c]) of_block[n] = true;
    const double omega =
        std::hypot(solid::largest_cell_frequency_rad_per_s(mesh, material, in_block),
                   boundary::largest_spring_frequency_rad_per_s(mesh, material, boundary, of_block));
    const double allowed = overestimate * solid::stable_step_s(omega, damping_s) / stable_step_s;
    for (ratios[b] = 1 << b; ratios[b] > allowed * (1 + 1e-9) && ratios[b] > 1;) ratios[b] /= 2;
  }
  for (std::size_t b = ratios.size() - 1; b > 0; --b) ratios[b - 1] = std::min(ratios[b - 1], ratios[b]);
  return ratios;
}

namespace {

/// Whether rows next to the interface have a separate level.
bool is_layered(std::span<const int> block_periods) {
  return block_periods.front() > 1;
}

/// Periods of the levels, the coarsest first: those of the blocks and, with sub-steps, that of the interface
/// rows.
std::vector<int> periods_of_levels(std::span<const int> block_periods) {
  std::vector<int> periods;
  if (is_layered(block_periods)) periods.push_back(1);
  std::ranges::unique_copy(block_periods, std::back_inserter(periods));
  std::ranges::reverse(periods);
  return periods;
}

std::vector<std::uint8_t> levels_of_cells(const mesh::Mesh& mesh, const TimeStepping& time,
                                          std::span<const int> block_periods,
                                          const std::vector<int>& periods) {
  const auto block_of_cell = block_of_cells(mesh);
  std::vector<std::uint8_t> level(mesh.cells.size(), 0);
  for (std::size_t c = 0; c < level.size(); ++c)
    level[c] = static_cast<std::uint8_t>(std::ranges::find(periods, block_periods[block_of_cell[c]]) -
                                         periods.begin());
  if (!is_layered(block_periods)) return level;
  const auto near = cells_next_to_interface(mesh, time.interface_rows);
  for (std::size_t c = 0; c < near.size(); ++c)
    if (near[c]) level[c] = static_cast<std::uint8_t>(periods.size() - 1);
  return level;
}

/// A node moves with the finest of its cells.
std::vector<std::uint8_t> levels_of_nodes(const mesh::Mesh& mesh,
                                          const std::vector<std::uint8_t>& level_of_cell) {
  std::vector<std::uint8_t> level(mesh.n_nodes(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) level[n] = std::max(level[n], level_of_cell[c]);
  return level;
}

/// Nodes of some cells.
std::vector<bool> nodes_of(const mesh::Mesh& mesh, const std::vector<bool>& in_level) {
  std::vector<bool> is_in(mesh.n_nodes(), false);
  for (std::size_t c = 0; c < in_level.size(); ++c)
    if (in_level[c])
      for (const auto n : mesh.cells[c]) is_in[n] = true;
  return is_in;
}

/// Divides the spans of stencil rows where nodes begin and cease to count.
void split_spans(std::vector<solid::StencilRow>& rows, const std::vector<solid::Span>& own_of_row) {
  if (own_of_row.empty()) return;
  for (auto& row : rows) {
    const auto own = own_of_row[row.row];
    std::vector<solid::Span> spans;
    for (auto span : row.spans) {
      for (const int at : {own.begin, own.end}) {
        if (at <= span.begin || at >= span.end) continue;
        spans.push_back({span.begin, at});
        span.begin = at;
      }
      spans.push_back(span);
    }
    row.spans = std::move(spans);
  }
}

void set_irregular_nodes(StepLevel& level) {
  auto& irregular = level.irregular;
  irregular = level.stiffness.general.node();
  irregular.insert(irregular.end(), level.stiffness.own.begin(), level.stiffness.own.end());
  level.general_space = level.stiffness.general.workspace();
  level.a_x.resize(irregular.size());
  level.a_y.resize(irregular.size());
}

/// Nodes of the level's cells that move with a finer one.
void set_shared_nodes(StepLevel& level, const std::vector<bool>& shared, const BodyMotion& body) {
  std::vector<std::int32_t> irregular_row(shared.size(), -1);
  for (std::size_t r = 0; r < level.irregular.size(); ++r)
    irregular_row[level.irregular[r]] = static_cast<std::int32_t>(r);
  auto& s = level.shared;
  for (std::size_t n = 0; n < shared.size(); ++n) {
    if (!shared[n]) continue;
    s.node.push_back(static_cast<mesh::Node>(n));
    s.irregular_row.push_back(irregular_row[n]);
  }
  s.runs = runs_of(s.node, body);
  for (const auto& [field, is_in_halos] : shared_fields) s.*field = solid::Field(s.node.size());
}

/// Nodes of the loaded edge that move with the level, and the rows of all in its cells.
void set_loaded_edge(StepLevel& level, std::size_t l, const mesh::Mesh& mesh, const solid::Material& material,
                     const std::vector<mesh::Node>& driven, const std::vector<std::uint8_t>& level_of_node,
                     const std::vector<bool>& in_level, const std::vector<bool>& in_cells) {
  std::vector<mesh::Node> top;
  for (const auto n : driven) {
    if (level_of_node[n] == l) level.top.push_back(n);
    if (in_cells[n]) top.push_back(n);
  }
  level.top_rows = solid::assemble_rows(mesh, material, top, {}, in_level);
  level.top_force_N = solid::Field(top.size());
}

/// Sets the coarsest level's bands: the first one with all that the interface's part of a step needs, rows
/// with irregular nodes alone. For all parts of a body they come from the same rows.
void set_coarsest_bands(const mesh::Mesh& mesh, const BodyMotion& body, StepLevels& levels,
                        const MaxOverSubdomains& largest) {
  const auto& op = body.op;
  auto& level = levels.level.front();
  // The work of landing nodes needs the places of their neighbours after the step.
  const auto in_contact = mesh::marked(mesh, mesh.interface_nodes);
  std::vector<bool> needed(mesh.n_nodes(), false);
  for (const auto& cell : mesh.cells)
    if (std::ranges::any_of(cell, [&](mesh::Node n) { return in_contact[n]; }))
      for (const auto n : cell) needed[n] = true;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (levels.level_of_node[n] > 0) needed[n] = true;
  const int top_row = op.n_rows() - 1;
  std::vector<double> single(op.rows.size(), 0);
  single[top_row] = 1;
  for (const auto n : level.stiffness.own)
    if (body.is_owned(n)) single[op.row_of(n)] = 1;
  const int max_rows = std::max(1, nodes_per_band / op.rows[top_row].count);
  double last_of_first = last_row_of_first_band(level, op, needed);
  if (largest) {
    largest(single);
    largest(std::span(&last_of_first, 1));
  }
  int row = static_cast<int>(last_of_first);
  std::vector<int> last_rows{row};
  while (row < top_row) {
    const int first = ++row;
    while (row - first + 1 < max_rows && single[row] == 0 && single[row + 1] == 0) ++row;
    last_rows.push_back(row);
  }
  set_bands(level, body, last_rows);
  for (auto& band : level.bands) band.is_irregular = single[band.first_row] != 0;
}

}  // namespace

CellLevels cell_levels(const mesh::Mesh& mesh, const TimeStepping& time, std::span<const int> block_periods) {
  CellLevels levels{periods_of_levels(block_periods), {}, {}};
  levels.of_cell = levels_of_cells(mesh, time, block_periods, levels.periods);
  levels.of_node = levels_of_nodes(mesh, levels.of_cell);
  return levels;
}

std::vector<LevelReach> reach_of_levels(const mesh::Mesh& mesh, std::span<const int> block_periods) {
  std::vector<LevelReach> levels;
  for (const int period : periods_of_levels(block_periods)) levels.push_back({period, 1});
  for (int block = 0; block < std::ssize(block_periods); ++block) {
    auto& level = *std::ranges::find(levels, block_periods[block], &LevelReach::period);
    level.columns = std::max(level.columns, mesh::columns_of_cells(mesh, block));
  }
  return levels;
}

int columns_of_rounded_layer(const mesh::Mesh& mesh, const TimeStepping& time,
                             std::span<const int> block_periods) {
  const auto& grid = mesh.grid;
  const auto is_in_lowest_row = [&](mesh::Node n) { return n < grid.stride(); };
  if (!is_layered(block_periods) || std::ranges::all_of(mesh.interface_nodes, is_in_lowest_row)) return 0;
  const auto near = cells_next_to_interface(mesh, time.interface_rows);
  int columns = 0;
  for (std::size_t c = 0; c < near.size(); ++c) {
    if (!near[c] || std::ranges::min(mesh.cells[c]) / grid.stride() < time.interface_rows) continue;
    for (const auto n : mesh.cells[c]) {
      const int column = n % grid.stride();
      columns = std::max(columns, std::min(column, grid.columns - column));
    }
  }
  return columns;
}

StepLevels make_levels(const mesh::Mesh& mesh, const solid::Material& material, const BodyMotion& body,
                       const TimeStepping& time, const StepPlan::OfBody& steps,
                       const MaxOverSubdomains& largest) {
  require_rows_fit(mesh, time);
  const auto& op = body.op;
  const auto [periods, level_of_cell, level_of_node] = cell_levels(mesh, time, steps.block_periods);
  StepLevels levels;
  levels.level.resize(periods.size());
  levels.level_of_node = level_of_node;
  levels.is_orphan = mesh::orphans(mesh);
  const auto in_contact = mesh::marked(mesh, mesh.interface_nodes);
  std::vector<bool> is_shared(mesh.n_nodes(), false);  // by a coarser level or this one
  for (std::size_t l = 0; l < periods.size(); ++l) {
    auto& level = levels.level[l];
    level.period = periods[l];
    level.step_s = steps.level_step_s(level.period);
    level.damping_work = {level.step_s, body.damping_s,
                          material.density_kg_per_m3 * mesh.grid.spacing_m * mesh.grid.spacing_m};
    std::vector<bool> in_level(mesh.cells.size());
    for (std::size_t c = 0; c < in_level.size(); ++c) in_level[c] = level_of_cell[c] == l;
    const int edge_row = is_layered(steps.block_periods) ? time.interface_rows : 0;
    level.stiffness =
        periods.size() > 1 ? solid::make_partial_stiffness(mesh, material, op, in_level, edge_row) : op.whole;
    split_spans(level.stiffness.stencil, body.own);
    set_irregular_nodes(level);
    const auto in_cells = nodes_of(mesh, in_level);
    std::vector<bool> shared(mesh.n_nodes(), false);
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      shared[n] = in_cells[n] && levels.level_of_node[n] > l && !op.is_far_edge[n];
      is_shared[n] = is_shared[n] || shared[n];
    }
    set_shared_nodes(level, shared, body);
    for (const auto& row : level.stiffness.stencil)
      for (int i = 0; solid::is_horizontal_edge(row) && i < mesh.grid.stride(); ++i)
        level.edge_nodes.push_back(static_cast<mesh::Node>(op.rows[row.row].first) + i);
    level.edge_kick_m_per_s = solid::Field(level.edge_nodes.size());
    for (const auto n : level.irregular) {
      level.takes_impulse.push_back(!shared[n]);
      level.moves.push_back(!in_contact[n] && !is_shared[n]);
    }
    set_loaded_edge(level, l, mesh, material, body.boundary.driven, levels.level_of_node, in_level, in_cells);
  }
  set_dashpots(levels, mesh, material, body);
  set_coarsest_bands(mesh, body, levels, largest);
  for (auto& level : std::span(levels.level).subspan(1)) set_bands(level, body, {op.n_rows() - 1});
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (!levels.is_orphan[n] && !op.is_far_edge[n] && body.is_owned(n)) {
      const int updates = steps.period() / levels.level[levels.level_of_node[n]].period;
      levels.node_updates_per_step += updates;
    }
  return levels;
}

}  // namespace slipfront::motion
