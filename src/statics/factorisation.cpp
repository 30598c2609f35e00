// SPDX-License-Identifier: BSD-3-Clause
#include "statics/factorisation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "base/budget.hpp"
#include "base/error.hpp"
#include "base/memory.hpp"
#include "base/numbers.hpp"
#include "solid/element.hpp"
#include "statics/dissection.hpp"
#include "statics/indefinite.hpp"

namespace slipfront::statics {

namespace {

/// Those whose rows of K feel the loaded edge or the pusher: their own nodes and the neighbours.
std::vector<mesh::Node> nodes_near_top(const mesh::Mesh& mesh, const std::vector<mesh::Node>& pushed) {
  auto is_loaded = mesh::marked(mesh, mesh.far_edge_nodes);
  for (const auto n : pushed) is_loaded[n] = true;
  std::vector<bool> feels(mesh.n_nodes(), false);
  for (const auto& cell : mesh.cells)
    if (std::ranges::any_of(cell, [&](mesh::Node n) { return is_loaded[n]; }))
      for (const auto n : cell) feels[n] = true;
  std::vector<mesh::Node> near;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (feels[n]) near.push_back(n);
  return near;
}

}  // namespace

Factorisation::Factorisation(const ElasticBody& body, TopConstraint top)
    : mesh_(body.mesh), boundary_(boundary::make_boundary(body.mesh, body.machine)), top_(top) {
  const auto& material = body.material;
  try {
    set_springs();
    for (const std::size_t c : {0, 1})
      if (!is_held_along(c)) spring_[c] = material.youngs_modulus_Pa;
    factorise(material);
  } catch (const std::bad_alloc&) {
    throw UserError("out of memory in the static solution (factorisation); choose a larger {}",
                    Key("plate.element_size_m"));
  }
  near_top_ = solid::assemble_rows(mesh_, material, nodes_near_top(mesh_, boundary_.pushed));
}

void Factorisation::set_springs() {
  spring_N_per_m_.assign(2 * static_cast<std::size_t>(mesh_.n_nodes()), 0);
  for (const auto n : mesh_.far_edge_nodes) {
    if (top_ == TopConstraint::both) spring_N_per_m_[2 * n] = infinity;
    if (top_ != TopConstraint::machine) spring_N_per_m_[2 * n + 1] = infinity;
  }
  if (top_ != TopConstraint::machine) return;
  for (const auto& a : boundary_.nodes) {
    spring_N_per_m_[2 * a.node] = a.spring_x_N_per_m.value_or(0);
    spring_N_per_m_[2 * a.node + 1] = a.spring_y_N_per_m.value_or(0);
  }
}

bool Factorisation::is_held_along(std::size_t c) const {
  for (std::size_t k = c; k < spring_N_per_m_.size(); k += 2)
    if (spring_N_per_m_[k] == infinity) return true;
  return false;
}

std::vector<std::int32_t> Factorisation::number_unknowns() {
  SLIPFRONT_ASSERT(mesh_.n_nodes() < std::numeric_limits<std::int32_t>::max() / 2, "too many unknowns");
  const auto order = dissect(mesh_, mesh_.interface_nodes);
  unknown_.assign(2 * static_cast<std::size_t>(mesh_.n_nodes()), -1);
  std::vector<std::int32_t> block_ends;
  std::size_t k = 0;
  for (const auto end : order.block_ends) {
    for (; k < end; ++k) {
      const auto n = order.nodes[k];
      for (const auto u : {2 * n, 2 * n + 1})
        if (spring_N_per_m_[u] != infinity) unknown_[u] = n_unknowns_++;
    }
    block_ends.push_back(n_unknowns_);
  }
  return block_ends;
}

void Factorisation::factorise(const solid::Material& material) {
  auto block_ends = number_unknowns();
  std::vector<CellUnknowns> cells(mesh_.cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k)
    for (std::size_t a = 0; a < 8; ++a) cells[k][a] = unknown_[2 * mesh_.cells[k][a / 2] + a % 2];
  factor_.emplace(std::move(block_ends), std::move(cells));
  const Message smaller("{} = iterative or {}", Key("loading.solver"), larger_elements());
  require_memory({{"the factor of the stiffness", factor_->factor_bytes(), smaller},
                  {"the fronts of the factorisation", factor_->front_bytes(), smaller}},
                 fmt::format("the factorisation of {} static unknowns", n_unknowns_));

  // A machine's spring counts to the first cell of its node that is asked for.
  auto left = spring_N_per_m_;
  solid::CellStiffness K{}, K_with_springs{};
  solid::CellCoordinates shape_of_K{};
  const auto stiffness_of = [&](std::size_t cell) -> const solid::CellStiffness& {
    auto c = solid::cell_coordinates(mesh_, mesh_.cells[cell]);
    for (int k = 7; k >= 0; --k) c[k] -= c[k % 2];
    if (c != shape_of_K) {
      K = solid::cell_stiffness(c, material);
      shape_of_K = c;
    }
    const auto spring_of = [&](std::size_t a) -> double& {
      return left[2 * mesh_.cells[cell][a / 2] + a % 2];
    };
    bool has_springs = false;
    for (std::size_t a = 0; a < 8; ++a) {
      double& spring = spring_of(a);
      if (spring == 0 || spring == infinity) continue;
      if (!has_springs) K_with_springs = K;
      has_springs = true;
      K_with_springs[8 * a + a] += spring;
      spring = 0;
    }
    return has_springs ? K_with_springs : K;
  };
  Eigen::VectorXd springs = Eigen::VectorXd::Zero(2 * mesh_.interface_nodes.size());
  for (Eigen::Index k = 0; k < springs.size(); ++k) springs(k) = spring_[k % 2];
  auto condensed = factor_->factorise(stiffness_of, springs);
  if (!condensed) throw Indefinite();
  condensed_ = std::move(*condensed);
  return_freed_memory();
}

Eigen::VectorXd Factorisation::at_interface(const solid::Field& u) const {
  Eigen::VectorXd u_i(2 * mesh_.interface_nodes.size());
  for (std::size_t k = 0; k < mesh_.interface_nodes.size(); ++k) {
    u_i(2 * k) = u.x[mesh_.interface_nodes[k]];
    u_i(2 * k + 1) = u.y[mesh_.interface_nodes[k]];
  }
  return u_i;
}

Factorisation::Load Factorisation::load(const TopDisplacement& top) const {
  const Eigen::VectorXd u_i =
      at_interface(solve(top, Eigen::VectorXd::Zero(2 * mesh_.interface_nodes.size())));
  Eigen::VectorXd g = condensed_ * u_i;
  for (Eigen::Index k = 0; k < g.size(); ++k) g(k) += spring_[k % 2] * u_i(k);
  return {top, g};
}

solid::Field Factorisation::displacement(const Load& load, const Eigen::VectorXd& interface_u_m) const {
  Eigen::VectorXd force = condensed_ * interface_u_m - load.g_N;
  for (Eigen::Index k = 0; k < force.size(); ++k) force(k) += spring_[k % 2] * interface_u_m(k);
  return solve(load.top, force);
}

solid::Field Factorisation::displacement(const Eigen::VectorXd& interface_force_N) const {
  SLIPFRONT_ASSERT(spring_[0] == 0 && spring_[1] == 0, "forces on a plate that nothing holds");
  return solve(unit_motion(mesh_, boundary_, EdgeMotion::none), interface_force_N);
}

solid::Field Factorisation::solve(const TopDisplacement& top, const Eigen::VectorXd& interface_force) const {
  SLIPFRONT_ASSERT(
      top.u_x_m.size() == mesh_.far_edge_nodes.size() && top.u_y_m.size() == mesh_.far_edge_nodes.size(),
      "size of the loaded edge");
  solid::Field u(mesh_.n_nodes());
  std::vector<double> f(n_unknowns_);
  const auto hold = [&](std::vector<double> solid::Field::*component, mesh::Node n, double u_m) {
    const auto at = 2 * n + (component == &solid::Field::y ? 1 : 0);
    if (spring_N_per_m_[at] == infinity) (u.*component)[n] = u_m;
    if (spring_N_per_m_[at] == infinity || top_ != TopConstraint::machine) return;
    f[unknown_[at]] += spring_N_per_m_[at] * u_m;
    if (top.tilt_force_N.size() > 0) f[unknown_[at]] += (top.tilt_force_N.*component)[n];
  };
  for (std::size_t k = 0; k < mesh_.far_edge_nodes.size(); ++k) {
    if (boundary_.pushed.empty() || top_ != TopConstraint::machine)
      hold(&solid::Field::x, mesh_.far_edge_nodes[k], top.u_x_m[k]);
    hold(&solid::Field::y, mesh_.far_edge_nodes[k], top.u_y_m[k]);
  }
  for (std::size_t k = 0; top_ == TopConstraint::machine && k < boundary_.pushed.size(); ++k)
    hold(&solid::Field::x, boundary_.pushed[k], top.pushed_u_x_m[k]);
  solid::for_each_row_product(near_top_, u, [&](std::size_t r, double x, double y) {
    const auto n = near_top_.node[r];
    if (unknown_[2 * n] >= 0) f[unknown_[2 * n]] -= x;
    if (unknown_[2 * n + 1] >= 0) f[unknown_[2 * n + 1]] -= y;
  });
  for (std::size_t k = 0; k < mesh_.interface_nodes.size(); ++k) {
    f[unknown_[2 * mesh_.interface_nodes[k]]] += interface_force(2 * k);
    f[unknown_[2 * mesh_.interface_nodes[k] + 1]] += interface_force(2 * k + 1);
  }
  factor_->solve(f);
  for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) {
    if (unknown_[2 * n] >= 0) u.x[n] = f[unknown_[2 * n]];
    if (unknown_[2 * n + 1] >= 0) u.y[n] = f[unknown_[2 * n + 1]];
  }
  return u;
}

}  // namespace slipfront::statics
