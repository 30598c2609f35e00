// SPDX-License-Identifier: BSD-3-Clause
#include "statics/iterative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
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

/// Equations of the plate, and of a base below it, on one level of the multigrid, without any matrix:
/// conjugate gradients with one multigrid cycle as preconditioner; where nodes slip, whose friction makes the
/// equations unsymmetric, BiCGStab (van der Vorst, SIAM J. Sci. Stat. Comput. 13, 631-644, 1992) with the
/// same preconditioner.
class LevelEquations {
 public:
  LevelEquations(const BodiesOnGrid& bodies, Multigrid& multigrid, threads::Team& team, int level)
      : bodies_(bodies),
        multigrid_(multigrid),
        team_(team),
        level_(level),
        grid_(multigrid.grid(level)),
        parts_(multigrid.parts(level)),
        interface_(level_interface_nodes(bodies, multigrid, level)),
        conditions_(grid_.block.size()),
        workspace_(parts_, {RowRing<float>(2 * grid_.reach + 1, grid_.stride()),
                            RowsBeside<float>(grid_.reach, grid_.stride())}),
        row_sum_(grid_.rows + 1),
        residual_(grid_.n_nodes()),
        direction_(grid_.n_nodes()) {
    const auto edge = [&](bool is_last) {
      std::vector<mesh::Node> nodes;
      for (int i = 0; i <= grid_.columns; ++i) nodes.push_back(grid_.node(i, is_last ? grid_.rows : 0));
      return nodes;
    };
    loaded_ = edge(bodies.loaded_edge_is_last());
    if (bodies.has_base()) held_ = edge(!bodies.loaded_edge_is_last());
  }

  /// Fixes displacements: the loaded edge's, those that the support does not leave free, and the edge's that
  /// holds a base.
  void fix(TopConstraint constraint, const Support& support) {
    SLIPFRONT_ASSERT(support.contact.size() == interface_.node.size(), "size of the interface");
    conditions_ = Conditions<double>(grid_.block.size());
    const auto block_row = [&](mesh::Node n) {
      const auto r = grid_.block_row(n);
      SLIPFRONT_ASSERT(r >= 0, "a node with a condition is not on the boundary");
      return r;
    };
    for (const auto n : held_) conditions_.fixed[block_row(n)] |= 3;
    for (const auto n : loaded_) conditions_.fixed[block_row(n)] |= constraint == TopConstraint::both ? 3 : 2;
    for (std::size_t k = 0; k < interface_.node.size(); ++k) {
      const auto r = block_row(interface_.node[k]);
      if (support.contact[k] == Contact::stick) conditions_.fixed[r] |= 1;
      if (support.contact[k] != Contact::open) conditions_.fixed[r] |= 2;
      if (support.contact[k] == Contact::slip)
        conditions_.slip[r] = bodies_.x_sign() * support.slip_sign[k] * support.mu_s[k];
    }
    multigrid_.prescribe(conditions_, level_);
    slips_ = std::ranges::count(support.contact, Contact::slip) > 0;
  }

  /// Improves u, whose fixed displacements are right, until the rest is in equilibrium.
  /// @throws UserError where that takes too many cycles.
  void solve(double accuracy, solid::Field& u) {
    const double error = accuracy * std::sqrt(std::abs(start_residual(u)));
    if (!(slips_ ? bicgstab(error, u) : conjugate_gradients(error, u)))
      throw UserError("the iterative static solution does not converge; set {} = direct",
                      Key("loading.solver"));
    const auto& z = multigrid_.z();
    for (std::size_t n = 0; n < u.size(); ++n) {
      u.x[n] += static_cast<double>(z.x[n]);
      u.y[n] += static_cast<double>(z.y[n]);
    }
  }

  /// Relative displacement of the plate at the interface. [2 interface nodes of the level]
  Eigen::VectorXd at_interface(const solid::Field& u) const {
    Eigen::VectorXd v(2 * interface_.node.size());
    for (std::size_t k = 0; k < interface_.node.size(); ++k) {
      v(2 * k) = bodies_.x_sign() * u.x[interface_.node[k]];
      v(2 * k + 1) = u.y[interface_.node[k]];
    }
    return v;
  }

  /// Forces on the plate that u takes at the interface. [2 interface nodes of the level]
  Eigen::VectorXd interface_forces(const solid::Field& u) const {
    Eigen::VectorXd f(2 * interface_.node.size());
    const auto at = [&](mesh::Node n) { return solid::Pair{u.x[n], u.y[n]}; };
    for (std::size_t k = 0; k < interface_.node.size(); ++k) {
      const auto r = grid_.block_row(interface_.node[k]);
      solid::for_each_row_product(grid_.block, {r, r + 1}, at, [&](std::size_t, double x, double y) {
        f(2 * k) = bodies_.x_sign() * x;
        f(2 * k + 1) = y;
      });
    }
    return f;
  }

  const GridLevel& grid() const { return grid_; }
  const Transfer& transfer_from_coarser() const { return multigrid_.transfer(level_); }
  /// The finest grid's node at the place of the level's node.
  mesh::Node finest(mesh::Node n) const { return finest_node(multigrid_, level_, n); }
  const std::vector<mesh::Node>& loaded() const { return loaded_; }  ///< nodes of the loaded edge
  const std::vector<mesh::Node>& held() const { return held_; }      ///< nodes at which a base is held
  const LevelInterfaceNodes& interface() const { return interface_; }

 private:
  /// Calls f(i, a_x, a_y) with row j of A p in the precision T: friction added, 0 at fixed displacements. i
  /// stands for several columns where a_x is a vector.
  template <class T, class P, class F>
  void for_products(int j, const Rows<const P>& p, F&& f) const {
    const auto at_block_row = [&](int i, std::int32_t r, T a_x, T a_y) {
      f(i, (conditions_.fixed[r] & 1) != 0 ? T(0) : a_x, (conditions_.fixed[r] & 2) != 0 ? T(0) : a_y);
    };
    if constexpr (std::is_same_v<T, double>)
      for_row_products<T>(grid_, grid_.block.block, conditions_.slip.data(), j, p, f, at_block_row);
    else
      for_row_products<T>(grid_, multigrid_.blocks(level_), multigrid_.slip(level_).data(), j, p, f,
                          at_block_row);
  }

  /// The sum of f(row) over all rows.
  template <class F>
  double sum_rows(F&& f) {
    team_.run(parts_, [&](int part) {
      const threads::LoopChunk own(grid_.rows + 1, part, parts_);
      for (int j = own.begin; j < own.end; ++j) row_sum_[j] = f(j);
    });
    return std::accumulate(row_sum_.begin(), row_sum_.end(), 0.0);
  }

  /// r = -A u; returns u . K u.
  double start_residual(const solid::Field& u) {
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
                                 const auto fixed = conditions_.fixed[r];
                                 r_x[i] = (fixed & 1) != 0 ? 0 : -(a_x + conditions_.slip[r] * a_y);
                                 r_y[i] = (fixed & 2) != 0 ? 0 : -a_y;
                               });
      return sum.value();
    });
  }

  /// direction = z + beta direction; returns direction . A direction.
  double next_direction(double beta) {
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
        row_sum_[k] = sum.value();
      }
    });
    return std::accumulate(row_sum_.begin(), row_sum_.end(), 0.0);
  }

  /// u += step z, r -= step A z; returns the new r . shadow, where there is one.
  double take_step(double step, const GridField<float>& z, solid::Field& u) {
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
        return 0.0;
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
      return sum.value();
    });
  }

  /// Until z takes most of the last error away, whose energy norm is at most `error`.
  /// @return whether that took not too many cycles
  // With z = B r and B near the inverse, r . z is the square of the error in the energy norm.
  bool conjugate_gradients(double error, solid::Field& u) {
    const auto r = all_rows(std::as_const(residual_), grid_);
    double error2_before = 0;
    for (int cycle = 1; cycle <= max_cycles; ++cycle) {
      require_no_interruption(interrupted_in_statics);
      const double error2 = multigrid_.apply(r);
      if (std::sqrt(std::abs(error2)) <= error) return true;
      const double curvature = next_direction(cycle == 1 ? 0 : error2 / error2_before);
      error2_before = error2;
      take_step(error2 / curvature, direction_, u);
    }
    return false;
  }
  bool bicgstab(double error, solid::Field& u) {
    const auto is_small = [&](double error2) { return std::sqrt(std::abs(error2)) <= error; };
    const auto r = all_rows(std::as_const(residual_), grid_);
    const auto p = all_rows(std::as_const(direction_), grid_);
    const auto& z = multigrid_.z();
    double rho = start_shadow();
    if (is_small(multigrid_.apply(p))) return true;
    for (int cycle = 1; cycle <= max_cycles; cycle += 2) {
      require_no_interruption(interrupted_in_statics);
      const double alpha = rho / multiply_z();
      take_step(alpha, z, u);
      if (is_small(multigrid_.apply(r))) return true;
      const double omega = best_step_along_z();
      const double rho_next = take_step(omega, z, u);
      next_direction(rho_next / rho * alpha / omega, omega);
      rho = rho_next;
      multigrid_.apply(p);
    }
    return false;
  }

  // Steps of bicgstab, with v = product_:
  /// direction = shadow = r; returns r . shadow.
  double start_shadow() {
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
      return sum;
    });
  }

  /// direction = r + beta (direction - omega v).
  void next_direction(double beta, double omega) {
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
      return 0.0;
    });
  }

  /// v = A z; returns v . shadow.
  double multiply_z() {
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
      return sum.value();
    });
  }

  /// That for which r - step A z is smallest.
  double best_step_along_z() {
    const auto z = all_rows(multigrid_.z(), grid_);
    const auto r = all_rows(std::as_const(residual_), grid_);
    std::vector<double> squares(row_sum_.size());
    const double product = sum_rows([&](int j) {
      const double *r_x = r.x(j), *r_y = r.y(j);
      RowSum<float> sum_r, sum_t;
      for_products<float>(j, z, [&]<class V>(int i, const V& t_x, const V& t_y) {
        sum_r.add(t_x, load_as<V>(r_x + i));
        sum_r.add(t_y, load_as<V>(r_y + i));
        sum_t.add(t_x, t_x);
        sum_t.add(t_y, t_y);
      });
      squares[j] = sum_t.value();
      return sum_r.value();
    });
    return product / std::accumulate(squares.begin(), squares.end(), 0.0);
  }

  /// What a thread needs for its sweeps.
  struct Workspace {
    RowRing<float> direction;
    RowsBeside<float> beside;
  };

  const BodiesOnGrid& bodies_;
  Multigrid& multigrid_;
  threads::Team& team_;
  int level_;
  const GridLevel& grid_;
  int parts_;
  LevelInterfaceNodes interface_;
  std::vector<mesh::Node> loaded_, held_;  ///< the level's nodes
  Conditions<double> conditions_;
  bool slips_ = false;
  std::vector<Workspace> workspace_;  ///< [threads]
  std::vector<double> row_sum_;       ///< [rows]
  /// The residual is that of u up to rounding in double precision, since both change by the same step of the
  /// same direction, however the direction was rounded.
  solid::Field residual_;
  GridField<float> direction_, shadow_, product_;
};

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
    const auto& transfer = equations_.transfer_from_coarser();
    interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u0_, u0_);
    if (sheared_) interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u1_, u1_);
    set_fixed();
    solved_.reset();
  }

  void solve(const Support& support, double accuracy) override {
    if (solved_ == support && accuracy >= solved_accuracy_) return;
    solved_ = support;
    solved_accuracy_ = accuracy;
    const auto& interface = equations_.interface();
    for (std::size_t k = 0; k < interface.node.size(); ++k) {
      const auto n = interface.node[k];
      if (support.contact[k] == Contact::open) continue;
      u0_.y[n] = -gap_m_[interface.in_mesh_interface[k]];
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
  solid::Pair uniform_strain(mesh::Node finest, double share) const {
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
  bool sheared_;            ///< whether the edge moves on
  solid::Pair u1_of_edge_;  ///< by which displacement of the grid
  solid::Field u0_, u1_;
  std::optional<Support> solved_;  ///< last one
  double solved_accuracy_ = 0;
};

}  // namespace

double IterativeSolver::bytes() const {
  // Bytes of each unknown: the cycle's z, on coarser levels with a right-hand side; residual; direction, and
  // two more where nodes slip; two displacements of the load case; half the coordinates and numbers of a
  // node.
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

}  // namespace slipfront::statics
