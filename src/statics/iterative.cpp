// SPDX-License-Identifier: BSD-3-Clause
#include "statics/iterative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/interruption.hpp"
#include "base/lanes.hpp"
#include "statics/load_case.hpp"
#include "statics/settings.hpp"

namespace slipfront::statics {

namespace {

constexpr int max_cycles = 400;
/// Columns of the coarsest level that finds contact states.
constexpr int min_interface_cells = 64;

/// Node of the finest level at the place of a level's node.
mesh::Node finest_node(const Multigrid& multigrid, int level, mesh::Node n) {
  for (; level > 0; --level) {
    const auto& t = multigrid.transfer(level - 1);
    const int stride = multigrid.grid(level).stride();
    n = multigrid.grid(level - 1).node(t.x.place[n % stride], t.y.place[n / stride]);
  }
  return n;
}

/// The level's nodes at places of the interface, in the order of mesh.interface_nodes, and these places.
struct LevelInterfaceNodes {
  std::vector<mesh::Node> node;
  std::vector<std::size_t> in_mesh_interface;
};
LevelInterfaceNodes level_interface_nodes(const BodiesOnGrid& bodies, const Multigrid& multigrid, int level) {
  const auto& grid = multigrid.grid(level);
  std::map<mesh::Node, mesh::Node> at;  // by the finest node
  for (const auto n : grid.block.node) at[finest_node(multigrid, level, n)] = n;
  LevelInterfaceNodes lower;
  const auto interface = bodies.interface();
  for (std::size_t k = 0; k < interface.size(); ++k) {
    const auto found = at.find(interface[k]);
    if (found == at.end()) continue;
    lower.node.push_back(found->second);
    lower.in_mesh_interface.push_back(k);
  }
  return lower;
}

void interpolate(const GridLevel& fine, const GridLevel& coarse, const Transfer& t, const solid::Field& from,
                 solid::Field& to) {
  for (int j = 0; j <= fine.rows; ++j)
    for (int i = 0; i <= fine.columns; ++i) {
      const auto n = fine.node(i, j);
      const auto corner = coarse.node(t.x.left[i], t.y.left[j]);
      const double wx = t.x.weight[i], wy = t.y.weight[j];
      const auto value = [&](const std::vector<double>& f) {
        return (1 - wy) * ((1 - wx) * f[corner] + wx * f[corner + 1]) +
               wy * ((1 - wx) * f[corner + coarse.stride()] + wx * f[corner + coarse.stride() + 1]);
      };
      to.x[n] = value(from.x);
      to.y[n] = value(from.y);
    }
  for (const auto& [n, entries] : t.special) {
    to.x[n] = to.y[n] = 0;
    for (const auto& e : entries) {
      to.x[n] += static_cast<double>(e.weight) * from.x[e.coarse];
      to.y[n] += static_cast<double>(e.weight) * from.y[e.coarse];
    }
  }
  for (const auto n : fine.unused) to.x[n] = to.y[n] = 0;
}

class IterativeLoadCase : public LoadCase {
 public:
  IterativeLoadCase(const BodiesOnGrid& bodies, const std::vector<double>& gap_m, Multigrid& multigrid,
                    threads::Team& team, int level, TopConstraint constraint, const TopDisplacement& top,
                    EdgeMotion motion, const DisplacementOfBodies* start)
      : bodies_(bodies),
        gap_m_(gap_m),
        equations_(bodies, multigrid, team, level),
        constraint_(constraint),
        top_(top),
        sheared_(motion != EdgeMotion::none),
        u1_of_edge_{motion == EdgeMotion::along_x ? 1.0 : 0.0,
                    motion == EdgeMotion::down ? -bodies.y_sign() : 0.0} {
    const auto& grid = equations_.grid();
    u0_ = solid::Field(grid.n_nodes());
    u1_ = solid::Field(sheared_ ? grid.n_nodes() : 0);
    for (mesh::Node n = 0; n < static_cast<mesh::Node>(grid.n_nodes()); ++n) {
      const auto finest = equations_.finest(n);
      const double share = bodies.share_of_height(finest);
      const auto u = start != nullptr ? bodies.on_grid(*start, finest) : uniform_strain(finest, share);
      u0_.x[n] = u.x;
      u0_.y[n] = u.y;
      if (!sheared_) continue;
      u1_.x[n] = share * u1_of_edge_.x;
      u1_.y[n] = share * u1_of_edge_.y;
    }
    set_fixed();
  }

  void begin_from(const LoadCase& coarser) override {
    const auto& from = dynamic_cast<const IterativeLoadCase&>(coarser);
    const auto& transfer = equations_.multigrid().transfer(equations_.level());
    interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u0_, u0_);
    if (sheared_) interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u1_, u1_);
    set_fixed();
    solved_.reset();
  }

  void solve(const Support& support, double accuracy) override {
    if (solved_ == support && accuracy >= solved_accuracy_) return;
    solved_ = support;
    solved_accuracy_ = accuracy;
    const auto& lower = equations_.interface_nodes();
    for (std::size_t k = 0; k < lower.size(); ++k) {
      const auto n = lower[k];
      if (support.contact[k] == Contact::open) continue;
      u0_.y[n] = -gap_m_[equations_.in_mesh_interface()[k]];
      if (sheared_) u1_.y[n] = 0;
      if (support.contact[k] != Contact::stick) continue;
      u0_.x[n] = bodies_.x_sign() * support.anchor_x_m[k];
      if (sheared_) u1_.x[n] = 0;
    }
    equations_.fix(constraint_, support);
    equations_.solve(accuracy, u0_);
    u0 = equations_.at_interface(u0_);
    f0 = equations_.interface_forces(u0_);
    if (sheared_) {
      equations_.solve(accuracy, u1_);
      u1 = equations_.at_interface(u1_);
      f1 = equations_.interface_forces(u1_);
    } else {
      u1 = f1 = Eigen::VectorXd::Zero(u0.size());
    }
  }

  Displacement displacement(double shear) const override {
    if (!sheared_) return bodies_.of_bodies(u0_);
    auto u = u0_;
    for (std::size_t n = 0; n < u.size(); ++n) {
      u.x[n] += shear * u1_.x[n];
      u.y[n] += shear * u1_.y[n];
    }
    return bodies_.of_bodies(std::move(u));
  }
  Displacement displacement_per_shear() const override {
    return bodies_.of_bodies(sheared_ ? u1_ : solid::Field(u0_.size()));
  }

 private:
  /// Column of the finest grid.
  int column(mesh::Node finest) const { return finest % static_cast<int>(top_.u_y_m.size()); }

  /// From the interface to the loaded edge.
  BodiesOnGrid::Vector uniform_strain(mesh::Node finest, double share) const {
    return {constraint_ == TopConstraint::both ? share * top_.u_x_m[column(finest)] : 0,
            share * bodies_.y_sign() * top_.u_y_m[column(finest)]};
  }

  /// Exactly the loaded edge's displacements, and 0 at numbers without a node and where a base is held.
  void set_fixed() {
    for (const auto n : equations_.loaded()) {
      const int i = column(equations_.finest(n));
      if (constraint_ == TopConstraint::both) u0_.x[n] = top_.u_x_m[i];
      u0_.y[n] = bodies_.y_sign() * top_.u_y_m[i];
      if (sheared_) u1_.x[n] = u1_of_edge_.x;
      if (sheared_) u1_.y[n] = u1_of_edge_.y;
    }
    set_to_zero(equations_.held());
    set_to_zero(equations_.grid().unused);
  }

  void set_to_zero(const std::vector<mesh::Node>& nodes) {
    for (const auto n : nodes) {
      u0_.x[n] = u0_.y[n] = 0;
      if (sheared_) u1_.x[n] = u1_.y[n] = 0;
    }
  }

  const BodiesOnGrid& bodies_;
  const std::vector<double>& gap_m_;  ///< [interface nodes]
  LevelEquations equations_;
  TopConstraint constraint_;
  TopDisplacement top_;
  bool sheared_;                     ///< whether the edge moves on
  BodiesOnGrid::Vector u1_of_edge_;  ///< by which displacement of the grid
  solid::Field u0_, u1_;
  std::optional<Support> solved_;  ///< last one
  double solved_accuracy_ = 0;
};

}  // namespace

double IterativeSolver::bytes() const {
  // Of each unknown: the cycle's z, on coarser levels with a right-hand side; residual; direction, and two
  // more where nodes slip; two displacements of the load case; half the coordinates and numbers of a node.
  constexpr double single = 4, twice = 8;
  return static_cast<double>(n_unknowns_) * (single + 2 * single / 3 + twice + 3 * single + 2 * twice + 16);
}

IterativeSolver::IterativeSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                                 int threads)
    : gap_m_(gaps_m(plate.mesh, base ? &base->mesh : nullptr)),
      bodies_(plate, base),
      team_(threads),
      multigrid_(make_level_of_bodies(plate, base), team_) {
  const auto& grid = multigrid_.grid(0);
  const auto n_prescribed = plate.mesh.far_edge_nodes.size() + (base ? base->mesh.far_edge_nodes.size() : 0);
  n_unknowns_ = 2 * static_cast<std::int64_t>(grid.n_nodes() - grid.unused.size() - n_prescribed);
  while (n_levels_ < multigrid_.n_levels() && multigrid_.grid(n_levels_).columns >= min_interface_cells)
    ++n_levels_;
}

std::unique_ptr<LoadCase> IterativeSolver::load_case(TopConstraint constraint, const TopDisplacement& top,
                                                     EdgeMotion motion, const DisplacementOfBodies* start,
                                                     int level) {
  return std::make_unique<IterativeLoadCase>(bodies_, gap_m_, multigrid_, team_, level, constraint, top,
                                             motion, start);
}

std::vector<std::size_t> IterativeSolver::interface_of(int level) const {
  return level_interface_nodes(bodies_, multigrid_, level).in_mesh_interface;
}

LevelEquations::LevelEquations(const BodiesOnGrid& bodies, Multigrid& multigrid, threads::Team& team,
                               int level)
    : bodies_(bodies),
      multigrid_(multigrid),
      team_(team),
      level_(level),
      grid_(multigrid.grid(level)),
      parts_(multigrid.parts(level)),
      blocks_f_(blocks_as<float>(grid_.block)),
      fixed_(grid_.block.size(), 0),
      slip_(grid_.block.size(), 0),
      slip_f_(grid_.block.size(), 0),
      workspace_(parts_, {RowRing<float>(2 * grid_.reach + 1, grid_.stride()),
                          RowsBeside<float>(grid_.reach, grid_.stride())}),
      row_sum_(grid_.rows + 1),
      residual_(grid_.n_nodes()),
      direction_(grid_.n_nodes()) {
  auto lower = level_interface_nodes(bodies, multigrid, level);
  interface_nodes_ = std::move(lower.node);
  in_mesh_interface_ = std::move(lower.in_mesh_interface);
  const auto edge = [&](bool is_last) {
    std::vector<mesh::Node> nodes;
    for (int i = 0; i <= grid_.columns; ++i) nodes.push_back(grid_.node(i, is_last ? grid_.rows : 0));
    return nodes;
  };
  loaded_ = edge(bodies.loaded_edge_is_last());
  if (bodies.has_base()) held_ = edge(!bodies.loaded_edge_is_last());
}

mesh::Node LevelEquations::finest(mesh::Node n) const {
  return finest_node(multigrid_, level_, n);
}

void LevelEquations::fix(TopConstraint constraint, const Support& support) {
  SLIPFRONT_ASSERT(support.contact.size() == interface_nodes_.size(), "size of the interface");
  BoundaryNodes boundary;
  boundary.fixed_x = held_;
  boundary.fixed_y = held_;
  boundary.fixed_y.insert(boundary.fixed_y.end(), loaded_.begin(), loaded_.end());
  if (constraint == TopConstraint::both)
    boundary.fixed_x.insert(boundary.fixed_x.end(), loaded_.begin(), loaded_.end());
  for (std::size_t k = 0; k < interface_nodes_.size(); ++k) {
    const auto n = interface_nodes_[k];
    if (support.contact[k] == Contact::stick) boundary.fixed_x.push_back(n);
    if (support.contact[k] != Contact::open) boundary.fixed_y.push_back(n);
    if (support.contact[k] == Contact::slip)
      boundary.slip.push_back({n, bodies_.x_sign() * support.slip_sign[k] * support.mu_s[k]});
  }
  multigrid_.prescribe(boundary, level_);
  std::ranges::fill(fixed_, std::uint8_t{0});
  std::ranges::fill(slip_, 0.0);
  for (const auto n : boundary.fixed_x) fixed_[grid_.block_row(n)] |= 1;
  for (const auto n : boundary.fixed_y) fixed_[grid_.block_row(n)] |= 2;
  for (const auto& slip : boundary.slip) slip_[grid_.block_row(slip.node)] = slip.factor;
  std::ranges::copy(slip_, slip_f_.begin());
  slips_ = !boundary.slip.empty();
}

template <class T, class P, class F>
void LevelEquations::for_products(int j, const Rows<const P>& p, F&& f) const {
  const auto at_block_row = [&](int i, std::int32_t r, T a_x, T a_y) {
    f(i, (fixed_[r] & 1) != 0 ? T(0) : a_x, (fixed_[r] & 2) != 0 ? T(0) : a_y);
  };
  if constexpr (std::is_same_v<T, double>)
    for_row_products<T>(grid_, grid_.block.block, slip_.data(), j, p, f, at_block_row);
  else
    for_row_products<T>(grid_, blocks_f_, slip_f_.data(), j, p, f, at_block_row);
}

template <class F>
std::array<double, 2> LevelEquations::sum_rows(F&& f) {
  team_.run(parts_, [&](int part) {
    const threads::LoopChunk own(grid_.rows + 1, part, parts_);
    for (int j = own.begin; j < own.end; ++j) row_sum_[j] = f(j);
  });
  std::array<double, 2> sum{};
  for (const auto& terms : row_sum_) {
    sum[0] += terms[0];
    sum[1] += terms[1];
  }
  return sum;
}

double LevelEquations::start_residual(const solid::Field& u) {
  const auto u_rows = all_rows(u, grid_);
  const auto r_rows = all_rows(residual_, grid_);
  return sum_rows([&](int j) {
    const double *u_x = u_rows.x(j), *u_y = u_rows.y(j);
    double *r_x = r_rows.x(j), *r_y = r_rows.y(j);
    RowSum<double> sum;
    const auto inside = [&]<class V>(int i, const V& a_x, const V& a_y) {
      sum.add(load_as<V>(u_x + i), a_x);
      sum.add(load_as<V>(u_y + i), a_y);
      store(r_x + i, V(-a_x));
      store(r_y + i, V(-a_y));
    };
    for_row_products<double>(grid_, grid_.block.block, nullptr, j, u_rows, inside,
                             [&](int i, std::int32_t r, double a_x, double a_y) {
                               inside(i, a_x, a_y);
                               r_x[i] = (fixed_[r] & 1) != 0 ? 0 : -(a_x + slip_[r] * a_y);
                               r_y[i] = (fixed_[r] & 2) != 0 ? 0 : -a_y;
                             });
    return std::array<double, 2>{sum.value(), 0};
  })[0];
}

double LevelEquations::next_direction(double beta) {
  const auto z = all_rows(multigrid_.z(), grid_);
  const auto p = all_rows(direction_, grid_);
  const auto factor = static_cast<float>(beta);
  const int reach = grid_.reach, stride = grid_.stride();
  team_.run(parts_, [&](int part) {
    auto& work = workspace_[part];
    const auto next = work.direction.on(grid_);
    const threads::LoopChunk own(grid_.rows + 1, part, parts_);
    work.beside.copy(grid_, p.as_const(), own, reach);
    team_.meet(parts_);
    for (int j = std::max(0, own.begin - reach); j < own.end + reach; ++j) {
      if (j <= grid_.rows) {
        const float *z_x = z.x(j), *z_y = z.y(j);
        const float *p_x = work.beside.x(p.as_const(), j), *p_y = work.beside.y(p.as_const(), j);
        float *n_x = next.x(j), *n_y = next.y(j);
        const bool is_own = j >= own.begin && j < own.end;
        float *o_x = is_own ? p.x(j) : n_x, *o_y = is_own ? p.y(j) : n_y;
#pragma omp simd
        for (int i = 0; i < stride; ++i) {
          o_x[i] = n_x[i] = z_x[i] + factor * p_x[i];
          o_y[i] = n_y[i] = z_y[i] + factor * p_y[i];
        }
      }
      const int k = j - reach;
      if (k < own.begin || k >= own.end) continue;
      const float *n_x = next.x(k), *n_y = next.y(k);
      RowSum<float> sum;
      for_products<float>(k, next.as_const(), [&]<class V>(int i, const V& a_x, const V& a_y) {
        sum.add(load_as<V>(n_x + i), a_x);
        sum.add(load_as<V>(n_y + i), a_y);
      });
      row_sum_[k] = {sum.value(), 0};
    }
  });
  double sum = 0;
  for (const auto& terms : row_sum_) sum += terms[0];
  return sum;
}

double LevelEquations::take_step(double step, const GridField<float>& z, solid::Field& u) {
  const auto z_rows = all_rows(z, grid_);
  const auto u_rows = all_rows(u, grid_);
  const auto r_rows = all_rows(residual_, grid_);
  const auto take = [&](int j, auto&& and_sum) {
    const float *z_x = z_rows.x(j), *z_y = z_rows.y(j);
    double *u_x = u_rows.x(j), *u_y = u_rows.y(j), *r_x = r_rows.x(j), *r_y = r_rows.y(j);
    for_products<double>(j, z_rows, [&]<class V>(int i, const V& a_x, const V& a_y) {
      store(u_x + i, V(load_as<V>(u_x + i) + step * load_as<V>(z_x + i)));
      store(u_y + i, V(load_as<V>(u_y + i) + step * load_as<V>(z_y + i)));
      const V x = load_as<V>(r_x + i) - step * a_x, y = load_as<V>(r_y + i) - step * a_y;
      store(r_x + i, x);
      store(r_y + i, y);
      and_sum(i, x, y);
    });
  };
  if (!slips_) {
    sum_rows([&](int j) {
      take(j, [](int, const auto&, const auto&) {});
      return std::array<double, 2>{};
    });
    return 0;
  }
  return sum_rows([&](int j) {
    const float* s_x = shadow_.x.data() + grid_.node(0, j);
    const float* s_y = shadow_.y.data() + grid_.node(0, j);
    RowSum<double> sum;
    take(j, [&]<class V>(int i, const V& x, const V& y) {
      sum.add(x, load_as<V>(s_x + i));
      sum.add(y, load_as<V>(s_y + i));
    });
    return std::array<double, 2>{sum.value(), 0};
  })[0];
}

void LevelEquations::add_z(solid::Field& u) {
  const auto& z = multigrid_.z();
  for (std::size_t n = 0; n < u.size(); ++n) {
    u.x[n] += static_cast<double>(z.x[n]);
    u.y[n] += static_cast<double>(z.y[n]);
  }
}

void LevelEquations::solve(double accuracy, solid::Field& u) {
  if (slips_)
    bicgstab(accuracy, u);
  else
    conjugate_gradients(accuracy, u);
}

// With z = B r and B near the inverse, r . z is the square of the error in the energy norm; z itself then
// takes most of the last error away.
void LevelEquations::conjugate_gradients(double accuracy, solid::Field& u) {
  const double scale = std::sqrt(std::abs(start_residual(u)));
  const auto r = all_rows(std::as_const(residual_), grid_);
  double error2_before = 0;
  for (int cycle = 1; cycle <= max_cycles; ++cycle) {
    require_no_interruption(interrupted_in_statics);
    const double error2 = multigrid_.apply(r);
    if (std::sqrt(std::abs(error2)) <= accuracy * scale) {
      add_z(u);
      return;
    }
    const double curvature = next_direction(cycle == 1 ? 0 : error2 / error2_before);
    error2_before = error2;
    take_step(error2 / curvature, direction_, u);
  }
  throw UserError("the iterative static solution does not converge; set {} = direct", Key("loading.solver"));
}

double LevelEquations::start_shadow() {
  if (shadow_.size() == 0) shadow_ = product_ = GridField<float>(residual_.size());
  const auto r = all_rows(std::as_const(residual_), grid_);
  const auto p = all_rows(direction_, grid_), s = all_rows(shadow_, grid_);
  return sum_rows([&](int j) {
    const double *r_x = r.x(j), *r_y = r.y(j);
    float *p_x = p.x(j), *p_y = p.y(j), *s_x = s.x(j), *s_y = s.y(j);
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < grid_.stride(); ++i) {
      s_x[i] = p_x[i] = static_cast<float>(r_x[i]);
      s_y[i] = p_y[i] = static_cast<float>(r_y[i]);
      sum += r_x[i] * static_cast<double>(s_x[i]) + r_y[i] * static_cast<double>(s_y[i]);
    }
    return std::array<double, 2>{sum, 0};
  })[0];
}

void LevelEquations::next_direction(double beta, double omega) {
  const auto r = all_rows(std::as_const(residual_), grid_);
  const auto p = all_rows(direction_, grid_), v = all_rows(product_, grid_);
  const auto b = static_cast<float>(beta), b_omega = static_cast<float>(beta * omega);
  sum_rows([&](int j) {
    const double *r_x = r.x(j), *r_y = r.y(j);
    float *p_x = p.x(j), *p_y = p.y(j);
    const float *v_x = v.x(j), *v_y = v.y(j);
#pragma omp simd
    for (int i = 0; i < grid_.stride(); ++i) {
      p_x[i] = static_cast<float>(r_x[i]) + (b * p_x[i] - b_omega * v_x[i]);
      p_y[i] = static_cast<float>(r_y[i]) + (b * p_y[i] - b_omega * v_y[i]);
    }
    return std::array<double, 2>{};
  });
}

double LevelEquations::multiply_z() {
  const auto z = all_rows(multigrid_.z(), grid_);
  const auto s = all_rows(shadow_, grid_), v = all_rows(product_, grid_);
  return sum_rows([&](int j) {
    const float *s_x = s.x(j), *s_y = s.y(j);
    float *v_x = v.x(j), *v_y = v.y(j);
    RowSum<float> sum;
    for_products<float>(j, z, [&]<class V>(int i, const V& a_x, const V& a_y) {
      store(v_x + i, a_x);
      store(v_y + i, a_y);
      sum.add(load_as<V>(s_x + i), a_x);
      sum.add(load_as<V>(s_y + i), a_y);
    });
    return std::array<double, 2>{sum.value(), 0};
  })[0];
}

double LevelEquations::best_step_along_z() {
  const auto z = all_rows(multigrid_.z(), grid_);
  const auto r = all_rows(std::as_const(residual_), grid_);
  const auto sums = sum_rows([&](int j) {
    const double *r_x = r.x(j), *r_y = r.y(j);
    RowSum<float> sum_r, sum_t;
    for_products<float>(j, z, [&]<class V>(int i, const V& t_x, const V& t_y) {
      sum_r.add(t_x, load_as<V>(r_x + i));
      sum_r.add(t_y, load_as<V>(r_y + i));
      sum_t.add(t_x, t_x);
      sum_t.add(t_y, t_y);
    });
    return std::array<double, 2>{sum_r.value(), sum_t.value()};
  });
  return sums[0] / sums[1];
}

void LevelEquations::bicgstab(double accuracy, solid::Field& u) {
  const double scale = std::sqrt(std::abs(start_residual(u)));
  const auto is_small = [&](double error2) { return std::sqrt(std::abs(error2)) <= accuracy * scale; };
  const auto r = all_rows(std::as_const(residual_), grid_);
  const auto p = all_rows(std::as_const(direction_), grid_);
  const auto& z = multigrid_.z();
  double rho = start_shadow();
  if (is_small(multigrid_.apply(p))) {
    add_z(u);
    return;
  }
  for (int cycle = 1; cycle <= max_cycles; cycle += 2) {
    require_no_interruption(interrupted_in_statics);
    const double alpha = rho / multiply_z();
    take_step(alpha, z, u);
    if (is_small(multigrid_.apply(r))) {
      add_z(u);
      return;
    }
    const double omega = best_step_along_z();
    const double rho_next = take_step(omega, z, u);
    next_direction(rho_next / rho * alpha / omega, omega);
    rho = rho_next;
    multigrid_.apply(p);
  }
  throw UserError("the iterative static solution does not converge; set {} = direct", Key("loading.solver"));
}

Eigen::VectorXd LevelEquations::at_interface(const solid::Field& u) const {
  Eigen::VectorXd v(2 * interface_nodes_.size());
  for (std::size_t k = 0; k < interface_nodes_.size(); ++k) {
    v(2 * k) = bodies_.x_sign() * u.x[interface_nodes_[k]];
    v(2 * k + 1) = u.y[interface_nodes_[k]];
  }
  return v;
}

Eigen::VectorXd LevelEquations::interface_forces(const solid::Field& u) const {
  const auto& rows = grid_.block;
  Eigen::VectorXd f(2 * interface_nodes_.size());
  for (std::size_t k = 0; k < interface_nodes_.size(); ++k) {
    const auto r = grid_.block_row(interface_nodes_[k]);
    double x = 0, y = 0;
    for (auto e = rows.first[r]; e < rows.first[r + 1]; ++e) {
      const auto& b = rows.block[e];
      const double w_x = u.x[rows.neighbour[e]], w_y = u.y[rows.neighbour[e]];
      x += b[0] * w_x + b[1] * w_y;
      y += b[2] * w_x + b[3] * w_y;
    }
    f(2 * k) = bodies_.x_sign() * x;
    f(2 * k + 1) = y;
  }
  return f;
}

}  // namespace slipfront::statics
