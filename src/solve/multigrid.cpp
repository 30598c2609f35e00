// SPDX-License-Identifier: BSD-3-Clause
#include "solve/multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.hpp"

namespace slipfront::solve {

namespace {

constexpr std::size_t most_coarsest_nodes = 400;
constexpr int least_cells = 4;  ///< a level is made coarser only where it has as many in both directions
/// The smoother acts on the eigenvalues of D^-1 K from this fraction of the largest one; the coarse grid
/// takes the rest.
constexpr double smoothed_fraction = 0.1;
constexpr double eigenvalue_margin = 1.05;

/// Reproducible numbers between -1/2 and 1/2.
class RandomNumbers {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 9007199254740992.0 - 0.5;
  }

 private:
  std::uint64_t state_ = 1;
};

}  // namespace

struct Multigrid::Level {
  GridLevel grid;
  Transfer transfer;  ///< from the next coarser level
  std::vector<std::array<float, 4>> blocks;
  std::vector<std::uint8_t> fixed;      ///< [block rows] bit 0: x, bit 1: y
  std::vector<float> inverse_diagonal;  ///< [2 block rows], 0 where fixed
  double largest = 0;                   ///< eigenvalue of D^-1 K
  double damping = 1;                   ///< factor of D at the block rows
  GridField<float> u, change, b;
  ProductBuffer<float> buffer;

  explicit Level(GridLevel g)
      : grid(std::move(g)),
        blocks(blocks_as<float>(grid.block)),
        fixed(grid.block.size(), 0),
        inverse_diagonal(2 * grid.block.size(), 0.0F),
        u(grid.n_nodes()),
        change(grid.n_nodes()),
        b(grid.n_nodes()),
        buffer(grid) {}

  void set_diagonal() {
    for (std::size_t r = 0; r < grid.block.size(); ++r)
      for (auto k = grid.block.first[r]; k < grid.block.first[r + 1]; ++k) {
        if (grid.block.neighbour[k] != grid.block.node[r]) continue;
        const auto& d = grid.block.block[k];
        for (int c = 0; c < 2; ++c)
          inverse_diagonal[2 * r + c] =
              (fixed[r] >> c & 1) != 0 || d[3 * c] <= 0 ? 0 : static_cast<float>(1 / (damping * d[3 * c]));
      }
  }
};

Multigrid::~Multigrid() = default;

Multigrid::Multigrid(const mesh::Mesh& mesh, const solid::Material& material) {
  levels_.push_back(std::make_unique<Level>(make_level(mesh, material)));
  const auto is_coarse = [](const GridLevel& g) {
    return g.n_nodes() <= most_coarsest_nodes || std::min(g.columns, g.rows) < least_cells;
  };
  while (!is_coarse(levels_.back()->grid)) {
    auto& fine = *levels_.back();
    fine.transfer = make_transfer(fine.grid);
    levels_.push_back(std::make_unique<Level>(make_coarse_level(fine.grid, fine.transfer)));
  }
  for (const auto& level : levels_) {
    damp_block_rows(*level);
    estimate_largest_eigenvalue(*level);
  }
}

const GridLevel& Multigrid::grid(int level) const {
  return levels_[level]->grid;
}

const Transfer& Multigrid::transfer(int finer_level) const {
  return levels_[finer_level]->transfer;
}

const GridField<float>& Multigrid::z() const {
  return levels_[top_level_]->u;
}

void Multigrid::fix(const FixedNodes& fixed, int first) {
  top_level_ = first;
  for (std::size_t l = first; l < levels_.size(); ++l) {
    auto& level = *levels_[l];
    auto& own = level.fixed;
    std::ranges::fill(own, std::uint8_t{0});
    if (l == static_cast<std::size_t>(first)) {
      const auto set = [&](const std::vector<mesh::Node>& nodes, std::uint8_t bit) {
        for (const auto n : nodes) {
          const auto r = level.grid.block_row(n);
          SLIPFRONT_ASSERT(r >= 0, "a prescribed node is not on the boundary");
          own[r] |= bit;
        }
      };
      set(fixed.x, 1);
      set(fixed.y, 2);
    } else {
      const auto& finer = *levels_[l - 1];
      const auto& t = finer.transfer;
      for (std::size_t r = 0; r < own.size(); ++r) {
        const auto n = level.grid.block.node[r];
        const auto finer_row = finer.grid.block_row(
            finer.grid.node(t.x.place[n % level.grid.stride()], t.y.place[n / level.grid.stride()]));
        if (finer_row >= 0) own[r] = finer.fixed[finer_row];
      }
    }
    level.set_diagonal();
  }
  factorise_coarsest();
}

void Multigrid::apply(const solid::Field& r) {
  auto& b = levels_[top_level_]->b;
  n_cycles_ += top_level_ == 0 ? 1 : 0;
  for (std::size_t n = 0; n < r.size(); ++n) {
    b.x[n] = static_cast<float>(r.x[n]);
    b.y[n] = static_cast<float>(r.y[n]);
  }
  cycle(top_level_);
}

void Multigrid::cycle(std::size_t l) {
  if (l + 1 == levels_.size()) {
    solve_coarsest();
    return;
  }
  auto& fine = *levels_[l];
  auto& coarse = *levels_[l + 1];
  smooth(fine, true);
  restrict_residual(fine, coarse);
  cycle(l + 1);
  prolong(coarse, fine);
  smooth(fine, false);
}

void Multigrid::smooth(Level& level, bool from_zero) {
  // Two steps: c1 = g1 D^-1 (b - K u), u1 = u + c1, c2 = k c1 + g2 D^-1 (b - K u1), u2 = u1 + c2.
  const auto& grid = level.grid;
  const int stride = grid.stride();
  const double high = eigenvalue_margin * level.largest, low = smoothed_fraction * high;
  const double theta = 0.5 * (high + low), delta = 0.5 * (high - low), sigma = theta / delta;
  const double rho = sigma / (2 * sigma * sigma - 1);
  const auto gain1 = static_cast<float>(1 / theta), gain2 = static_cast<float>(2 * rho / delta),
             keep = static_cast<float>(rho / sigma);
  const auto inverse_centre = static_cast<float>(1 / grid.stencil.centre);
  auto& change = level.change;
  auto& u = level.u;
  auto& out = level.buffer;
  struct Row {
    float *u, *change;
    const float *b, *product;
  };
  const auto row = [&](int j, int component) {
    const std::size_t begin = static_cast<std::size_t>(j) * stride;
    return component == 0
               ? Row{u.x.data() + begin, change.x.data() + begin, level.b.x.data() + begin, out.x.data()}
               : Row{u.y.data() + begin, change.y.data() + begin, level.b.y.data() + begin, out.y.data()};
  };
  /// Calls f(row, i, D^-1) for all nodes of the plate in grid row j.
  const auto for_row = [&](int j, auto&& f) {
    for (int component = 0; component < 2; ++component) {
      const Row at = row(j, component);
      for (auto k = grid.first_span[j]; k < grid.first_span[j + 1]; ++k)
#pragma omp simd
        for (int i = grid.span[k].begin; i < grid.span[k].end; ++i) f(at, i, inverse_centre);
      for (auto r = grid.first_block[j]; r < grid.first_block[j + 1]; ++r)
        f(at, grid.block.node[r] - j * stride, level.inverse_diagonal[2 * r + component]);
    }
  };

  if (from_zero) {
    for (int j = 0; j <= grid.rows; ++j)
      for_row(j, [gain1](const Row& at, int i, float inverse) { at.change[i] = gain1 * inverse * at.b[i]; });
    multiply_blocks(grid.block, level.blocks, change.x.data(), change.y.data(), out.blocks);
    for (int j = 0; j <= grid.rows; ++j) {
      product_row(grid, j, change.x.data(), change.y.data(), out);
      for_row(j, [keep, gain2](const Row& at, int i, float inverse) {
        at.u[i] = (1 + keep) * at.change[i] + gain2 * inverse * (at.b[i] - at.product[i]);
      });
    }
    for (const auto n : grid.unused) u.x[n] = u.y[n] = 0;
    return;
  }
  // A row of u changes only when its neighbours do not need it any more.
  const auto add_change = [&](int j) {
    for (int component = 0; component < 2; ++component) {
      const Row at = row(j, component);
#pragma omp simd
      for (int i = 0; i < stride; ++i) at.u[i] += at.change[i];
    }
  };
  for (int step = 1; step <= 2; ++step) {
    multiply_blocks(grid.block, level.blocks, u.x.data(), u.y.data(), out.blocks);
    for (int j = 0; j <= grid.rows; ++j) {
      product_row(grid, j, u.x.data(), u.y.data(), out);
      if (step == 1)
        for_row(j, [gain1](const Row& at, int i, float inverse) {
          at.change[i] = gain1 * inverse * (at.b[i] - at.product[i]);
        });
      else
        for_row(j, [keep, gain2](const Row& at, int i, float inverse) {
          at.change[i] = keep * at.change[i] + gain2 * inverse * (at.b[i] - at.product[i]);
        });
      if (j > 0) add_change(j - 1);
    }
    add_change(grid.rows);
  }
}

void Multigrid::restrict_residual(Level& fine, Level& coarse) {
  const auto& grid = fine.grid;
  const auto& t = fine.transfer;
  const int stride = grid.stride(), coarse_stride = coarse.grid.stride();
  std::ranges::fill(coarse.b.x, 0.0F);
  std::ranges::fill(coarse.b.y, 0.0F);
  auto& out = fine.buffer;
  multiply_blocks(grid.block, fine.blocks, fine.u.x.data(), fine.u.y.data(), out.blocks);
  std::vector<float> row(coarse_stride);
  // Cells that consist of two finer ones; the last may have three.
  const int n_pairs = grid.columns % 2 == 0 ? coarse.grid.columns : coarse.grid.columns - 1;
  auto special = t.special.begin();
  for (int j = 0; j <= grid.rows; ++j) {
    product_row(grid, j, fine.u.x.data(), fine.u.y.data(), out);
    const std::size_t begin = static_cast<std::size_t>(j) * stride;
    for (int component = 0; component < 2; ++component) {
      auto& residual = component == 0 ? out.x : out.y;
      const float* __restrict b = (component == 0 ? fine.b.x : fine.b.y).data() + begin;
      float* __restrict r = residual.data();
      for (auto k = grid.first_span[j]; k < grid.first_span[j + 1]; ++k)
        for (int i = grid.span[k].begin; i < grid.span[k].end; ++i) r[i] = b[i] - r[i];
      for (auto k = grid.first_block[j]; k < grid.first_block[j + 1]; ++k) {
        const int i = static_cast<int>(grid.block.node[k] - begin);
        r[i] = fine.inverse_diagonal[2 * k + component] > 0 ? b[i] - r[i] : 0;
      }
    }
    for (; special != t.special.end() && special->first < static_cast<std::int64_t>(begin) + stride;
         ++special) {
      const int i = static_cast<int>(special->first - begin);
      for (const auto& e : special->second) {
        coarse.b.x[e.coarse] += e.weight * out.x[i];
        coarse.b.y[e.coarse] += e.weight * out.y[i];
      }
      out.x[i] = out.y[i] = 0;
    }
    const float w = t.y.weight[j];
    const std::size_t below = static_cast<std::size_t>(t.y.left[j]) * coarse_stride;
    for (int component = 0; component < 2; ++component) {
      const float* __restrict r = (component == 0 ? out.x : out.y).data();
      float* __restrict c = row.data();
      c[0] = r[0] + 0.5F * r[1];
      for (int I = 1; I < n_pairs; ++I) c[I] = r[2 * I] + 0.5F * (r[2 * I - 1] + r[2 * I + 1]);
      if (n_pairs > 0) c[n_pairs] = r[2 * n_pairs] + 0.5F * r[2 * n_pairs - 1];
      if (n_pairs < coarse.grid.columns) {
        if (n_pairs == 0) c[0] = r[0];
        const int i = 2 * n_pairs;
        const float w1 = t.x.weight[i + 1], w2 = t.x.weight[i + 2];
        c[n_pairs] += (1 - w1) * r[i + 1] + (1 - w2) * r[i + 2];
        c[n_pairs + 1] = w1 * r[i + 1] + w2 * r[i + 2] + r[i + 3];
      }
      float* __restrict b = (component == 0 ? coarse.b.x : coarse.b.y).data() + below;
      if (w < 1)
        for (int I = 0; I < coarse_stride; ++I) b[I] += (1 - w) * c[I];
      if (w > 0)
        for (int I = 0; I < coarse_stride; ++I) b[I + coarse_stride] += w * c[I];
    }
  }
}

void Multigrid::prolong(const Level& coarse, Level& fine) {
  const auto& grid = fine.grid;
  const auto& t = fine.transfer;
  const int stride = grid.stride(), coarse_stride = coarse.grid.stride();
  std::vector<std::pair<float, float>> kept;
  for (const auto& [n, entries] : t.special) {
    float x = fine.u.x[n], y = fine.u.y[n];
    for (const auto& e : entries) {
      x += e.weight * coarse.u.x[e.coarse];
      y += e.weight * coarse.u.y[e.coarse];
    }
    kept.emplace_back(x, y);
  }
  std::vector<float> row(coarse_stride);
  const int n_pairs = grid.columns % 2 == 0 ? coarse.grid.columns : coarse.grid.columns - 1;
  for (int j = 0; j <= grid.rows; ++j) {
    const float w = t.y.weight[j];
    const std::size_t below = static_cast<std::size_t>(t.y.left[j]) * coarse_stride;
    for (int component = 0; component < 2; ++component) {
      const float* __restrict e = (component == 0 ? coarse.u.x : coarse.u.y).data() + below;
      float* __restrict c = row.data();
      for (int I = 0; I < coarse_stride; ++I) c[I] = (1 - w) * e[I] + w * e[I + coarse_stride];
      float* __restrict u =
          (component == 0 ? fine.u.x : fine.u.y).data() + static_cast<std::size_t>(j) * stride;
      for (int I = 0; I < n_pairs; ++I) {
        u[2 * I] += c[I];
        u[2 * I + 1] += 0.5F * (c[I] + c[I + 1]);
      }
      for (int i = 2 * n_pairs; i <= grid.columns; ++i) {
        const int I = t.x.left[i];
        u[i] += (1 - t.x.weight[i]) * c[I] + t.x.weight[i] * c[I + 1];
      }
    }
  }
  std::size_t k = 0;
  for (const auto& [n, entries] : t.special) std::tie(fine.u.x[n], fine.u.y[n]) = kept[k++];
  for (std::size_t r = 0; r < grid.block.size(); ++r) {
    if (fine.inverse_diagonal[2 * r] == 0) fine.u.x[grid.block.node[r]] = 0;
    if (fine.inverse_diagonal[2 * r + 1] == 0) fine.u.y[grid.block.node[r]] = 0;
  }
  for (const auto n : grid.unused) fine.u.x[n] = fine.u.y[n] = 0;
}

void Multigrid::damp_block_rows(Level& level) {
  // Distorted cells have larger eigenvalues than the squares, in modes of a few nodes that a power iteration
  // on the whole level would miss. So it is done on the block rows alone, and D is enlarged there.
  const auto& rows = level.grid.block;
  level.set_diagonal();
  std::vector<std::int32_t> row_of(rows.neighbour.size());
  for (std::size_t k = 0; k < row_of.size(); ++k) row_of[k] = level.grid.block_row(rows.neighbour[k]);
  std::vector<double> u(2 * rows.size()), product(2 * rows.size());
  RandomNumbers random;
  for (double& value : u) value = random();
  double largest = 0;
  constexpr int iterations = 60;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    double norm = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      double x = 0, y = 0;
      for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
        if (row_of[k] < 0) continue;
        const auto& b = rows.block[k];
        x += b[0] * u[2 * row_of[k]] + b[1] * u[2 * row_of[k] + 1];
        y += b[2] * u[2 * row_of[k]] + b[3] * u[2 * row_of[k] + 1];
      }
      product[2 * r] = level.inverse_diagonal[2 * r] * x;
      product[2 * r + 1] = level.inverse_diagonal[2 * r + 1] * y;
      norm += product[2 * r] * product[2 * r] + product[2 * r + 1] * product[2 * r + 1];
    }
    norm = std::sqrt(norm);
    largest = norm;  // of a vector of norm 1, but for the first
    for (std::size_t k = 0; k < u.size(); ++k) u[k] = product[k] / norm;
  }
  level.damping = std::max(1.0, largest / largest_smoothed_eigenvalue(level.grid.stencil));
  level.set_diagonal();
}

void Multigrid::estimate_largest_eigenvalue(Level& level) {
  const auto& grid = level.grid;
  const int stride = grid.stride();
  const auto inverse_centre = static_cast<float>(1 / grid.stencil.centre);
  RandomNumbers random;
  auto& u = level.u;
  for (int j = 0; j <= grid.rows; ++j) {
    const auto fill = [&](int i) {
      u.x[grid.node(i, j)] = static_cast<float>(random());
      u.y[grid.node(i, j)] = static_cast<float>(random());
    };
    for (auto k = grid.first_span[j]; k < grid.first_span[j + 1]; ++k)
      for (int i = grid.span[k].begin; i < grid.span[k].end; ++i) fill(i);
    for (auto r = grid.first_block[j]; r < grid.first_block[j + 1]; ++r) fill(grid.block.node[r] % stride);
  }
  auto& out = level.buffer;
  double norm_before = 0;
  constexpr int iterations = 8;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    multiply_blocks(grid.block, level.blocks, u.x.data(), u.y.data(), out.blocks);
    double norm = 0;
    for (int j = 0; j <= grid.rows; ++j) {
      product_row(grid, j, u.x.data(), u.y.data(), out);
      const std::size_t begin = static_cast<std::size_t>(j) * stride;
      float sum = 0;
      for (auto k = grid.first_span[j]; k < grid.first_span[j + 1]; ++k)
#pragma omp simd reduction(+ : sum)
        for (int i = grid.span[k].begin; i < grid.span[k].end; ++i) {
          level.change.x[begin + i] = inverse_centre * out.x[i];
          level.change.y[begin + i] = inverse_centre * out.y[i];
          sum += out.x[i] * out.x[i] + out.y[i] * out.y[i];
        }
      norm += static_cast<double>(sum) * inverse_centre * inverse_centre;
      for (auto r = grid.first_block[j]; r < grid.first_block[j + 1]; ++r) {
        const auto n = grid.block.node[r];
        const float x = level.inverse_diagonal[2 * r] * out.blocks[2 * r];
        const float y = level.inverse_diagonal[2 * r + 1] * out.blocks[2 * r + 1];
        level.change.x[n] = x;
        level.change.y[n] = y;
        norm += x * x + y * y;
      }
    }
    std::swap(level.u, level.change);
    if (iteration + 1 == iterations) level.largest = std::sqrt(norm / norm_before);
    norm_before = norm;
  }
  level.largest = std::max(level.largest, largest_smoothed_eigenvalue(grid.stencil));
  for (auto* field : {&level.u, &level.change}) {
    std::ranges::fill(field->x, 0.0F);
    std::ranges::fill(field->y, 0.0F);
  }
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
  coarsest_.setShift(1e-9 * grid.stencil.centre);
  coarsest_.compute(K);
  SLIPFRONT_ASSERT(coarsest_.info() == Eigen::Success, "the coarsest level is not positive definite");
  coarsest_b_.resize(n_unknowns);
}

void Multigrid::solve_coarsest() {
  auto& level = *levels_.back();
  for (std::size_t n = 0; n < level.grid.n_nodes(); ++n) {
    if (coarsest_unknown_[2 * n] >= 0) coarsest_b_(coarsest_unknown_[2 * n]) = level.b.x[n];
    if (coarsest_unknown_[2 * n + 1] >= 0) coarsest_b_(coarsest_unknown_[2 * n + 1]) = level.b.y[n];
  }
  const Eigen::VectorXd u = coarsest_.solve(coarsest_b_);
  for (std::size_t n = 0; n < level.grid.n_nodes(); ++n) {
    const auto x = coarsest_unknown_[2 * n], y = coarsest_unknown_[2 * n + 1];
    level.u.x[n] = x < 0 ? 0 : static_cast<float>(u(x));
    level.u.y[n] = y < 0 ? 0 : static_cast<float>(u(y));
  }
}

}  // namespace slipfront::solve
