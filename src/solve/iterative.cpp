// SPDX-License-Identifier: BSD-3-Clause
#include "solve/iterative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.hpp"

namespace slipfront::solve {

namespace {

constexpr int most_cycles = 400;
/// Columns of the coarsest level that finds contact states.
constexpr int least_interface_cells = 64;

/// Calls f(k, sums) for k < n and returns the sums; summed in pieces, so that rounding does not grow with the
/// number of nodes.
template <std::size_t n_sums, class F>
std::array<double, n_sums> for_each_summing(std::size_t n, F&& f) {
  constexpr std::size_t piece = 4096;
  std::array<double, n_sums> total{};
  for (std::size_t begin = 0; begin < n; begin += piece) {
    const std::size_t end = std::min(n, begin + piece);
    double sum0 = 0, sum1 = 0;
#pragma omp simd reduction(+ : sum0, sum1)
    for (std::size_t k = begin; k < end; ++k) {
      const std::array<double, 2> terms = f(k);
      sum0 += terms[0];
      sum1 += terms[1];
    }
    total[0] += sum0;
    if constexpr (n_sums > 1) total[1] += sum1;
  }
  return total;
}

template <class A, class B>
double dot(const std::vector<A>& a, const std::vector<B>& b) {
  const A* __restrict x = a.data();
  const B* __restrict y = b.data();
  return for_each_summing<1>(a.size(), [=](std::size_t k) {
    return std::array<double, 2>{static_cast<double>(x[k]) * static_cast<double>(y[k]), 0};
  })[0];
}

template <class A, class B>
double dot_fields(const A& a, const B& b) {
  return dot(a.x, b.x) + dot(a.y, b.y);
}

/// a = factor a + gain b
template <class B>
void scale_add(double factor, std::vector<double>& a, double gain, const std::vector<B>& b) {
  double* __restrict to = a.data();
  const B* __restrict from = b.data();
  for (std::size_t k = 0; k < a.size(); ++k) to[k] = factor * to[k] + gain * static_cast<double>(from[k]);
}
template <class B>
void scale_add(double factor, solid::Field& a, double gain, const B& b) {
  scale_add(factor, a.x, gain, b.x);
  scale_add(factor, a.y, gain, b.y);
}
/// p = r + beta (p - omega v)
void next_direction(double beta, double omega, const std::vector<double>& r, const std::vector<double>& v,
                    std::vector<double>& p) {
  double* __restrict to = p.data();
  const double* __restrict from_r = r.data();
  const double* __restrict from_v = v.data();
  for (std::size_t k = 0; k < p.size(); ++k) to[k] = from_r[k] + beta * (to[k] - omega * from_v[k]);
}

/// u += step z, r -= step q; returns the new r . with.
template <class Z>
double take_step(double step, const std::vector<Z>& z, const std::vector<double>& q, std::vector<double>& u,
                 std::vector<double>& r, const std::vector<double>& with) {
  const Z* __restrict from_z = z.data();
  const double* __restrict from_q = q.data();
  const double* __restrict other = with.data();
  double* __restrict to_u = u.data();
  double* __restrict to_r = r.data();
  return for_each_summing<1>(u.size(), [=](std::size_t k) {
    to_u[k] += step * static_cast<double>(from_z[k]);
    to_r[k] -= step * from_q[k];
    return std::array<double, 2>{to_r[k] * other[k], 0};
  })[0];
}

/// t . r and t . t
std::array<double, 2> two_dots(const std::vector<double>& t, const std::vector<double>& r) {
  const double* __restrict a = t.data();
  const double* __restrict b = r.data();
  return for_each_summing<2>(t.size(), [=](std::size_t k) {
    return std::array<double, 2>{a[k] * b[k], a[k] * a[k]};
  });
}

template <class B>
void add(solid::Field& a, double gain, const B& b) {
  scale_add(1, a, gain, b);
}

/// Node of the finest level at the place of a level's node.
mesh::Node finest_node(const Multigrid& multigrid, int level, mesh::Node n) {
  for (; level > 0; --level) {
    const auto& t = multigrid.transfer(level - 1);
    const int stride = multigrid.grid(level).stride();
    n = multigrid.grid(level - 1).node(t.x.place[n % stride], t.y.place[n / stride]);
  }
  return n;
}

/// The level's nodes at places of mesh.lower, in their order, and these places.
struct LowerNodes {
  std::vector<mesh::Node> node;
  std::vector<std::size_t> in_mesh_lower;
};
LowerNodes lower_nodes(const mesh::Mesh& mesh, const Multigrid& multigrid, int level) {
  const auto& grid = multigrid.grid(level);
  std::map<mesh::Node, mesh::Node> at;  // by the finest node
  for (const auto n : grid.block.node) at[finest_node(multigrid, level, n)] = n;
  LowerNodes lower;
  for (std::size_t k = 0; k < mesh.lower.size(); ++k) {
    const auto found = at.find(mesh.lower[k]);
    if (found == at.end()) continue;
    lower.node.push_back(found->second);
    lower.in_mesh_lower.push_back(k);
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
  IterativeLoadCase(const mesh::Mesh& mesh, Multigrid& multigrid, int level, TopConstraint constraint,
                    const TopDisplacement& top, bool sheared, const solid::Field* start)
      : mesh_(mesh),
        equations_(mesh, multigrid, level),
        constraint_(constraint),
        top_(top),
        sheared_(sheared) {
    const auto& grid = equations_.grid();
    u0_ = solid::Field(grid.n_nodes());
    u1_ = solid::Field(sheared ? grid.n_nodes() : 0);
    // Uniform strain from the plane to the loaded edge.
    const double height = mesh.y_m[mesh.top.front()];
    for (int j = 0; j <= grid.rows; ++j)
      for (int i = 0; i <= grid.columns; ++i) {
        const auto n = grid.node(i, j);
        const auto in_mesh = equations_.finest(n);
        const int column = in_mesh % mesh.grid.stride();
        const double share = mesh.y_m[in_mesh] / height;
        u0_.y[n] = start != nullptr ? start->y[in_mesh] : share * top.u_y_m[column];
        u0_.x[n] = start != nullptr                    ? start->x[in_mesh]
                   : constraint == TopConstraint::both ? share * top.u_x_m[column]
                                                       : 0;
        if (sheared) u1_.x[n] = share;
      }
    set_fixed();
  }

  void begin_from(const LoadCase& coarser) override {
    const auto& from = dynamic_cast<const IterativeLoadCase&>(coarser);
    const auto& transfer = equations_.multigrid().transfer(equations_.level());
    interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u0_, u0_);
    if (sheared_) interpolate(equations_.grid(), from.equations_.grid(), transfer, from.u1_, u1_);
    set_fixed();
  }

  void solve(const Support& support, double accuracy) override {
    const auto& lower = equations_.lower();
    for (std::size_t k = 0; k < lower.size(); ++k) {
      const auto n = lower[k];
      if (support.contact[k] == Contact::open) continue;
      u0_.y[n] = -mesh_.y_m[equations_.finest(n)];
      if (sheared_) u1_.y[n] = 0;
      if (support.contact[k] != Contact::stick) continue;
      u0_.x[n] = support.anchor_x_m[k];
      if (sheared_) u1_.x[n] = 0;
    }
    equations_.fix(constraint_, support);
    equations_.solve(accuracy, u0_);
    u0 = at_interface(u0_);
    f0 = equations_.interface_forces(u0_);
    if (sheared_) {
      equations_.solve(accuracy, u1_);
      u1 = at_interface(u1_);
      f1 = equations_.interface_forces(u1_);
    } else {
      u1 = f1 = Eigen::VectorXd::Zero(u0.size());
    }
  }

  solid::Field displacement(double shear) const override {
    solid::Field u = u0_;
    if (sheared_) add(u, shear, u1_);
    return u;
  }
  solid::Field displacement_per_shear() const override { return sheared_ ? u1_ : solid::Field(u0_.size()); }

 private:
  /// Exactly the loaded edge's displacements, and 0 at numbers without a node.
  void set_fixed() {
    const auto& grid = equations_.grid();
    for (int i = 0; i <= grid.columns; ++i) {
      const auto n = grid.node(i, grid.rows);
      const int column = equations_.finest(n) % mesh_.grid.stride();
      if (constraint_ == TopConstraint::both) u0_.x[n] = top_.u_x_m[column];
      u0_.y[n] = top_.u_y_m[column];
      if (sheared_) u1_.x[n] = 1;
      if (sheared_) u1_.y[n] = 0;
    }
    for (const auto n : grid.unused) {
      u0_.x[n] = u0_.y[n] = 0;
      if (sheared_) u1_.x[n] = u1_.y[n] = 0;
    }
  }

  Eigen::VectorXd at_interface(const solid::Field& u) const {
    const auto& lower = equations_.lower();
    Eigen::VectorXd v(2 * lower.size());
    for (std::size_t k = 0; k < lower.size(); ++k) {
      v(2 * k) = u.x[lower[k]];
      v(2 * k + 1) = u.y[lower[k]];
    }
    return v;
  }

  const mesh::Mesh& mesh_;
  LevelEquations equations_;
  TopConstraint constraint_;
  TopDisplacement top_;
  bool sheared_;
  solid::Field u0_, u1_;
};

}  // namespace

double iterative_bytes(double n_unknowns) {
  // Of each unknown: three vectors of the cycle in single precision, on all levels together 4/3 of them; five
  // of the linear solution; two of the load case; six of the equilibria at hand; half the coordinates and
  // numbers of a node.
  return n_unknowns * (3 * 4 * 4 / 3.0 + 8 * (5 + 2 + 6) + 16);
}

IterativeSolver::IterativeSolver(const mesh::Mesh& mesh, const solid::Material& material)
    : mesh_(mesh), multigrid_(mesh, material) {
  const auto& grid = multigrid_.grid(0);
  n_unknowns_ = 2 * static_cast<std::int64_t>(grid.n_nodes() - grid.unused.size() - mesh.top.size());
  while (n_levels_ < multigrid_.n_levels() && multigrid_.grid(n_levels_).columns >= least_interface_cells)
    ++n_levels_;
}

std::unique_ptr<LoadCase> IterativeSolver::load_case(TopConstraint constraint, const TopDisplacement& top,
                                                     bool sheared, const solid::Field* start, int level) {
  return std::make_unique<IterativeLoadCase>(mesh_, multigrid_, level, constraint, top, sheared, start);
}

std::vector<std::size_t> IterativeSolver::interface_of(int level) const {
  return lower_nodes(mesh_, multigrid_, level).in_mesh_lower;
}

LevelEquations::LevelEquations(const mesh::Mesh& mesh, Multigrid& multigrid, int level)
    : multigrid_(multigrid),
      level_(level),
      grid_(multigrid.grid(level)),
      buffer_(grid_),
      fixed_(grid_.block.size(), 0),
      residual_(grid_.n_nodes()),
      direction_(grid_.n_nodes()),
      product_(grid_.n_nodes()) {
  auto lower = lower_nodes(mesh, multigrid, level);
  lower_ = std::move(lower.node);
  in_mesh_lower_ = std::move(lower.in_mesh_lower);
  for (int i = 0; i <= grid_.columns; ++i) top_.push_back(grid_.node(i, grid_.rows));
}

mesh::Node LevelEquations::finest(mesh::Node n) const {
  return finest_node(multigrid_, level_, n);
}

void LevelEquations::fix(TopConstraint constraint, const Support& support) {
  SLIPFRONT_ASSERT(support.contact.size() == lower_.size(), "size of the interface");
  FixedNodes fixed;
  fixed.y = top_;
  if (constraint == TopConstraint::both) fixed.x = top_;
  slip_.clear();
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    const auto n = lower_[k];
    if (support.contact[k] == Contact::stick) fixed.x.push_back(n);
    if (support.contact[k] != Contact::open) fixed.y.push_back(n);
    if (support.contact[k] == Contact::slip)
      slip_.push_back({grid_.block_row(n), support.slip_sign[k] * support.mu_s});
  }
  multigrid_.fix(fixed, level_);
  std::ranges::fill(fixed_, std::uint8_t{0});
  for (const auto n : fixed.x) fixed_[grid_.block_row(n)] |= 1;
  for (const auto n : fixed.y) fixed_[grid_.block_row(n)] |= 2;
}

template <class P>
double LevelEquations::multiply(const P& p, solid::Field& q, bool with_fixed) {
  const auto& level = grid_;
  const int stride = level.stride();
  multiply_blocks(level.block, level.block.block, p.x.data(), p.y.data(), buffer_.blocks);
  double energy = 0;
  if (with_fixed)
    for (std::size_t r = 0; r < fixed_.size(); ++r) {
      const auto n = level.block.node[r];
      if ((fixed_[r] & 1) != 0) energy += p.x[n] * buffer_.blocks[2 * r];
      if ((fixed_[r] & 2) != 0) energy += p.y[n] * buffer_.blocks[2 * r + 1];
    }
  for (const auto& slip : slip_)
    buffer_.blocks[2 * slip.block_row] += slip.factor * buffer_.blocks[2 * slip.block_row + 1];
  for (std::size_t r = 0; r < fixed_.size(); ++r) {
    if ((fixed_[r] & 1) != 0) buffer_.blocks[2 * r] = 0;
    if ((fixed_[r] & 2) != 0) buffer_.blocks[2 * r + 1] = 0;
  }
  for (int j = 0; j <= level.rows; ++j) {
    product_row(level, j, p.x.data(), p.y.data(), buffer_);
    const std::size_t begin = static_cast<std::size_t>(j) * stride;
    const double* __restrict a_x = buffer_.x.data();
    const double* __restrict a_y = buffer_.y.data();
    const auto* __restrict p_x = p.x.data() + begin;
    const auto* __restrict p_y = p.y.data() + begin;
    double* __restrict q_x = q.x.data() + begin;
    double* __restrict q_y = q.y.data() + begin;
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < stride; ++i) {
      q_x[i] = a_x[i];
      q_y[i] = a_y[i];
      sum += p_x[i] * a_x[i] + p_y[i] * a_y[i];
    }
    energy += sum;
  }
  return energy;
}

void LevelEquations::solve(double accuracy, solid::Field& u) {
  if (slip_.empty())
    conjugate_gradients(accuracy, u);
  else
    bicgstab(accuracy, u);
}

// With z = B r and B near the inverse, r . z is the square of the error in the energy norm; z itself then
// takes most of the last error away.
void LevelEquations::conjugate_gradients(double accuracy, solid::Field& u) {
  auto& r = residual_;
  auto& p = direction_;
  auto& q = product_;
  const double scale = std::sqrt(std::abs(multiply(u, r, true)));
  scale_add(-1, r, 0, u);
  const auto is_small = [&](double error2) { return std::sqrt(std::abs(error2)) <= accuracy * scale; };
  double error2_before = 0;
  for (int cycle = 1; cycle <= most_cycles; ++cycle) {
    multigrid_.apply(r);
    const double error2 = dot_fields(r, multigrid_.z());
    if (is_small(error2)) {
      add(u, 1, multigrid_.z());
      return;
    }
    scale_add(cycle == 1 ? 0 : error2 / error2_before, p, 1, multigrid_.z());
    error2_before = error2;
    const double step = error2 / multiply(p, q, false);
    add(u, step, p);
    add(r, -step, q);
  }
  throw UserError("the iterative static solution does not converge; set loading.solver = direct");
}

void LevelEquations::bicgstab(double accuracy, solid::Field& u) {
  if (shadow_.size() == 0) shadow_ = second_ = solid::Field(u.size());
  auto& r = residual_;
  auto& p = direction_;
  auto& v = product_;
  auto& t = second_;
  const double scale = std::sqrt(std::abs(multiply(u, r, true)));
  scale_add(-1, r, 0, u);
  shadow_ = r;
  double rho = dot_fields(shadow_, r), beta = 0, omega = 0;
  const auto& z = multigrid_.z();
  const auto is_small = [&](double error2) { return std::sqrt(std::abs(error2)) <= accuracy * scale; };
  p = r;
  for (int cycle = 1; cycle <= most_cycles; cycle += 2) {
    if (cycle > 1) {
      next_direction(beta, omega, r.x, v.x, p.x);
      next_direction(beta, omega, r.y, v.y, p.y);
    }
    multigrid_.apply(p);
    if (cycle == 1 && is_small(dot_fields(r, z))) {
      add(u, 1, z);
      return;
    }
    multiply(z, v, false);
    const double alpha = rho / dot_fields(shadow_, v);
    take_step(alpha, z.x, v.x, u.x, r.x, shadow_.x);
    take_step(alpha, z.y, v.y, u.y, r.y, shadow_.y);
    multigrid_.apply(r);
    if (is_small(dot_fields(r, z))) {
      add(u, 1, z);
      return;
    }
    multiply(z, t, false);
    const auto [t_r_x, t_t_x] = two_dots(t.x, r.x);
    const auto [t_r_y, t_t_y] = two_dots(t.y, r.y);
    omega = (t_r_x + t_r_y) / (t_t_x + t_t_y);
    const double rho_next =
        take_step(omega, z.x, t.x, u.x, r.x, shadow_.x) + take_step(omega, z.y, t.y, u.y, r.y, shadow_.y);
    beta = rho_next / rho * alpha / omega;
    rho = rho_next;
  }
  throw UserError("the iterative static solution does not converge; set loading.solver = direct");
}

Eigen::VectorXd LevelEquations::interface_forces(const solid::Field& u) const {
  const auto& rows = grid_.block;
  Eigen::VectorXd f(2 * lower_.size());
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    const auto r = grid_.block_row(lower_[k]);
    double x = 0, y = 0;
    for (auto e = rows.first[r]; e < rows.first[r + 1]; ++e) {
      const auto& b = rows.block[e];
      const double w_x = u.x[rows.neighbour[e]], w_y = u.y[rows.neighbour[e]];
      x += b[0] * w_x + b[1] * w_y;
      y += b[2] * w_x + b[3] * w_y;
    }
    f(2 * k) = x;
    f(2 * k + 1) = y;
  }
  return f;
}

}  // namespace slipfront::solve
