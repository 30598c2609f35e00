// SPDX-License-Identifier: BSD-3-Clause
#include "statics/grid_level.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>

#include "base/error.hpp"
#include "solid/element.hpp"

namespace slipfront::statics {

namespace {

using Block = std::array<double, 4>;

solid::InteriorStencil square_stencil(const solid::Material& material) {
  const auto K = solid::cell_stiffness({0, 0, 1, 0, 1, 1, 0, 1}, material);
  // Rows x0 against x0, x1, x2 and y2, x3: the lower left node of a square against its four nodes.
  return {.centre = 4 * K[0], .along = 2 * K[2], .across = 2 * K[6], .corner = K[4], .twist = K[5]};
}

/// Fills the places of rows in `level` from marks by row: with_stencil(i), else used(i), else unused.
struct RowPlaces {
  GridLevel& level;
  std::vector<mesh::Node> block_nodes;
  explicit RowPlaces(GridLevel& l) : level(l) {
    level.first_span.push_back(0);
    level.first_block.push_back(0);
  }
  template <class Stencil, class Used>
  void add_row(int j, Stencil&& with_stencil, Used&& used) {
    for (int i = 0; i <= level.columns; ++i) {
      if (with_stencil(i)) {
        const bool joins = static_cast<std::int32_t>(level.span.size()) > level.first_span.back() &&
                           level.span.back().end == i;
        if (!joins) level.span.push_back({i, i});
        ++level.span.back().end;
      } else {
        (used(i) ? block_nodes : level.unused).push_back(level.node(i, j));
      }
    }
    level.first_span.push_back(static_cast<std::int32_t>(level.span.size()));
    level.first_block.push_back(static_cast<std::int32_t>(block_nodes.size()));
  }
};

Transfer1D make_transfer_1d(std::span<const double> fine) {
  const auto n = static_cast<std::int32_t>(fine.size()) - 1;
  const std::int32_t m = n / 2;
  Transfer1D t;
  for (std::int32_t k = 0; k < m; ++k) t.place.push_back(2 * k);
  t.place.push_back(n);
  for (std::int32_t k = 0; k <= n; ++k) {
    const std::int32_t left = std::min(k / 2, m - 1);
    const double from = fine[t.place[left]], to = fine[t.place[left + 1]];
    t.left.push_back(left);
    t.weight.push_back(static_cast<float>((fine[k] - from) / (to - from)));
  }
  return t;
}

/// The interface row of two bodies stays, and each body is interpolated by itself, with the interface as the
/// first row of the upper one.
Transfer1D make_transfer_of_rows(const GridLevel& fine) {
  if (fine.interface_row == 0) return make_transfer_1d(fine.y);
  const std::span y(fine.y);
  auto t = make_transfer_1d(y.first(fine.interface_row));
  const auto n_coarse_below = static_cast<std::int32_t>(t.place.size());
  const auto above = make_transfer_1d(y.subspan(fine.interface_row));
  for (const auto left : above.left) t.left.push_back(n_coarse_below + left);
  for (const auto place : above.place) t.place.push_back(fine.interface_row + place);
  t.weight.insert(t.weight.end(), above.weight.begin(), above.weight.end());
  return t;
}

/// Calls f(coarse column, coarse row, weight) for the up to four nodes that the bilinear interpolation takes.
template <class F>
void for_each_bilinear(const Transfer& t, int i, int j, F&& f) {
  const float wx = t.x.weight[i], wy = t.y.weight[j];
  for (int b = 0; b < 2; ++b)
    for (int a = 0; a < 2; ++a) {
      const float w = (a == 1 ? wx : 1 - wx) * (b == 1 ? wy : 1 - wy);
      if (w != 0) f(t.x.left[i] + a, t.y.left[j] + b, w);
    }
}

using solid::BlockRow;

void place_neighbours(GridLevel& level) {
  const auto& rows = level.block;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const int j = rows.neighbour[k] / level.stride();
      level.neighbour_row.push_back(j);
      level.neighbour_column.push_back(rows.neighbour[k] % level.stride());
      level.reach = std::max(level.reach, std::abs(j - rows.node[r] / level.stride()));
    }
}

/// Gathers the block rows of `nodes`; add_row(node, row) adds one.
template <class AddRow>
void set_block_rows(GridLevel& level, std::vector<mesh::Node> nodes, AddRow&& add_row) {
  auto& rows = level.block;
  rows.node = std::move(nodes);
  rows.first.push_back(0);
  BlockRow row;
  for (const auto n : rows.node) {
    add_row(n, row);
    row.move_to(rows);
  }
  place_neighbours(level);
}

int coarse_stride(const Transfer& t) {
  return static_cast<int>(t.x.place.size());
}

template <class F>
void for_each_weight(const GridLevel& fine, const Transfer& t, mesh::Node n, F&& f) {
  if (!t.special.empty()) {
    if (const auto own = t.special.find(n); own != t.special.end()) {
      for (const auto& e : own->second) f(e.coarse, e.weight);
      return;
    }
  }
  const int stride = coarse_stride(t);
  for_each_bilinear(t, n % fine.stride(), n / fine.stride(),
                    [&](int I, int J, float w) { f(J * stride + I, w); });
}

}  // namespace

bool GridLevel::has_stencil(int i, int j) const {
  for (auto k = first_span[j]; k < first_span[j + 1]; ++k)
    if (i >= span[k].begin && i < span[k].end) return true;
  return false;
}

std::int32_t GridLevel::block_row(mesh::Node n) const {
  const int j = n / stride();
  const auto begin = block.node.begin() + first_block[j], end = block.node.begin() + first_block[j + 1];
  const auto place = std::lower_bound(begin, end, n);
  return place != end && *place == n ? static_cast<std::int32_t>(place - block.node.begin()) : -1;
}

GridLevel make_level(const ElasticBody& plate) {
  const auto& mesh = plate.mesh;
  const auto& material = plate.material;
  SLIPFRONT_ASSERT(mesh.period_m == 0, "the logical grid of a periodic plate is not a rectangle");
  GridLevel level;
  level.columns = mesh.grid.columns;
  level.rows = mesh.grid.rows;
  for (int i = 0; i <= level.columns; ++i) level.x.push_back(i);
  for (int j = 0; j <= level.rows; ++j) level.y.push_back(j);
  level.stencil = square_stencil(material);

  // Squares in place around each node, and whether any cell uses it.
  std::vector<std::uint8_t> squares(mesh.n_nodes(), 0);
  constexpr std::uint8_t is_used = 0x80;
  for (const auto& cell : mesh.cells) {
    const bool square = solid::is_square_of_grid(mesh, mesh.grid, cell);
    for (const auto n : cell)
      squares[n] = static_cast<std::uint8_t>((squares[n] + (square ? 1 : 0)) | is_used);
    if (square) continue;
    // The upper nodes of a cell are never glued and tell its place in the grid.
    const mesh::Node in_place = cell[2] - mesh.grid.stride();
    if (cell[1] != in_place) level.glued[in_place] = cell[1];
    if (cell[0] != in_place - 1) level.glued[in_place - 1] = cell[0];
  }
  RowPlaces places(level);
  for (int j = 0; j <= level.rows; ++j)
    places.add_row(
        j, [&](int i) { return squares[level.node(i, j)] == (is_used | 4); },
        [&](int i) { return squares[level.node(i, j)] != 0; });
  level.block = solid::assemble_rows(mesh, material, places.block_nodes);
  place_neighbours(level);
  return level;
}

namespace {

/// Rows of K of two bodies where each body's own level is known.
class PairRows {
 public:
  PairRows(const GridLevel& above, const GridLevel& below, const GridLevel& pair)
      : above_(above), below_(below), pair_(pair) {}

  bool is_stencil(int i, int j) const {
    if (j < pair_.interface_row) return below_.has_stencil(i, last_below() - j);
    return j > pair_.interface_row + 1 && above_.has_stencil(i, j - pair_.interface_row);
  }
  void add_row(mesh::Node n, BlockRow& row) const {
    const int i = n % pair_.stride(), j = n / pair_.stride();
    if (j <= last_below()) add_row_below(below_.node(i, last_below() - j), row);
    if (j >= last_below()) add_row_above(above_.node(i, std::max(0, j - pair_.interface_row)), row);
  }

 private:
  int last_below() const { return pair_.interface_row - 1; }
  void add_row_below(mesh::Node n, BlockRow& row) const {
    for_each_block(below_, n, [&](mesh::Node m, const Block& b) {
      const Block reflected = {b[0], -b[1], -b[2], b[3]};
      row.add(pair_.node(m % pair_.stride(), last_below() - m / pair_.stride()), 1, reflected);
    });
  }
  void add_row_above(mesh::Node n, BlockRow& row) const {
    for_each_block(above_, n, [&](mesh::Node m, const Block& b) {
      const auto on_grid = m + pair_.node(0, pair_.interface_row);
      row.add(on_grid, 1, b);
      if (m < pair_.stride()) row.add(on_grid - pair_.stride(), 1, b);
    });
  }

  const GridLevel &above_, &below_, &pair_;
};

}  // namespace

GridLevel make_level(const ElasticBody& upper, const ElasticBody& lower) {
  const auto above = make_level(upper), below = make_level(lower);
  SLIPFRONT_ASSERT(above.columns == below.columns, "bodies with different columns");
  SLIPFRONT_ASSERT(above.unused.empty() && below.unused.empty(), "two bodies with unused grid numbers");
  GridLevel pair;
  pair.columns = above.columns;
  pair.rows = below.rows + 1 + above.rows;
  pair.interface_row = below.rows + 1;
  pair.x = above.x;
  pair.y = below.y;
  for (const double y : above.y) pair.y.push_back(below.y.back() + y);
  pair.stencil = above.stencil;
  pair.stencil_below = below.stencil;

  const PairRows rows(above, below, pair);
  RowPlaces places(pair);
  for (int j = 0; j <= pair.rows; ++j)
    places.add_row(
        j, [&](int i) { return rows.is_stencil(i, j); }, [](int) { return true; });
  set_block_rows(pair, std::move(places.block_nodes),
                 [&](mesh::Node n, BlockRow& row) { rows.add_row(n, row); });
  return pair;
}

namespace {

/// Between its interface and its first coarse row the upper body also moves with the lower one.
void interpolate_from_both_bodies(const GridLevel& fine, Transfer& t) {
  const int stride = coarse_stride(t), interface = t.y.left[fine.interface_row];
  for (int j = fine.interface_row + 1; t.y.left[j] == interface && t.y.weight[j] < 1; ++j)
    for (int i = 0; i <= fine.columns; ++i) {
      auto& row = t.special[fine.node(i, j)];
      for_each_bilinear(t, i, j, [&](int I, int J, float w) {
        if (J == interface) row.push_back({(J - 1) * stride + I, w});
        row.push_back({J * stride + I, w});
      });
    }
}

}  // namespace

Transfer make_transfer(const GridLevel& fine) {
  Transfer t{make_transfer_1d(fine.x), make_transfer_of_rows(fine), {}};
  if (fine.interface_row > 0) interpolate_from_both_bodies(fine, t);
  if (fine.unused.empty()) return t;
  const auto is_unused = [&](mesh::Node n) { return std::ranges::binary_search(fine.unused, n); };
  const auto place = [&](int I, int J) { return fine.node(t.x.place[I], t.y.place[J]); };
  const int stride = coarse_stride(t);
  // An interpolation reaches two fine rows at most.
  const int last_row = std::min(fine.rows, fine.unused.back() / fine.stride() + 2);
  for (int j = 0; j <= last_row; ++j)
    for (int i = 0; i <= fine.columns; ++i) {
      const auto n = fine.node(i, j);
      if (is_unused(n)) continue;
      bool touches = false;
      for_each_bilinear(t, i, j, [&](int I, int J, float) { touches = touches || is_unused(place(I, J)); });
      if (!touches) continue;
      std::map<mesh::Node, float> weights;
      float sum = 0;
      const auto add = [&](int I, int J, float w) {
        weights[J * stride + I] += w;
        sum += w;
      };
      for_each_bilinear(t, i, j, [&](int I, int J, float w) {
        const auto at = place(I, J);
        if (!is_unused(at)) {
          add(I, J, w);
          return;
        }
        const auto glued = fine.glued.find(at);
        if (glued == fine.glued.end()) return;
        for_each_bilinear(t, glued->second % fine.stride(), glued->second / fine.stride(),
                          [&](int I2, int J2, float w2) {
                            if (!is_unused(place(I2, J2))) add(I2, J2, w * w2);
                          });
      });
      auto& row = t.special[n];
      for (const auto& [coarse, w] : weights) row.push_back({coarse, w / sum});
    }
  return t;
}

namespace {

/// Every second column and row of nodes.
GridLevel coarse_grid(const GridLevel& fine, const Transfer& t) {
  GridLevel coarse;
  coarse.columns = static_cast<int>(t.x.place.size()) - 1;
  coarse.rows = static_cast<int>(t.y.place.size()) - 1;
  coarse.interface_row = t.y.left[fine.interface_row];
  coarse.stencil = fine.stencil;
  coarse.stencil_below = fine.stencil_below;
  for (const auto k : t.x.place) coarse.x.push_back(fine.x[k]);
  for (const auto k : t.y.place) coarse.y.push_back(fine.y[k]);
  return coarse;
}

/// Which coarse nodes keep the stencil: where the finer nodes around have it and all cells are two by two
/// finer ones with their own interpolation.
class StencilKeepers {
 public:
  StencilKeepers(const GridLevel& fine, const Transfer& t, const GridLevel& coarse)
      : fine_(fine),
        t_(t),
        last_column_(fine.columns % 2 == 0 ? coarse.columns - 1 : coarse.columns - 2),
        rows_(coarse.rows),
        first_special_row_(t.special.empty() ? fine.rows + 3 : t.special.begin()->first / fine.stride()),
        last_special_row_(t.special.empty() ? -1 : t.special.rbegin()->first / fine.stride()) {}

  bool contain(int I, int J) const {
    if (I < 1 || J < 1 || I > last_column_ || J == rows_) return false;
    if (!is_two_rows(J - 1) || !is_two_rows(J)) return false;
    const int i = t_.x.place[I], j = t_.y.place[J];
    for (int dj = -1; dj <= 1; ++dj)
      if (!have_stencil(j + dj, i - 1, i + 1)) return false;
    return !near_special(i, j);
  }

 private:
  bool is_two_rows(int J) const { return t_.y.place[J + 1] - t_.y.place[J] == 2; }
  /// Finer nodes from column `from` to column `to`.
  bool have_stencil(int j, int from, int to) const {
    for (auto k = fine_.first_span[j]; k < fine_.first_span[j + 1]; ++k)
      if (from >= fine_.span[k].begin && to < fine_.span[k].end) return true;
    return false;
  }
  bool near_special(int i, int j) const {
    if (j - 2 > last_special_row_ || j + 2 < first_special_row_) return false;
    for (int dj = -2; dj <= 2; ++dj)
      for (int di = -2; di <= 2; ++di)
        if (t_.special.contains(fine_.node(i + di, j + dj))) return true;
    return false;
  }

  const GridLevel& fine_;
  const Transfer& t_;
  int last_column_, rows_, first_special_row_, last_special_row_;
};

/// Sets what kind of node each is; returns those that need block rows.
std::vector<mesh::Node> place_nodes(const GridLevel& fine, const Transfer& t, GridLevel& coarse) {
  const StencilKeepers keepers(fine, t, coarse);
  RowPlaces places(coarse);
  for (int J = 0; J <= coarse.rows; ++J) {
    const auto is_used = [&](int I) {
      return !std::ranges::binary_search(fine.unused, fine.node(t.x.place[I], t.y.place[J]));
    };
    places.add_row(
        J, [&](int I) { return keepers.contain(I, J); }, is_used);
  }
  return std::move(places.block_nodes);
}

/// Glued numbers of the finer level where both ends are coarse nodes.
void glue(const GridLevel& fine, const Transfer& t, GridLevel& coarse) {
  const auto at = [&](mesh::Node n) -> mesh::Node {
    const int i = n % fine.stride(), j = n / fine.stride();
    const int I = t.x.weight[i] == 1 ? t.x.left[i] + 1 : t.x.left[i];
    const int J = t.y.weight[j] == 1 ? t.y.left[j] + 1 : t.y.left[j];
    return t.x.place[I] == i && t.y.place[J] == j ? coarse.node(I, J) : -1;
  };
  for (const auto& [from, to] : fine.glued)
    if (at(from) >= 0 && at(to) >= 0) coarse.glued[at(from)] = at(to);
}

/// Rows of the Galerkin product P^T K P, P the interpolation.
class GalerkinRows {
 public:
  GalerkinRows(const GridLevel& fine, const Transfer& t, const GridLevel& coarse)
      : fine_(fine), t_(t), coarse_(coarse) {
    for (const auto& [n, row] : t.special)
      for (const auto& e : row) special_of_[e.coarse].emplace_back(n, e.weight);
  }

  /// Adds the row of coarse node N.
  void add_row(mesh::Node N, BlockRow& row) const {
    const int I = N % coarse_.stride(), J = N / coarse_.stride();
    const int i_from = I > 0 ? t_.x.place[I - 1] + 1 : 0, j_from = J > 0 ? t_.y.place[J - 1] + 1 : 0;
    const int i_to = I < coarse_.columns ? t_.x.place[I + 1] - 1 : fine_.columns;
    const int j_to = J < coarse_.rows ? t_.y.place[J + 1] - 1 : fine_.rows;
    for (int j = j_from; j <= j_to; ++j)
      for (int i = i_from; i <= i_to; ++i) {
        const auto n = fine_.node(i, j);
        if (!t_.special.empty() && t_.special.contains(n)) continue;
        for_each_bilinear(t_, i, j, [&](int A, int B, float w) {
          if (A == I && B == J) add_finer(n, w, row);
        });
      }
    if (const auto own = special_of_.find(N); own != special_of_.end())
      for (const auto& [n, w] : own->second) add_finer(n, w, row);
  }

 private:
  /// Adds w times the finer node's row of K P.
  void add_finer(mesh::Node n, double w, BlockRow& row) const {
    for_each_block(fine_, n, [&](mesh::Node neighbour, const Block& b) {
      for_each_weight(fine_, t_, neighbour, [&](mesh::Node M, float w2) { row.add(M, w * w2, b); });
    });
  }

  const GridLevel& fine_;
  const Transfer& t_;
  const GridLevel& coarse_;
  /// Finer nodes that interpolate from a coarse node by a separate row.
  std::unordered_map<mesh::Node, std::vector<std::pair<mesh::Node, float>>> special_of_;
};

}  // namespace

GridLevel make_coarse_level(const GridLevel& fine, const Transfer& t) {
  GridLevel coarse = coarse_grid(fine, t);
  auto block_nodes = place_nodes(fine, t, coarse);
  glue(fine, t, coarse);
  const GalerkinRows galerkin(fine, t, coarse);
  set_block_rows(coarse, std::move(block_nodes),
                 [&](mesh::Node N, BlockRow& row) { galerkin.add_row(N, row); });
  return coarse;
}

namespace {

double largest_smoothed_eigenvalue_of(const solid::InteriorStencil& s) {
  // The stencil's Fourier symbol is a symmetric 2 x 2 matrix; its largest eigenvalue over the wave numbers.
  constexpr int n = 64;
  double largest = 0;
  for (int a = 0; a <= n; ++a)
    for (int b = 0; b <= n; ++b) {
      const double x = std::numbers::pi * a / n, y = std::numbers::pi * b / n;
      const double cx = 2 * std::cos(x), cy = 2 * std::cos(y), both = cx * cy;
      const double xx = s.centre + s.along * cx + s.across * cy + s.corner * both;
      const double yy = s.centre + s.across * cx + s.along * cy + s.corner * both;
      const double xy = -4 * s.twist * std::sin(x) * std::sin(y);
      largest = std::max(largest, 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy));
    }
  return largest / s.centre;
}

}  // namespace

double largest_smoothed_eigenvalue(const GridLevel& level) {
  const double above = largest_smoothed_eigenvalue_of(level.stencil);
  return level.interface_row == 0 ? above
                                  : std::max(above, largest_smoothed_eigenvalue_of(level.stencil_below));
}

}  // namespace slipfront::statics
