// SPDX-License-Identifier: BSD-3-Clause
#include "solid/operator.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.hpp"
#include "base/random.hpp"
#include "solid/cells_of_nodes.hpp"
#include "solid/element.hpp"
#include "solid/kernels.hpp"

namespace slipfront::solid {

namespace {

/// The grids of the mesh's blocks, none where it knows no grid.
std::vector<mesh::Grid> grids_of(const mesh::Mesh& mesh) {
  return mesh.grid.columns > 0 ? mesh::blocks(mesh) : std::vector<mesh::Grid>{};
}

std::vector<NodeRow> rows_of(const mesh::Mesh& mesh, std::span<const mesh::Grid> grids) {
  if (grids.empty()) return {{0, mesh.n_nodes()}};
  std::vector<NodeRow> rows;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const auto& grid = grids[k];
    for (int j = 0; j <= grid.rows; ++j) rows.push_back({grid.node(0, j), grid.stride()});
    const auto end = grid.first + static_cast<mesh::Node>(grid.n_nodes());
    if (k + 1 < grids.size()) rows.push_back({end, grids[k + 1].first - end});
  }
  return rows;
}

/// A row whose last cell ends at its first node repeats.
void set_periods(const mesh::Mesh& mesh, Operator& op) {
  if (mesh.period_m == 0) return;
  for (const auto& cell : mesh.cells)
    for (const auto& [left, right] : {std::pair{cell[0], cell[1]}, {cell[3], cell[2]}}) {
      auto& row = op.rows[op.row_of(left)];
      if (right == row.first) row.period = left - right + 1;
    }
}

/// The block of each node, -1 for the inner nodes of transitions.
std::vector<int> block_of_nodes(const mesh::Mesh& mesh, std::span<const mesh::Grid> grids) {
  std::vector<int> block(mesh.n_nodes(), -1);
  for (std::size_t k = 0; k < grids.size(); ++k)
    std::fill_n(block.begin() + grids[k].first, grids[k].n_nodes(), static_cast<int>(k));
  return block;
}

std::array<double, 4> block_of(const CellStiffness& K, int a, int b) {
  return {K[(2 * a) * 8 + 2 * b], K[(2 * a) * 8 + 2 * b + 1], K[(2 * a + 1) * 8 + 2 * b],
          K[(2 * a + 1) * 8 + 2 * b + 1]};
}

void set_stencils(Operator& op, const Material& material) {
  const double h = op.grid.spacing_m;
  const CellStiffness K = cell_stiffness({0, 0, h, 0, h, h, 0, h}, material);
  // Blocks of the node at the lower left corner of a cell against the cell's four nodes; the other corners
  // follow from the symmetries of the square.
  const auto self = block_of(K, 0, 0), side = block_of(K, 0, 1), diagonal = block_of(K, 0, 2),
             up = block_of(K, 0, 3);
  const double interior_mass = material.density_kg_per_m3 * h * h;
  const double edge_mass = 0.5 * interior_mass;
  op.interior = {.centre = 4 * self[0] / interior_mass,
                 .along = 2 * side[0] / interior_mass,
                 .across = 2 * up[0] / interior_mass,
                 .corner = diagonal[0] / interior_mass,
                 .twist = diagonal[1] / interior_mass};
  op.edge = {.centre_x = 2 * self[0] / edge_mass,
             .side_x = side[0] / edge_mass,
             .up_x = 2 * up[0] / edge_mass,
             .corner_x = diagonal[0] / edge_mass,
             .centre_y = 2 * self[3] / edge_mass,
             .side_y = side[3] / edge_mass,
             .up_y = 2 * up[3] / edge_mass,
             .corner_y = diagonal[3] / edge_mass,
             .shear = side[1] / edge_mass,
             .twist = diagonal[1] / edge_mass};
}

}  // namespace

void BlockRow::add(mesh::Node neighbour, double factor, const std::array<double, 4>& block) {
  auto known = std::ranges::find(entries_, neighbour, [](const auto& entry) { return entry.first; });
  if (known == entries_.end()) known = entries_.insert(entries_.end(), {neighbour, {}});
  for (int k = 0; k < 4; ++k) known->second[k] += factor * block[k];
}

void BlockRow::move_to(BlockRows& rows, double scale) {
  std::ranges::sort(entries_, {}, [](const auto& entry) { return entry.first; });
  for (auto& [neighbour, block] : entries_) {
    for (double& value : block) value *= scale;
    rows.neighbour.push_back(neighbour);
    rows.block.push_back(block);
  }
  rows.first.push_back(static_cast<std::int32_t>(rows.neighbour.size()));
  entries_.clear();
}

BlockRows assemble_rows(const mesh::Mesh& mesh, const Material& material, std::span<const mesh::Node> nodes,
                        std::span<const double> mass_kg, const std::vector<bool>& in_part) {
  std::vector<std::int32_t> row_of(mesh.n_nodes(), -1);
  for (std::size_t r = 0; r < nodes.size(); ++r) row_of[nodes[r]] = static_cast<std::int32_t>(r);
  std::vector<BlockRow> rows(nodes.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& cell = mesh.cells[c];
    if (!in_part.empty() && !in_part[c]) continue;
    if (std::ranges::none_of(cell, [&](mesh::Node n) { return row_of[n] >= 0; })) continue;
    const auto K = cell_stiffness(cell_coordinates(mesh, cell), material);
    for (int a = 0; a < 4; ++a) {
      if (row_of[cell[a]] < 0) continue;
      for (int b = 0; b < 4; ++b) rows[row_of[cell[a]]].add(cell[b], 1, block_of(K, a, b));
    }
  }
  BlockRows result;
  result.node.assign(nodes.begin(), nodes.end());
  result.first.push_back(0);
  for (std::size_t r = 0; r < nodes.size(); ++r)
    rows[r].move_to(result, mass_kg.empty() ? 1.0 : 1.0 / mass_kg[nodes[r]]);
  return result;
}

int Operator::row_of(mesh::Node n) const {
  const auto above = std::ranges::upper_bound(rows, n, {}, &NodeRow::first);
  return static_cast<int>(above - rows.begin()) - 1;
}

int Operator::widest_row() const {
  return std::ranges::max(rows, {}, &NodeRow::count).count;
}

EdgeSets edge_sets(const mesh::Mesh& mesh) {
  EdgeSets sets{mesh.far_edge_nodes, {}};
  for (const auto& absorbing : mesh.absorbing_nodes) sets.with_forces.push_back(absorbing.node);
  return sets;
}

Operator make_operator(const mesh::Mesh& mesh, const Material& material, const EdgeSets& edges) {
  Operator op;
  op.grid = mesh.grid;
  op.blocks = grids_of(mesh);
  op.rows = rows_of(mesh, op.blocks);
  set_periods(mesh, op);
  op.mass_kg = lumped_mass(mesh, material);
  op.is_far_edge = mesh::marked(mesh, edges.held);
  op.has_forces = mesh::marked(mesh, mesh.interface_nodes);
  for (const auto n : edges.with_forces) op.has_forces[n] = true;
  if (!op.blocks.empty()) set_stencils(op, material);
  op.whole = make_partial_stiffness(mesh, material, op, std::vector<bool>(mesh.cells.size(), true), 0);
  op.far_edge_rows = assemble_rows(mesh, material, edges.held);
  return op;
}

namespace {

/// Which kind of row each node takes of what the cells marked contribute.
class RowKinds {
 public:
  /// @param edge_row  see make_partial_stiffness
  RowKinds(const mesh::Mesh& mesh, const Operator& op, const std::vector<bool>& in_part, int edge_row)
      : mesh_(mesh),
        op_(op),
        in_part_(in_part),
        edge_row_(edge_row),
        regular_cell_(mesh.cells.size()),
        is_general_(mesh.n_nodes(), false),
        around_(mesh) {
    const auto block_of = block_of_nodes(mesh, op.blocks);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      const auto& cell = mesh.cells[c];
      const int block = block_of[cell[0]];
      if (block >= 0 && is_in_place(cell, op.blocks[block])) {
        regular_cell_[c] = is_square_of_grid(mesh, op.blocks[block], cell);
      } else {
        for (const auto n : cell) is_general_[n] = true;
      }
    }
  }

  bool is_general(mesh::Node n) const { return is_general_[n] && !op_.is_far_edge[n] && touches_part(n); }
  bool is_on_grid(mesh::Node n) const { return !is_general_[n] && !op_.is_far_edge[n] && touches_part(n); }
  bool has_four_cells(mesh::Node n) const { return n_cells(n) == 4; }

  /// The squares of the part around a node with a shared stencil; nothing for a node with its own.
  std::optional<Squares> squares_around(mesh::Node n, std::size_t block, int j) const {
    int above = 0, below = 0, right = 0, left = 0;
    for (const auto c : around_.of(n)) {
      if (!regular_cell_[c]) return std::nullopt;
      if (!in_part_[c]) continue;
      const auto& cell = mesh_.cells[c];
      (cell[0] == n || cell[1] == n ? above : below) += 1;
      (cell[0] == n || cell[3] == n ? right : left) += 1;
    }
    if (above == 2 && below == 2) return Squares::all;
    if (n_cells(n) == 2 && !op_.has_forces[n]) {
      if (right == 2) return Squares::right;
      if (left == 2) return Squares::left;
    }
    if (block != 0 || (j != 0 && j != edge_row_)) return std::nullopt;
    if (above == 2 && below == 0) return Squares::above;
    if (above == 0 && below == 2) return Squares::below;
    return std::nullopt;
  }
  /// Whether a node has cells of the part above it, below it, or both.
  Squares cells_around(mesh::Node n) const {
    const auto is_above = [&](std::int32_t c) { return mesh_.cells[c][0] == n || mesh_.cells[c][1] == n; };
    bool above = false, below = false;
    for (const auto c : around_.of(n))
      if (in_part_[c]) (is_above(c) ? above : below) = true;
    return above && below ? Squares::all : above ? Squares::above : Squares::below;
  }

 private:
  /// Whether a cell's nodes are neighbours on a block's grid, which may repeat along x.
  bool is_in_place(const mesh::Cell& cell, const mesh::Grid& grid) const {
    const auto [n, right, across, up] = cell;
    const bool joins = right == n + 1 || right == n + 1 - op_.rows[op_.row_of(grid.first)].period;
    return joins && up == n + grid.stride() && across == right + grid.stride() &&
           up < grid.first + grid.n_nodes();
  }
  std::size_t n_cells(mesh::Node n) const { return around_.of(n).size(); }
  bool touches_part(mesh::Node n) const {
    return std::ranges::any_of(around_.of(n), [&](std::int32_t c) { return in_part_[c]; });
  }

  const mesh::Mesh& mesh_;
  const Operator& op_;
  const std::vector<bool>& in_part_;
  int edge_row_;
  std::vector<bool> regular_cell_, is_general_;
  CellsOfNodes around_;
};

/// Appends the stencil rows of grid row j of a block, without the own stencils.
void append_row(const Operator& op, const RowKinds& kinds, std::size_t block, int j, PartialStiffness& part) {
  const auto& grid = op.blocks[block];
  std::array<StencilRow, 6> of_row;
  auto& own = of_row.back();
  for (int i = 0; i <= grid.columns; ++i) {
    const mesh::Node n = grid.node(i, j);
    if (!kinds.is_on_grid(n)) continue;
    const auto squares = kinds.squares_around(n, block, j);
    auto& spans = squares ? of_row[static_cast<int>(*squares)].spans : own.spans;
    if (!squares) {
      const auto cells = kinds.cells_around(n);
      own.squares = spans.empty() || own.squares == cells ? cells : Squares::all;
      ++own.n_own;
      part.own.push_back(n);
    }
    if (!spans.empty() && spans.back().end == i) {
      ++spans.back().end;
    } else {
      spans.push_back({i, i + 1});
    }
  }
  for (std::size_t kind = 0; kind < of_row.size(); ++kind) {
    auto& row = of_row[kind];
    if (row.spans.empty()) continue;
    row.row = op.row_of(grid.node(0, j));
    if (row.n_own == 0) row.squares = static_cast<Squares>(kind);
    const bool full_mass = kinds.has_four_cells(grid.node(row.spans.front().begin, j));
    const double ratio = op.grid.spacing_m / grid.spacing_m;
    row.scale = is_horizontal_edge(row) ? (full_mass ? 0.5 : 1) : ratio * ratio;
    part.stencil.push_back(std::move(row));
  }
}

/// Puts rows of M^-1 K, of all nodes with own stencils, into them.
void set_own_stencils(const Operator& op, const BlockRows& rows, std::vector<StencilRow>& stencil) {
  std::size_t r = 0;
  for (auto& row : stencil) {
    if (row.n_own == 0) continue;
    const auto& [first, count, period] = op.rows[row.row];
    const auto read = rows_read(row);
    row.own.assign(static_cast<std::size_t>(12 * (read.end - read.begin)) * row.n_own + lanes, 0.0);
    for (std::size_t at = 0; at < row.n_own; ++at, ++r)
      for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
        const int j = op.row_of(rows.neighbour[k]);
        int right = (rows.neighbour[k] - op.rows[j].first) - (rows.node[r] - first);
        if (std::abs(right) > 1) right += right > 0 ? -period : period;
        const auto around = static_cast<std::size_t>(3 * (j - read.begin) + right + 1);
        for (std::size_t b = 0; b < 4; ++b) row.own[(4 * around + b) * row.n_own + at] = rows.block[k][b];
      }
  }
}

}  // namespace

PartialStiffness make_partial_stiffness(const mesh::Mesh& mesh, const Material& material, const Operator& op,
                                        const std::vector<bool>& in_part, int edge_row) {
  const RowKinds kinds(mesh, op, in_part, edge_row);
  PartialStiffness part;
  std::vector<mesh::Node> general;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (kinds.is_general(n)) general.push_back(n);
  for (std::size_t block = 0; block < op.blocks.size(); ++block)
    for (int j = 0; j <= op.blocks[block].rows; ++j) append_row(op, kinds, block, j, part);
  set_own_stencils(op, assemble_rows(mesh, material, part.own, op.mass_kg, in_part), part.stencil);
  part.general = GeneralRows(mesh, material, std::move(general), op.mass_kg, in_part);
  return part;
}

void add_stencil_row(const Operator& op, const StencilRow& row, ConstRow south, ConstRow middle,
                     ConstRow north, double* a_x, double* a_y) {
  const auto interior = scaled(op.interior, row.scale);
  const auto edge = scaled(op.edge, row.scale);
  std::size_t at = 0;
  for (const Span span : row.spans) {
    if (row.n_own > 0) {
      at = multiply_own(row, at, span, south, middle, north, a_x + span.begin, a_y + span.begin);
    } else if (row.squares == Squares::all) {
      add_interior_row(interior, span, south, middle, north, a_x, a_y);
    } else if (row.squares == Squares::above) {
      add_edge_row(edge, span, middle, north, a_x, a_y);
    } else if (row.squares == Squares::below) {
      add_edge_row(mirrored(edge), span, middle, south, a_x, a_y);
    } else {
      const bool right = row.squares == Squares::right;
      const Pair a =
          side_kick(right ? edge : mirrored(edge), span.begin, right ? 1 : -1, south, middle, north);
      a_x[span.begin] += a.x;
      a_y[span.begin] += a.y;
    }
  }
}

void add_partial_product(const Operator& op, const PartialStiffness& part, const Field& w, Field& a) {
  const auto w_of_row = [&](int j, double* w_x, double* w_y) {
    const auto [first, count, period] = op.rows[j];
    std::copy_n(&w.x[first], count, w_x);
    std::copy_n(&w.y[first], count, w_y);
  };
  for_each_stencil_product(op, part, w_of_row, [&](const StencilRow& row, ConstRow product, ConstRow) {
    const auto first = op.rows[row.row].first;
    for (const auto [begin, end] : row.spans)
      for (int i = begin; i < end; ++i) {
        a.x[first + i] += product.x[i];
        a.y[first + i] += product.y[i];
      }
  });
  if (part.general.size() == 0) return;
  auto space = part.general.workspace();
  Field product(part.general.size());
  part.general.multiply(w, 0, w, space, product.x.data(), product.y.data());
  for (std::size_t r = 0; r < part.general.size(); ++r) {
    a.x[part.general.node()[r]] += product.x[r];
    a.y[part.general.node()[r]] += product.y[r];
  }
}

void apply(const Operator& op, const Field& w, Field& a) {
  std::ranges::fill(a.x, 0.0);
  std::ranges::fill(a.y, 0.0);
  add_partial_product(op, op.whole, w, a);
}

double strain_energy_J_per_m(const Operator& op, const Field& u) {
  Field a(u.size());
  apply(op, u, a);
  double energy = 0;
  for (std::size_t n = 0; n < u.size(); ++n) energy += op.mass_kg[n] * (u.x[n] * a.x[n] + u.y[n] * a.y[n]);
  for_each_row_product(op.far_edge_rows, u, [&](std::size_t r, double x, double y) {
    energy += u.x[op.far_edge_rows.node[r]] * x + u.y[op.far_edge_rows.node[r]] * y;
  });
  return 0.5 * energy;
}

double kinetic_energy_J_per_m(const Operator& op, const Field& v) {
  double energy = 0;
  for (std::size_t n = 0; n < v.size(); ++n) energy += op.mass_kg[n] * (v.x[n] * v.x[n] + v.y[n] * v.y[n]);
  return 0.5 * energy;
}

namespace {

/// Lanczos' recurrence on the symmetric M^-1/2 K M^-1/2, from a fixed pseudo-random vector. Nothing is
/// orthogonalised again: copies of converged Ritz values do not disturb the largest one.
class Lanczos {
 public:
  explicit Lanczos(const Operator& op) : op_(op), n_(op.mass_kg.size()), root_mass_(n_), q_(n_) {
    for (std::size_t k = 0; k < n_; ++k) root_mass_[k] = std::sqrt(op.mass_kg[k]);
    q_before_ = w_ = a_ = Field(n_);
    set_start();
  }

  /// Adds a row to the tridiagonal matrix.
  void add_row() {
    if (!diagonal_.empty()) next_vector();
    multiply();
    const double alpha = subtract_before();
    diagonal_.push_back(alpha);
    beta_ = std::sqrt(subtract_own(alpha));
  }
  /// Whether the rows so far span all that the start contains.
  bool is_exhausted() const { return beta_ <= 1e-12 * std::abs(diagonal_.back()); }

  /// The residual bounds the distance to the nearest eigenvalue.
  struct RitzValue {
    double value = 0, residual = 0;
  };
  RitzValue largest() const {
    const auto size = static_cast<Eigen::Index>(diagonal_.size());
    const Eigen::Map<const Eigen::VectorXd> d(diagonal_.data(), size);
    const Eigen::Map<const Eigen::VectorXd> e(off_diagonal_.data(), size - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> tridiagonal;
    tridiagonal.computeFromTridiagonal(d, e);
    return {tridiagonal.eigenvalues()(size - 1),
            beta_ * std::abs(tridiagonal.eigenvectors()(size - 1, size - 1))};
  }

 private:
  void set_start() {
    Random random(1);
    double norm2 = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      if (op_.is_far_edge[k] || op_.mass_kg[k] == 0) continue;
      q_.x[k] = random();
      q_.y[k] = random();
      norm2 += q_.x[k] * q_.x[k] + q_.y[k] * q_.y[k];
    }
    const double norm = std::sqrt(norm2);
    for (std::size_t k = 0; k < n_; ++k) {
      q_.x[k] /= norm;
      q_.y[k] /= norm;
    }
  }
  void next_vector() {
    off_diagonal_.push_back(beta_);
    for (std::size_t k = 0; k < n_; ++k) {
      q_before_.x[k] = q_.x[k];
      q_before_.y[k] = q_.y[k];
      q_.x[k] = a_.x[k] / beta_;
      q_.y[k] = a_.y[k] / beta_;
    }
  }
  /// a = M^-1 K M^-1/2 q
  void multiply() {
    for (std::size_t k = 0; k < n_; ++k) {
      const double scale = root_mass_[k] > 0 ? 1 / root_mass_[k] : 0;
      w_.x[k] = q_.x[k] * scale;
      w_.y[k] = q_.y[k] * scale;
    }
    apply(op_, w_, a_);
  }
  /// a = M^1/2 a - beta q_before; returns a . q.
  double subtract_before() {
    double alpha = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      a_.x[k] = a_.x[k] * root_mass_[k] - beta_ * q_before_.x[k];
      a_.y[k] = a_.y[k] * root_mass_[k] - beta_ * q_before_.y[k];
      alpha += a_.x[k] * q_.x[k] + a_.y[k] * q_.y[k];
    }
    return alpha;
  }
  /// a -= alpha q; returns a . a.
  double subtract_own(double alpha) {
    double norm2 = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      a_.x[k] -= alpha * q_.x[k];
      a_.y[k] -= alpha * q_.y[k];
      norm2 += a_.x[k] * a_.x[k] + a_.y[k] * a_.y[k];
    }
    return norm2;
  }

  const Operator& op_;
  std::size_t n_;
  std::vector<double> root_mass_;
  Field q_, q_before_, w_, a_;
  double beta_ = 0;
  std::vector<double> diagonal_, off_diagonal_;
};

}  // namespace

double largest_frequency_rad_per_s(const Operator& op) {
  constexpr int max_rows = 300;
  constexpr double tolerance = 1e-3;
  Lanczos lanczos(op);
  Lanczos::RitzValue largest;
  for (int row = 1; row <= max_rows; ++row) {
    lanczos.add_row();
    if (row % 10 != 0 && row != max_rows && !lanczos.is_exhausted()) continue;
    largest = lanczos.largest();
    if (lanczos.is_exhausted() || largest.residual < tolerance * largest.value) break;
  }
  // Added, the residual makes the estimate err on the safe side.
  const double square = largest.value + largest.residual;
  SLIPFRONT_ASSERT(square > 0 && std::isfinite(square), "stiffness has no positive eigenvalue");
  return std::sqrt(square);
}

double stable_step_s(double omega, double stiffness_damping_s) {
  const double xi = 0.5 * stiffness_damping_s * omega;
  return 2 / (omega * (std::sqrt(1 + xi * xi) + xi));
}

}  // namespace slipfront::solid
