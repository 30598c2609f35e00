// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "mesh/mesh.hpp"
#include "solid/general.hpp"
#include "solid/material.hpp"

namespace slipfront::solid {

/// A vector field over the nodes, component by component. [nodes]
struct Field {
  std::vector<double> x, y;
  Field() = default;
  explicit Field(std::size_t n) : x(n, 0.0), y(n, 0.0) {}
  std::size_t size() const { return x.size(); }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(x, y);
  }
};

/// Acceleration M^-1 K of a node amid four equal squares, written with the square's symmetries (1/s2):
/// a_x = centre w_x + along (E + W) + across (N + S) + corner (NE + NW + SE + SW) of w_x
///       + twist (NE + SW - NW - SE) of w_y, and the same for y with `along` and `across` exchanged.
struct InteriorStencil {
  double centre, along, across, corner, twist;
};

/// Stencil of a node with two equal squares above it and none below; with the squares below it, north is
/// south and `shear` and `twist` change sign. With the squares to its right, x and y are exchanged, with them
/// north and east, west and south.
/// a_x = centre_x w_x + side_x (E + W) + up_x N + corner_x (NE + NW) + shear (E - W of w_y) + twist (NE - NW
/// of w_y) a_y = centre_y w_y + side_y (E + W) + up_y N + corner_y (NE + NW) - shear (E - W of w_x) + twist
/// (NE - NW of w_x)
struct EdgeStencil {
  double centre_x, side_x, up_x, corner_x;
  double centre_y, side_y, up_y, corner_y;
  double shear, twist;
};

/// Columns of one grid row, or rows of a matrix.
using mesh::Span;

/// All columns of a block.
inline constexpr Span all_columns = {0, std::numeric_limits<int>::max()};

/// Rows of a block-sparse matrix for a list of nodes: any mesh.
struct BlockRows {
  std::vector<mesh::Node> node;     ///< [rows]
  std::vector<std::int32_t> first;  ///< [rows + 1] into neighbour and block
  std::vector<mesh::Node> neighbour;
  std::vector<std::array<double, 4>> block;  ///< xx, xy, yx, yy
  std::size_t size() const { return node.size(); }
};

/// Entries of one block row, gathered in any order.
class BlockRow {
 public:
  void add(mesh::Node neighbour, double factor, const std::array<double, 4>& block);
  /// Appends the row times `scale`, its neighbours ascending, and is empty again.
  void move_to(BlockRows& rows, double scale = 1);

 private:
  std::vector<std::pair<mesh::Node, std::array<double, 4>>> entries_;
};

/// A vector of the plane.
struct Pair {
  double x = 0, y = 0;
};

/// Calls f(row, x, y) with the components of the row's product with w(node), for each of the rows listed.
template <std::invocable<mesh::Node> W, class F>
void for_each_row_product(const BlockRows& rows, Span span, W&& w, F&& f) {
  for (int r = span.begin; r < span.end; ++r) {
    double x = 0, y = 0;
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const auto& b = rows.block[k];
      const Pair at = w(rows.neighbour[k]);
      x += b[0] * at.x + b[1] * at.y;
      y += b[2] * at.x + b[3] * at.y;
    }
    f(static_cast<std::size_t>(r), x, y);
  }
}
template <class F>
void for_each_row_product(const BlockRows& rows, const Field& w, F&& f) {
  for_each_row_product(
      rows, {0, static_cast<int>(rows.size())},
      [&](mesh::Node n) {
        return Pair{w.x[n], w.y[n]};
      },
      f);
}

/// Which of the four cells around a node belong to a part of the plate.
enum class Squares { all, above, below, right, left };

/// Nodes with consecutive numbers: a grid row of a block, or the inner nodes of a transition.
struct NodeRow {
  mesh::Node first = 0;
  int count = 0;
  int period = 0;  ///< columns after which the row repeats; 0 where it does not
};

/// Nodes of one grid row that share a stencil, or have stencils of their own.
struct StencilRow {
  int row = 0;  ///< of Operator::rows
  /// Squares of the own stencils: all, or above or below where no node has others.
  Squares squares = Squares::all;
  /// Factor of the stencil: the mass of a node amid the smallest squares over that of one amid the block's;
  /// at horizontal edges half a square's mass on either side over the node's mass.
  double scale = 1;
  std::vector<Span> spans;
  std::size_t n_own = 0;  ///< nodes with own stencils: all, or none where one is shared
  /// Own stencils: xx, xy, yx, yy of three nodes in each row that is read, [entries][nodes], and room for a
  /// vector behind.
  std::vector<double> own;
};

/// Rows of nodes that a stencil row reads.
inline Span rows_read(const StencilRow& row) {
  return {row.squares == Squares::above ? row.row : row.row - 1,
          row.squares == Squares::below ? row.row + 1 : row.row + 2};
}

/// Whether the row's nodes share the stencil of those with squares above or below them only.
inline bool is_horizontal_edge(const StencilRow& row) {
  return row.n_own == 0 && (row.squares == Squares::above || row.squares == Squares::below);
}

/// What some cells of a body contribute to M^-1 K of the nodes that may move: stencils on the grids, shared
/// where the cells are equal squares; products cell by cell at the transitions between blocks, both ends
/// included, where corners are folded, and on meshes that know no grid.
struct PartialStiffness {
  std::vector<StencilRow> stencil;  ///< rows ascending
  std::vector<mesh::Node> own;      ///< nodes with stencils of their own, in the order of the rows
  GeneralRows general;
};

/// A body's stiffness over its lumped mass, as the explicit scheme needs it.
struct Operator {
  mesh::Grid grid;                 ///< of the lowest block
  std::vector<mesh::Grid> blocks;  ///< upwards, the lowest one first; none where the mesh knows no grid
  std::vector<NodeRow> rows;       ///< all nodes, upwards; a single one where the mesh knows no grid
  int n_rows() const { return static_cast<int>(rows.size()); }
  int row_of(mesh::Node n) const;
  int widest_row() const;
  std::vector<double> mass_kg;    ///< [nodes], per unit thickness; 0 for orphans
  InteriorStencil interior{};     ///< of the lowest block
  EdgeStencil edge{};             ///< over the mass of a node on a straight edge
  PartialStiffness whole;         ///< all cells
  BlockRows far_edge_rows;        ///< K (no mass) of the loaded edge's nodes, N/m
  std::vector<bool> is_far_edge;  ///< [nodes] those with prescribed displacements
  std::vector<bool> has_forces;   ///< [nodes] contact, a dashpot or a spring acts on it
};

/// Nodes of a body's edges whose motion is not that of free nodes.
struct EdgeSets {
  std::vector<mesh::Node> held;         ///< both displacements are prescribed
  std::vector<mesh::Node> with_forces;  ///< of dashpots or springs
};
/// The loaded edge held, dashpots at absorbing nodes.
EdgeSets edge_sets(const mesh::Mesh& mesh);

Operator make_operator(const mesh::Mesh& mesh, const Material& material, const EdgeSets& edges);
inline Operator make_operator(const mesh::Mesh& mesh, const Material& material) {
  return make_operator(mesh, material, edge_sets(mesh));
}

/// What the cells marked contribute. Stencils for nodes that have squares of the part
/// above or below only are used in row 0 and in `edge_row`, rows of the lowest block; for nodes that have
/// them to the right or left only, where no other cell touches them and no forces act.
PartialStiffness make_partial_stiffness(const mesh::Mesh& mesh, const Material& material, const Operator& op,
                                        const std::vector<bool>& in_part, int edge_row);

/// Block rows of K, or of M^-1 K where `mass_kg` is given, for the nodes listed; of all cells, or of those
/// marked.
BlockRows assemble_rows(const mesh::Mesh& mesh, const Material& material, std::span<const mesh::Node> nodes,
                        std::span<const double> mass_kg = {}, const std::vector<bool>& in_part = {});

/// A row of a vector field, or of a part of it.
template <class Real>
struct ConstRowOf {
  const Real* __restrict x;
  const Real* __restrict y;
};
using ConstRow = ConstRowOf<double>;

/// Adds a stencil row's M^-1 K w to a row of a, which is 0 so far; `south` or `north` is not read where there
/// are no cells.
void add_stencil_row(const Operator& op, const StencilRow& row, ConstRow south, ConstRow middle,
                     ConstRow north, double* a_x, double* a_y);

/// Adds the partial M^-1 K w to a.
void add_partial_product(const Operator& op, const PartialStiffness& part, const Field& w, Field& a);

/// a = M^-1 K w for all nodes that may move; 0 for the loaded edge and orphans.
void apply(const Operator& op, const Field& w, Field& a);

/// Strain energy 1/2 u . K u, the loaded edge's part included, J per unit thickness.
double strain_energy_J_per_m(const Operator& op, const Field& u);
/// Kinetic energy 1/2 v . M v, J per unit thickness.
double kinetic_energy_J_per_m(const Operator& op, const Field& v);

/// Largest natural frequency (rad/s) with the loaded edge held, from Lanczos iterations; an upper bound up to
/// the residual tolerance of 1e-3.
double largest_frequency_rad_per_s(const Operator& op);

/// The largest natural frequency (rad/s) without iterations over the whole mesh, of blocks of at least 32 x
/// 32 squares: of a free block of so many of the smallest squares, and of the cells that are no squares with
/// those around them, free as well. A plate divided into parts, each with its own share of the mass, has no
/// higher frequency than the highest of them; free blocks of 20 x 20 and more squares differ by less than
/// 1e-3.
/// @param mesh     of a plate the interface is enough, see mesh::make_interface
/// @param corners  of an interface, where not all cells are squares: these and rings_around_others of cells
///                 around them
double frequency_bound_rad_per_s(const mesh::Mesh& mesh, const Material& material,
                                 const mesh::Mesh* corners = nullptr);
inline constexpr int rings_around_others = 16;

/// Largest frequency of a mesh of squares alone, with this smallest side.
double frequency_of_squares_rad_per_s(double side_m, const Material& material);

/// Nodes from which on iterations over the whole mesh would take longer than many steps.
inline constexpr mesh::Node many_nodes = 500'000;

/// Whether a mesh with such blocks takes the bound.
bool takes_frequency_bound(std::int64_t n_nodes, std::span<const mesh::Grid> blocks);

/// The one or the other.
double largest_frequency_rad_per_s(const mesh::Mesh& mesh, const Material& material, const Operator& op);

/// Largest stable step of the explicit scheme whose damping force acts on the last half-step velocity:
/// (2 / omega) (sqrt(1 + xi^2) - xi), xi = beta_R omega / 2.
double stable_step_s(double largest_frequency_rad_per_s, double stiffness_damping_s);

}  // namespace slipfront::solid
