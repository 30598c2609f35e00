// SPDX-License-Identifier: BSD-3-Clause
#include "statics/multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "base/lanes.hpp"
#include "base/random.hpp"
#include "statics/indefinite.hpp"

namespace slipfront::statics {

namespace {

constexpr std::size_t max_coarsest_nodes = 400;
constexpr int min_cells = 4;  ///< a level is made coarser only where it has as many in both directions
/// The smoother acts on the eigenvalues of D^-1 K from this fraction of the largest one; the coarse grid
/// takes the rest.
constexpr double smoothed_fraction = 0.1;
constexpr double eigenvalue_margin = 1.05;
constexpr std::size_t min_nodes_for_threads = 40000;  ///< of a level

/// Restricts row r of a residual to the coarse columns.
void restrict_row(const Transfer1D& t, int columns, int coarse_columns, const float* __restrict r,
                  float* __restrict c) {
  // Cells that consist of two finer ones; the last may have three.
  const int n_pairs = columns % 2 == 0 ? coarse_columns : coarse_columns - 1;
  c[0] = r[0] + (n_pairs > 0 ? 0.5F * r[1] : 0.0F);
  for (int I = 1; I < n_pairs; ++I) c[I] = r[2 * I] + 0.5F * (r[2 * I - 1] + r[2 * I + 1]);
  if (n_pairs > 0) c[n_pairs] = r[2 * n_pairs] + 0.5F * r[2 * n_pairs - 1];
  if (n_pairs == coarse_columns) return;
  const int i = 2 * n_pairs;
  const float w1 = t.weight[i + 1], w2 = t.weight[i + 2];
  c[n_pairs] += (1 - w1) * r[i + 1] + (1 - w2) * r[i + 2];
  c[n_pairs + 1] = w1 * r[i + 1] + w2 * r[i + 2] + r[i + 3];
}

/// u = start + interpolation of the values c at the coarse columns.
void interpolate_row(const Transfer1D& t, int columns, int coarse_columns, const float* __restrict c,
                     const float* __restrict start, float* __restrict u) {
  const int n_pairs = columns % 2 == 0 ? coarse_columns : coarse_columns - 1;
  using V = SimdVectorOf<float>;
  int I = 0;
  for (; I + length<V> <= n_pairs; I += length<V>) {
    const V here = load_as<V>(c + I), between = 0.5F * (here + load_as<V>(c + I + 1));
    const auto [first, second] = interleaved(here, between);
    store(u + 2 * I, V(load_as<V>(start + 2 * I) + first));
    store(u + 2 * I + length<V>, V(load_as<V>(start + 2 * I + length<V>) + second));
  }
  for (; I < n_pairs; ++I) {
    u[2 * I] = start[2 * I] + c[I];
    u[2 * I + 1] = start[2 * I + 1] + 0.5F * (c[I] + c[I + 1]);
  }
  for (int i = 2 * n_pairs; i <= columns; ++i) {
    const int left = t.left[i];
    u[i] = start[i] + (1 - t.weight[i]) * c[left] + t.weight[i] * c[left + 1];
  }
}

}  // namespace

struct Multigrid::Level {
  GridLevel grid;
  Transfer transfer;                  ///< from the next coarser level
  std::vector<mesh::Node> special;    ///< nodes with a separate interpolation, ascending
  GridField<float> special_residual;  ///< of these nodes
  std::vector<std::array<float, 4>> blocks;
  Conditions<float> conditions;
  std::vector<float> inverse_diagonal;  ///< [2 block rows], 0 where fixed
  double largest = 0;                   ///< eigenvalue of D^-1 K
  double damping = 1;                   ///< factor of D at the block rows
  GridField<float> u, b;                ///< the finest level's b is not kept

  Level(GridLevel g, bool is_finest)
      : grid(std::move(g)),
        blocks(grid.block.block.size()),
        conditions(grid.block.size()),
        inverse_diagonal(2 * grid.block.size(), 0.0F),
        u(grid.n_nodes()),
        b(is_finest ? 0 : grid.n_nodes()) {
    for (std::size_t k = 0; k < blocks.size(); ++k) std::ranges::copy(grid.block.block[k], blocks[k].begin());
  }

  Rows<float> u_rows() { return all_rows(u, grid); }
  Rows<float> b_rows() { return all_rows(b, grid); }

  void set_diagonal() {
    for (std::size_t r = 0; r < grid.block.size(); ++r)
      for (auto k = grid.block.first[r]; k < grid.block.first[r + 1]; ++k) {
        if (grid.block.neighbour[k] != grid.block.node[r]) continue;
        const auto& d = grid.block.block[k];
        for (int c = 0; c < 2; ++c)
          inverse_diagonal[2 * r + c] = (conditions.fixed[r] >> c & 1) != 0 || d[3 * c] <= 0
                                            ? 0
                                            : static_cast<float>(1 / (damping * d[3 * c]));
      }
  }

  /// Calls step(i, a_x, a_y, D^-1_x, D^-1_y) with the products A = K with friction of row j; the D^-1 are
  /// times `gain`. i stands for several columns where a_x is a vector.
  template <class Step>
  void for_products(int j, const Rows<const float>& field, float gain, Step&& step) const {
    const float inverse = gain / static_cast<float>(grid.stencil_of(j).centre);
    for_row_products<float>(
        grid, blocks, conditions.slip.data(), j, field,
        [&](int i, const auto& a_x, const auto& a_y) { step(i, a_x, a_y, inverse, inverse); },
        [&](int i, std::int32_t r, float a_x, float a_y) {
          step(i, a_x, a_y, gain * inverse_diagonal[2 * r], gain * inverse_diagonal[2 * r + 1]);
        });
  }

  /// Fields are 0 at fixed displacements and unused grid numbers.
  void clear_fixed(int j, float* x, float* y) const {
    for (auto r = grid.first_block[j]; r < grid.first_block[j + 1]; ++r) {
      const auto i = grid.block.node[r] - j * grid.stride();
      if (inverse_diagonal[2 * r] == 0) x[i] = 0;
      if (inverse_diagonal[2 * r + 1] == 0) y[i] = 0;
    }
    clear_unused(grid, j, x, y);
  }

  /// Calls f(k, column) for the special nodes of row j.
  template <class F>
  void for_special(int j, F&& f) const {
    if (special.empty() || grid.node(0, j) > special.back()) return;
    for (auto n = std::ranges::lower_bound(special, grid.node(0, j));
         n != special.end() && *n < grid.node(0, j + 1); ++n)
      f(static_cast<std::size_t>(n - special.begin()), *n - grid.node(0, j));
  }

  /// Gains of two Chebyshev steps: c1 = first D^-1 (rhs - K u), u1 = u + c1,
  /// c2 = keep c1 + second D^-1 (rhs - K u1), u2 = u1 + c2.
  struct Gains {
    float first, second, keep;
  };
  Gains gains() const {
    const double high = eigenvalue_margin * largest, low = smoothed_fraction * high;
    const double theta = 0.5 * (high + low), delta = 0.5 * (high - low), sigma = theta / delta;
    const double rho = sigma / (2 * sigma * sigma - 1);
    return {static_cast<float>(1 / theta), static_cast<float>(2 * rho / delta),
            static_cast<float>(rho / sigma)};
  }

  /// c1 of row j where u = 0.
  template <class B>
  void begin_from_zero(int j, const Gains& gains, const Rows<const B>& rhs, const Rows<float>& c) const {
    const B *b_x = rhs.x(j), *b_y = rhs.y(j);
    float* __restrict c_x = c.x(j), * __restrict c_y = c.y(j);
    const float gain = gains.first / static_cast<float>(grid.stencil_of(j).centre);
    for (int i = 0; i < grid.stride(); ++i) {
      c_x[i] = gain * static_cast<float>(b_x[i]);
      c_y[i] = gain * static_cast<float>(b_y[i]);
    }
    for (auto r = grid.first_block[j]; r < grid.first_block[j + 1]; ++r) {
      const auto i = grid.block.node[r] - j * grid.stride();
      c_x[i] = gains.first * inverse_diagonal[2 * r] * static_cast<float>(b_x[i]);
      c_y[i] = gains.first * inverse_diagonal[2 * r + 1] * static_cast<float>(b_y[i]);
    }
  }

  /// u2 of row j where u = 0, from c1.
  template <class B>
  void end_from_zero(int j, const Gains& gains, const Rows<const B>& rhs, const Rows<const float>& c,
                     const Rows<float>& u2) const {
    const B *b_x = rhs.x(j), *b_y = rhs.y(j);
    const float *c_x = c.x(j), *c_y = c.y(j);
    float *u_x = u2.x(j), *u_y = u2.y(j);
    for_products(j, c, gains.second,
                 [&]<class V>(int i, const V& a_x, const V& a_y, float inverse_x, float inverse_y) {
                   const float kept = 1 + gains.keep;
                   store(u_x + i, V(kept * load_as<V>(c_x + i) + inverse_x * (load_as<V>(b_x + i) - a_x)));
                   store(u_y + i, V(kept * load_as<V>(c_y + i) + inverse_y * (load_as<V>(b_y + i) - a_y)));
                 });
    clear_fixed(j, u_x, u_y);
  }

  /// c1 and u1 of row j.
  template <class B>
  void begin_smoothing(int j, const Gains& gains, const Rows<const B>& rhs, const Rows<const float>& from,
                       const Rows<float>& c, const Rows<float>& u1) const {
    const B *b_x = rhs.x(j), *b_y = rhs.y(j);
    const float *from_x = from.x(j), *from_y = from.y(j);
    float *c_x = c.x(j), *c_y = c.y(j), *u_x = u1.x(j), *u_y = u1.y(j);
    for_products(j, from, gains.first,
                 [&]<class V>(int i, const V& a_x, const V& a_y, float inverse_x, float inverse_y) {
                   const V x = inverse_x * (load_as<V>(b_x + i) - a_x),
                           y = inverse_y * (load_as<V>(b_y + i) - a_y);
                   store(c_x + i, x);
                   store(c_y + i, y);
                   store(u_x + i, V(load_as<V>(from_x + i) + x));
                   store(u_y + i, V(load_as<V>(from_y + i) + y));
                 });
  }

  /// u2 of row j from c1 and u1; returns the row's part of rhs . u2.
  template <class B>
  double end_smoothing(int j, const Gains& gains, const Rows<const B>& rhs, const Rows<const float>& c,
                       const Rows<const float>& u1, const Rows<float>& u2) const {
    const B *b_x = rhs.x(j), *b_y = rhs.y(j);
    const float *c_x = c.x(j), *c_y = c.y(j), *v_x = u1.x(j), *v_y = u1.y(j);
    float *u_x = u2.x(j), *u_y = u2.y(j);
    RowSum<float> sum;
    for_products(
        j, u1, gains.second,
        [&]<class V>(int i, const V& a_x, const V& a_y, float inverse_x, float inverse_y) {
          const V r_x = load_as<V>(b_x + i), r_y = load_as<V>(b_y + i);
          const V x = load_as<V>(v_x + i) + gains.keep * load_as<V>(c_x + i) + inverse_x * (r_x - a_x);
          const V y = load_as<V>(v_y + i) + gains.keep * load_as<V>(c_y + i) + inverse_y * (r_y - a_y);
          store(u_x + i, x);
          store(u_y + i, y);
          sum.add(r_x, x);  // of fixed displacements both are 0
          sum.add(r_y, y);
        });
    clear_unused(grid, j, u_x, u_y);
    return sum.value();
  }

  /// rhs - K v of row j.
  template <class B>
  void residual(int j, const Rows<const B>& rhs, const Rows<const float>& v, float* r_x, float* r_y) const {
    const B *b_x = rhs.x(j), *b_y = rhs.y(j);
    for_row_products<float>(
        grid, blocks, conditions.slip.data(), j, v,
        [&]<class V>(int i, const V& a_x, const V& a_y) {
          store(r_x + i, V(load_as<V>(b_x + i) - a_x));
          store(r_y + i, V(load_as<V>(b_y + i) - a_y));
        },
        [&](int i, std::int32_t, float a_x, float a_y) {
          r_x[i] = static_cast<float>(b_x[i]) - a_x;
          r_y[i] = static_cast<float>(b_y[i]) - a_y;
        });
    clear_fixed(j, r_x, r_y);
  }

  /// Restricts row j of the residual r to the right-hand side of the next coarser level, to `rows` of it.
  void add_restricted(int j, const float* r_x, const float* r_y, std::vector<float>& coarse_row,
                      threads::LoopChunk rows, Level& coarse) const {
    const auto& t = transfer;
    const float w = t.y.weight[j];
    const int below = t.y.left[j];
    const auto coarse_b = coarse.b_rows();
    for (int component = 0; component < 2; ++component) {
      float* __restrict c = coarse_row.data();
      restrict_row(t.x, grid.columns, coarse.grid.columns, component == 0 ? r_x : r_y, c);
      const auto add = [&](int J, float weight) {
        if (weight == 0 || J < rows.begin || J >= rows.end) return;
        float* __restrict to = component == 0 ? coarse_b.x(J) : coarse_b.y(J);
        for (int I = 0; I < coarse.grid.stride(); ++I) to[I] += weight * c[I];
      };
      add(below, 1 - w);
      add(below + 1, w);
    }
  }
  void add_special_residuals(Level& coarse) const {
    std::size_t k = 0;
    for (const auto& [n, entries] : transfer.special) {
      for (const auto& e : entries) {
        coarse.b.x[e.coarse] += e.weight * special_residual.x[k];
        coarse.b.y[e.coarse] += e.weight * special_residual.y[k];
      }
      ++k;
    }
  }

  /// Row j of u with the interpolation of the coarser level's.
  void prolong(const float* u_x, const float* u_y, Level& coarse, int j, std::vector<float>& coarse_row,
               const Rows<float>& to) const {
    const auto& t = transfer;
    const auto coarse_u = coarse.u_rows();
    const float w = t.y.weight[j];
    const int below = t.y.left[j];
    for (int component = 0; component < 2; ++component) {
      const float* __restrict e0 = component == 0 ? coarse_u.x(below) : coarse_u.y(below);
      const float* __restrict e1 = component == 0 ? coarse_u.x(below + 1) : coarse_u.y(below + 1);
      float* __restrict c = coarse_row.data();
      if (w != 0)
        for (int I = 0; I < coarse.grid.stride(); ++I) c[I] = (1 - w) * e0[I] + w * e1[I];
      interpolate_row(t.x, grid.columns, coarse.grid.columns, w == 0 ? e0 : c, component == 0 ? u_x : u_y,
                      component == 0 ? to.x(j) : to.y(j));
    }
    for_special(j, [&](std::size_t k, int i) {
      float x = u_x[i], y = u_y[i];
      for (const auto& e : t.special.at(special[k])) {
        x += e.weight * coarse.u.x[e.coarse];
        y += e.weight * coarse.u.y[e.coarse];
      }
      to.x(j)[i] = x;
      to.y(j)[i] = y;
    });
    clear_fixed(j, to.x(j), to.y(j));
  }

  void damp_block_rows() {
    // Distorted cells have larger eigenvalues than the squares, in modes of a few nodes that a power
    // iteration on the whole level would miss. So it is done on the block rows alone, and D is enlarged
    // there.
    const auto& rows = grid.block;
    set_diagonal();
    std::vector<std::int32_t> row_of(rows.neighbour.size());
    for (std::size_t k = 0; k < row_of.size(); ++k) row_of[k] = grid.block_row(rows.neighbour[k]);
    std::vector<double> v(2 * rows.size()), product(2 * rows.size());
    Random random(1);
    for (double& value : v) value = random();
    double eigenvalue = 0;
    constexpr int iterations = 60;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      double norm = 0;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        double x = 0, y = 0;
        for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
          if (row_of[k] < 0) continue;
          const auto& K = rows.block[k];
          x += K[0] * v[2 * row_of[k]] + K[1] * v[2 * row_of[k] + 1];
          y += K[2] * v[2 * row_of[k]] + K[3] * v[2 * row_of[k] + 1];
        }
        product[2 * r] = inverse_diagonal[2 * r] * x;
        product[2 * r + 1] = inverse_diagonal[2 * r + 1] * y;
        norm += product[2 * r] * product[2 * r] + product[2 * r + 1] * product[2 * r + 1];
      }
      norm = std::sqrt(norm);
      eigenvalue = norm;  // of a vector of norm 1, but for the first
      for (std::size_t k = 0; k < v.size(); ++k) v[k] = product[k] / norm;
    }
    damping = std::max(1.0, eigenvalue / largest_smoothed_eigenvalue(grid));
    set_diagonal();
  }

  void estimate_largest_eigenvalue() {
    Random random(1);
    GridField<float> next(grid.n_nodes());
    for (std::size_t n = 0; n < grid.n_nodes(); ++n) {
      u.x[n] = static_cast<float>(random());
      u.y[n] = static_cast<float>(random());
    }
    for (const auto n : grid.unused) u.x[n] = u.y[n] = 0;
    double norm_before = 0;
    constexpr int iterations = 8;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      const auto from = u_rows().as_const();
      const auto to = all_rows(next, grid);
      double norm = 0;
      for (int j = 0; j <= grid.rows; ++j) {
        float *to_x = to.x(j), *to_y = to.y(j);
        RowSum<float> sum;
        for_products(j, from, 1,
                     [&]<class V>(int i, const V& a_x, const V& a_y, float inverse_x, float inverse_y) {
                       const V x = inverse_x * a_x, y = inverse_y * a_y;
                       store(to_x + i, x);
                       store(to_y + i, y);
                       sum.add(x, x);
                       sum.add(y, y);
                     });
        norm += sum.value();
      }
      std::swap(u, next);
      if (iteration + 1 == iterations) largest = std::sqrt(norm / norm_before);
      norm_before = norm;
    }
    largest = std::max(largest, largest_smoothed_eigenvalue(grid));
    std::ranges::fill(u.x, 0.0F);
    std::ranges::fill(u.y, 0.0F);
  }
};

/// What a thread needs for its sweeps.
struct Multigrid::Workspace {
  RowRing<float> start, change, smoothed;
  RowsBeside<float> beside;
  std::vector<float> residual_x, residual_y, coarse_row;
  Workspace(int reach, int longest_row)
      : start(2 * reach + 1, longest_row),
        change(2 * reach + 1, longest_row),
        smoothed(2 * reach + 1, longest_row),
        beside(2 * reach, longest_row),
        residual_x(longest_row),
        residual_y(longest_row),
        coarse_row(longest_row) {}
};

Multigrid::~Multigrid() = default;

Multigrid::Multigrid(GridLevel finest, threads::Team& team) : team_(team) {
  levels_.push_back(std::make_unique<Level>(std::move(finest), true));
  const auto is_coarse = [](const GridLevel& g) {
    return g.n_nodes() <= max_coarsest_nodes || std::min(g.columns, g.min_rows()) < min_cells;
  };
  while (!is_coarse(levels_.back()->grid)) {
    auto& fine = *levels_.back();
    fine.transfer = make_transfer(fine.grid);
    for (const auto& [n, row] : fine.transfer.special) fine.special.push_back(n);
    fine.special_residual = GridField<float>(fine.special.size());
    levels_.push_back(std::make_unique<Level>(make_coarse_level(fine.grid, fine.transfer), false));
  }
  int reach = 1;
  for (const auto& level : levels_) {
    level->damp_block_rows();
    level->estimate_largest_eigenvalue();
    reach = std::max(reach, level->grid.reach);
  }
  workspace_.assign(team.size(), Workspace(reach, grid(0).stride()));
  row_sum_.resize(grid(0).rows + 1);
}

int Multigrid::parts(int level) const {
  return levels_[level]->grid.n_nodes() >= min_nodes_for_threads ? team_.size() : 1;
}

const GridLevel& Multigrid::grid(int level) const {
  return levels_[level]->grid;
}

const std::vector<std::array<float, 4>>& Multigrid::blocks(int level) const {
  return levels_[level]->blocks;
}

const std::vector<float>& Multigrid::slip(int level) const {
  return levels_[level]->conditions.slip;
}

const Transfer& Multigrid::transfer(int finer_level) const {
  return levels_[finer_level]->transfer;
}

const GridField<float>& Multigrid::z() const {
  return levels_[top_level_]->u;
}

void Multigrid::prescribe(const Conditions<double>& conditions, int first) {
  top_level_ = first;
  auto& top = *levels_[first];
  top.conditions.fixed = conditions.fixed;
  std::ranges::copy(conditions.slip, top.conditions.slip.begin());
  top.set_diagonal();
  for (std::size_t l = first + 1; l < levels_.size(); ++l) {
    auto& level = *levels_[l];
    const auto& finer = *levels_[l - 1];
    const auto& t = finer.transfer;
    level.conditions = Conditions<float>(level.grid.block.size());
    for (std::size_t r = 0; r < level.grid.block.size(); ++r) {
      const auto n = level.grid.block.node[r];
      const auto finer_row = finer.grid.block_row(
          finer.grid.node(t.x.place[n % level.grid.stride()], t.y.place[n / level.grid.stride()]));
      if (finer_row < 0) continue;
      level.conditions.fixed[r] = finer.conditions.fixed[finer_row];
      level.conditions.slip[r] = finer.conditions.slip[finer_row];
    }
    level.set_diagonal();
  }
  factorise_coarsest();
}

double Multigrid::apply(const Rows<const double>& r) {
  return cycle(top_level_, r);
}
double Multigrid::apply(const Rows<const float>& r) {
  return cycle(top_level_, r);
}

template <class B>
double Multigrid::cycle(std::size_t l, const Rows<const B>& b) {
  n_cycles_ += l == 0 ? 1 : 0;
  if (l + 1 == levels_.size()) return solve_coarsest(b);
  smooth_and_restrict(l, b);
  cycle(l + 1, levels_[l + 1]->b_rows().as_const());
  return prolong_and_smooth(l, b);
}

namespace {

/// Takes rows [begin, end) through three steps. A step of a row needs the step before of the rows within
/// K's reach, so it follows by that much, and the earlier steps begin and end so much further out.
template <class First, class Second, class Third>
void sweep(const GridLevel& grid, int begin, int end, First&& first, Second&& second, Third&& third) {
  const int reach = grid.reach;
  const auto is_within = [&](int j, int margin) {
    return j >= std::max(0, begin - margin) && j < std::min(grid.rows + 1, end + margin);
  };
  for (int j = begin - 2 * reach; j < end + 2 * reach; ++j) {
    if (is_within(j, 2 * reach)) first(j);
    if (is_within(j - reach, reach)) second(j - reach);
    if (is_within(j - 2 * reach, 0)) third(j - 2 * reach);
  }
}

}  // namespace

template <class B>
void Multigrid::smooth_and_restrict(std::size_t l, const Rows<const B>& b) {
  auto& fine = *levels_[l];
  auto& coarse = *levels_[l + 1];
  const auto& grid = fine.grid;
  const int n_parts = parts(static_cast<int>(l));
  const auto gains = fine.gains();
  const auto u = fine.u_rows(), coarse_b = coarse.b_rows();

  team_.run(n_parts, [&](int part) {
    auto& work = workspace_[part];
    const auto change = work.change.on(grid), smoothed = work.smoothed.on(grid);
    // Own coarse rows, the finer rows that lie on or above them, and those whose residual they take.
    const threads::LoopChunk own(coarse.grid.rows + 1, part, n_parts);
    const auto first_above = [&](int J) {
      const auto& left = fine.transfer.y.left;
      return static_cast<int>(std::ranges::lower_bound(left, J) - left.begin());
    };
    const int begin = first_above(own.begin - 1), u_begin = first_above(own.begin),
              end = first_above(own.end);
    const auto is_own = [&](int j) { return j >= u_begin && j < end; };
    for (int J = own.begin; J < own.end; ++J) {
      std::fill_n(coarse_b.x(J), coarse.grid.stride(), 0.0F);
      std::fill_n(coarse_b.y(J), coarse.grid.stride(), 0.0F);
    }

    const auto first_step = [&](int j) { fine.begin_from_zero(j, gains, b, change); };
    const auto second_step = [&](int j) {
      fine.end_from_zero(j, gains, b, change.as_const(), smoothed);
      if (!is_own(j)) return;
      std::copy_n(smoothed.x(j), grid.stride(), u.x(j));
      std::copy_n(smoothed.y(j), grid.stride(), u.y(j));
    };
    const auto restrict_residual = [&](int j) {
      float *r_x = work.residual_x.data(), *r_y = work.residual_y.data();
      fine.residual(j, b, smoothed.as_const(), r_x, r_y);
      fine.for_special(j, [&](std::size_t k, int i) {
        if (is_own(j)) {
          fine.special_residual.x[k] = r_x[i];
          fine.special_residual.y[k] = r_y[i];
        }
        r_x[i] = r_y[i] = 0;
      });
      fine.add_restricted(j, r_x, r_y, work.coarse_row, own, coarse);
    };
    sweep(grid, begin, end, first_step, second_step, restrict_residual);
  });
  fine.add_special_residuals(coarse);
}

template <class B>
double Multigrid::prolong_and_smooth(std::size_t l, const Rows<const B>& b) {
  auto& fine = *levels_[l];
  auto& coarse = *levels_[l + 1];
  const auto& grid = fine.grid;
  const int n_parts = parts(static_cast<int>(l));
  const auto gains = fine.gains();
  const auto u = fine.u_rows();

  team_.run(n_parts, [&](int part) {
    auto& work = workspace_[part];
    const auto start = work.start.on(grid), change = work.change.on(grid), smoothed = work.smoothed.on(grid);
    const threads::LoopChunk own(grid.rows + 1, part, n_parts);
    work.beside.copy(grid, u.as_const(), own, 2 * grid.reach);
    team_.meet(n_parts);

    const auto prolong_row = [&](int j) {
      fine.prolong(work.beside.x(u.as_const(), j), work.beside.y(u.as_const(), j), coarse, j, work.coarse_row,
                   start);
    };
    const auto first_step = [&](int j) {
      fine.begin_smoothing(j, gains, b, start.as_const(), change, smoothed);
    };
    const auto second_step = [&](int j) {
      row_sum_[j] = fine.end_smoothing(j, gains, b, change.as_const(), smoothed.as_const(), u);
    };
    sweep(grid, own.begin, own.end, prolong_row, first_step, second_step);
  });
  return std::accumulate(row_sum_.begin(), row_sum_.begin() + grid.rows + 1, 0.0);
}

void Multigrid::factorise_coarsest() {
  const auto& level = *levels_.back();
  const auto& grid = level.grid;
  coarsest_unknown_.assign(2 * grid.n_nodes(), -1);
  std::int32_t n_unknowns = 0;
  for (mesh::Node n = 0; n < static_cast<mesh::Node>(grid.n_nodes()); ++n) {
    const auto r = grid.block_row(n);
    const bool stencil = r < 0 && grid.has_stencil(n % grid.stride(), n / grid.stride());
    for (int c = 0; c < 2; ++c)
      if (stencil || (r >= 0 && level.inverse_diagonal[2 * r + c] > 0))
        coarsest_unknown_[2 * n + c] = n_unknowns++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (mesh::Node n = 0; n < static_cast<mesh::Node>(grid.n_nodes()); ++n)
    for_each_block(grid, n, [&](mesh::Node m, const std::array<double, 4>& b) {
      for (int a = 0; a < 2; ++a)
        for (int c = 0; c < 2; ++c) {
          const auto row = coarsest_unknown_[2 * n + a], column = coarsest_unknown_[2 * m + c];
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, b[2 * a + c]);
        }
    });
  Eigen::SparseMatrix<double> K(n_unknowns, n_unknowns);
  K.setFromTriplets(entries.begin(), entries.end());
  // Where nothing sticks and the loaded edge may move along x, that motion costs nothing.
  const double softer = grid.interface_row == 0 ? grid.stencil.centre
                                                : std::min(grid.stencil.centre, grid.stencil_below.centre);
  coarsest_.setShift(1e-9 * softer);
  coarsest_.compute(K);
  if (coarsest_.info() != Eigen::Success) throw Indefinite();
  coarsest_b_.resize(n_unknowns);
}

template <class B>
double Multigrid::solve_coarsest(const Rows<const B>& b) {
  auto& level = *levels_.back();
  const std::size_t n_nodes = level.grid.n_nodes();
  for (std::size_t n = 0; n < n_nodes; ++n) {
    if (coarsest_unknown_[2 * n] >= 0) coarsest_b_(coarsest_unknown_[2 * n]) = b.x(0)[n];
    if (coarsest_unknown_[2 * n + 1] >= 0) coarsest_b_(coarsest_unknown_[2 * n + 1]) = b.y(0)[n];
  }
  const Eigen::VectorXd u = coarsest_.solve(coarsest_b_);
  for (std::size_t n = 0; n < n_nodes; ++n) {
    const auto x = coarsest_unknown_[2 * n], y = coarsest_unknown_[2 * n + 1];
    level.u.x[n] = x < 0 ? 0 : static_cast<float>(u(x));
    level.u.y[n] = y < 0 ? 0 : static_cast<float>(u(y));
  }
  return coarsest_b_.dot(u);
}

}  // namespace slipfront::statics
