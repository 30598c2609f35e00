// SPDX-License-Identifier: BSD-3-Clause
#include "solve/iterative.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace slipfront::solve {

namespace {

constexpr int most_cycles = 400;

template <class A, class B>
double dot(const std::vector<A>& a, const std::vector<B>& b) {
  // Sums of pieces, so that rounding does not grow with the number of nodes.
  constexpr std::size_t piece = 4096;
  double total = 0;
  for (std::size_t begin = 0; begin < a.size(); begin += piece) {
    const std::size_t end = std::min(a.size(), begin + piece);
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t k = begin; k < end; ++k) sum += static_cast<double>(a[k]) * static_cast<double>(b[k]);
    total += sum;
  }
  return total;
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
template <class B>
void add(solid::Field& a, double gain, const B& b) {
  scale_add(1, a, gain, b);
}

class IterativeLoadCase : public LoadCase {
 public:
  IterativeLoadCase(IterativeSolver& solver, const mesh::Mesh& mesh, TopConstraint constraint,
                    const TopDisplacement& top, bool sheared, const solid::Field* start)
      : solver_(solver), mesh_(mesh), constraint_(constraint), sheared_(sheared) {
    const auto n = static_cast<std::size_t>(mesh.n_nodes());
    u0_ = start != nullptr ? *start : solid::Field(n);
    u1_ = solid::Field(sheared ? n : 0);
    // Uniform strain from the plane to the loaded edge.
    const auto& grid = mesh.grid;
    const double height = mesh.y_m[mesh.top.front()];
    const auto orphan = mesh::orphans(mesh);
    for (int j = 0; j <= grid.rows; ++j)
      for (int i = 0; i <= grid.columns; ++i) {
        const auto node = grid.node(i, j);
        if (orphan[node]) continue;
        const double share = mesh.y_m[node] / height;
        if (start == nullptr) u0_.y[node] = share * top.u_y_m[i];
        if (start == nullptr && constraint == TopConstraint::both) u0_.x[node] = share * top.u_x_m[i];
        if (sheared) u1_.x[node] = share;
      }
    for (std::size_t k = 0; k < mesh.top.size(); ++k) {
      if (constraint == TopConstraint::both) u0_.x[mesh.top[k]] = top.u_x_m[k];
      u0_.y[mesh.top[k]] = top.u_y_m[k];
    }
  }

  void solve(const Support& support, double accuracy) override {
    for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
      const auto n = mesh_.lower[k];
      if (support.contact[k] == Contact::open) continue;
      u0_.y[n] = -mesh_.y_m[n];
      if (sheared_) u1_.y[n] = 0;
      if (support.contact[k] != Contact::stick) continue;
      u0_.x[n] = support.anchor_x_m[k];
      if (sheared_) u1_.x[n] = 0;
    }
    solver_.fix(constraint_, support);
    solver_.solve(accuracy, u0_);
    u0 = at_interface(u0_);
    f0 = solver_.interface_forces(u0_);
    if (sheared_) {
      solver_.solve(accuracy, u1_);
      u1 = at_interface(u1_);
      f1 = solver_.interface_forces(u1_);
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
  Eigen::VectorXd at_interface(const solid::Field& u) const {
    Eigen::VectorXd v(2 * mesh_.lower.size());
    for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
      v(2 * k) = u.x[mesh_.lower[k]];
      v(2 * k + 1) = u.y[mesh_.lower[k]];
    }
    return v;
  }

  IterativeSolver& solver_;
  const mesh::Mesh& mesh_;
  TopConstraint constraint_;
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
    : mesh_(mesh), multigrid_(mesh, material), buffer_(multigrid_.finest()) {
  const auto& finest = multigrid_.finest();
  fixed_.assign(finest.block.size(), 0);
  n_unknowns_ = 2 * static_cast<std::int64_t>(finest.n_nodes() - finest.unused.size() - mesh.top.size());
  const auto n = finest.n_nodes();
  residual_ = direction_ = product_ = solid::Field(n);
}

double IterativeSolver::bytes() const {
  return iterative_bytes(static_cast<double>(n_unknowns_));
}

std::unique_ptr<LoadCase> IterativeSolver::load_case(TopConstraint constraint, const TopDisplacement& top,
                                                     bool sheared, const solid::Field* start) {
  return std::make_unique<IterativeLoadCase>(*this, mesh_, constraint, top, sheared, start);
}

void IterativeSolver::fix(TopConstraint constraint, const Support& support) {
  FixedNodes fixed;
  fixed.y = mesh_.top;
  if (constraint == TopConstraint::both) fixed.x = mesh_.top;
  const auto& finest = multigrid_.finest();
  slip_.clear();
  for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
    const auto n = mesh_.lower[k];
    if (support.contact[k] == Contact::stick) fixed.x.push_back(n);
    if (support.contact[k] != Contact::open) fixed.y.push_back(n);
    if (support.contact[k] == Contact::slip)
      slip_.push_back({finest.block_row(n), support.slip_sign[k] * support.mu_s});
  }
  multigrid_.fix(fixed);
  std::ranges::fill(fixed_, std::uint8_t{0});
  for (const auto n : fixed.x) fixed_[finest.block_row(n)] |= 1;
  for (const auto n : fixed.y) fixed_[finest.block_row(n)] |= 2;
}

template <class P>
double IterativeSolver::multiply(const P& p, solid::Field& q, bool with_fixed) {
  const auto& level = multigrid_.finest();
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

int IterativeSolver::solve(double accuracy, solid::Field& u) {
  const int cycles = slip_.empty() ? conjugate_gradients(accuracy, u) : bicgstab(accuracy, u);
  n_cycles_ += cycles;
  return cycles;
}

// With z = B r and B near the inverse, r . z is the square of the error in the energy norm; z itself then
// takes most of the last error away.
int IterativeSolver::conjugate_gradients(double accuracy, solid::Field& u) {
  auto& r = residual_;
  auto& p = direction_;
  auto& q = product_;
  const double scale = std::sqrt(std::abs(multiply(u, r, true)));
  scale_add(-1, r, 0, u);
  const auto is_small = [&](double error2) { return std::sqrt(std::max(error2, 0.0)) <= accuracy * scale; };
  double error2_before = 0;
  for (int cycle = 1; cycle <= most_cycles; ++cycle) {
    multigrid_.apply(r);
    const double error2 = dot_fields(r, multigrid_.z());
    if (is_small(error2)) {
      add(u, 1, multigrid_.z());
      return cycle;
    }
    scale_add(cycle == 1 ? 0 : error2 / error2_before, p, 1, multigrid_.z());
    error2_before = error2;
    const double step = error2 / multiply(p, q, false);
    add(u, step, p);
    add(r, -step, q);
  }
  throw UserError("the iterative static solution does not converge; set loading.solver = direct");
}

int IterativeSolver::bicgstab(double accuracy, solid::Field& u) {
  if (shadow_.size() == 0) shadow_ = second_ = solid::Field(u.size());
  auto& r = residual_;
  auto& p = direction_;
  auto& v = product_;
  auto& t = second_;
  const double scale = std::sqrt(std::abs(multiply(u, r, true)));
  scale_add(-1, r, 0, u);
  shadow_ = r;
  double rho = 1, alpha = 1, omega = 1;
  const auto& z = multigrid_.z();
  const auto is_small = [&](double error2) { return std::sqrt(std::max(error2, 0.0)) <= accuracy * scale; };
  for (int cycle = 1; cycle <= most_cycles; cycle += 2) {
    const double rho_next = dot_fields(shadow_, r);
    if (cycle == 1) {
      p = r;
    } else {
      const double beta = rho_next / rho * alpha / omega;
      add(p, -omega, v);
      scale_add(beta, p, 1, r);
    }
    rho = rho_next;
    multigrid_.apply(p);
    if (cycle == 1 && is_small(dot_fields(r, z))) {
      add(u, 1, z);
      return cycle;
    }
    multiply(z, v, false);
    alpha = rho / dot_fields(shadow_, v);
    add(u, alpha, z);
    add(r, -alpha, v);
    multigrid_.apply(r);
    const double error2 = dot_fields(r, z);
    if (is_small(error2)) {
      add(u, 1, z);
      return cycle + 1;
    }
    multiply(z, t, false);
    omega = dot_fields(t, r) / dot_fields(t, t);
    add(u, omega, z);
    add(r, -omega, t);
  }
  throw UserError("the iterative static solution does not converge; set loading.solver = direct");
}

Eigen::VectorXd IterativeSolver::interface_forces(const solid::Field& u) const {
  const auto& rows = multigrid_.finest().block;
  Eigen::VectorXd f(2 * mesh_.lower.size());
  for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
    const auto r = multigrid_.finest().block_row(mesh_.lower[k]);
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
