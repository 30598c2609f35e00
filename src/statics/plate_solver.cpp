// SPDX-License-Identifier: BSD-3-Clause
#include "statics/plate_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "boundary/boundary.hpp"
#include "statics/condensed_interface.hpp"
#include "statics/factorisation.hpp"
#include "statics/iterative.hpp"
#include "statics/load_case.hpp"
#include "statics/sliding_interface.hpp"

namespace slipfront::statics {

namespace {

class CondensedLoadCase : public LoadCase {
 public:
  CondensedLoadCase(std::vector<double> gap_m, std::shared_ptr<const CondensedInterface> interface,
                    const TopDisplacement& top, const TopDisplacement& unit_motion)
      : gap_m_(std::move(gap_m)),
        interface_(std::move(interface)),
        load_(interface_->load(top)),
        unit_shear_(interface_->load(unit_motion)) {
    g0_N_ = interface_->relative_load(load_);
    g1_N_ = interface_->relative_load(unit_shear_);
  }

  void solve(const Support& support, double) override {
    const auto& S = interface_->stiffness();
    std::vector<Eigen::Index> unknown;  // degrees of freedom that are not held
    u0 = Eigen::VectorXd::Zero(S.rows());
    u1 = Eigen::VectorXd::Zero(S.rows());
    for (std::size_t k = 0; k < gap_m_.size(); ++k) {
      const auto x = static_cast<Eigen::Index>(2 * k);
      const auto contact = support.contact[k];
      if (contact == Contact::stick) u0(x) = support.anchor_x_m[k];
      if (contact == Contact::stick && !support.anchor_x_per_shear.empty())
        u1(x) = support.anchor_x_per_shear[k];
      if (contact != Contact::stick) unknown.push_back(x);
      if (contact != Contact::open) u0(x + 1) = -gap_m_[k];
      if (contact == Contact::open) unknown.push_back(x + 1);
    }
    if (!unknown.empty()) {
      const auto size = static_cast<Eigen::Index>(unknown.size());
      Eigen::MatrixXd A(size, size);
      Eigen::MatrixXd rhs(size, 2);
      for (Eigen::Index r = 0; r < size; ++r) {
        // An open node carries no force; a slipping one obeys f_x = -sign mu_s f_y.
        const auto d = unknown[r];
        const double mu = d % 2 == 0 ? support.slip_sign[d / 2] * support.mu_s[d / 2] : 0.0;
        Eigen::RowVectorXd row = S.row(d);
        double g0 = g0_N_(d), g1 = g1_N_(d);
        if (support.contact[d / 2] == Contact::slip) {
          row += mu * S.row(d + 1);
          g0 += mu * g0_N_(d + 1);
          g1 += mu * g1_N_(d + 1);
        }
        for (Eigen::Index c = 0; c < size; ++c) A(r, c) = row(unknown[c]);
        rhs(r, 0) = g0 - row.dot(u0);
        rhs(r, 1) = g1 - row.dot(u1);
      }
      const Eigen::MatrixXd solution = A.partialPivLu().solve(rhs);
      for (Eigen::Index r = 0; r < size; ++r) {
        u0(unknown[r]) = solution(r, 0);
        u1(unknown[r]) = solution(r, 1);
      }
    }
    f0 = S * u0 - g0_N_;
    f1 = S * u1 - g1_N_;
  }

  Displacement displacement(double shear) const override {
    auto load = load_;
    load.top.add(shear, unit_shear_.top);
    load.g_N += shear * unit_shear_.g_N;
    return interface_->displacement(load, u0 + shear * u1);
  }
  Displacement displacement_per_shear() const override { return interface_->displacement(unit_shear_, u1); }

 private:
  std::vector<double> gap_m_;
  std::shared_ptr<const CondensedInterface> interface_;
  Factorisation::Load load_;        ///< the loaded edge where it stands without shear
  Factorisation::Load unit_shear_;  ///< the loaded edge moved on by 1 m
  Eigen::VectorXd g0_N_, g1_N_;     ///< what the two send to the interface
};

class DirectSolver : public PlateSolver {
 public:
  DirectSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base)
      : mesh_(plate.mesh),
        material_(plate.material),
        machine_(plate.machine),
        boundary_(boundary::make_boundary(mesh_, machine_)),
        gap_m_(gaps_m(mesh_, base ? &base->mesh : nullptr)),
        held_plate_(std::make_shared<Factorisation>(plate, constraint_under_shear(boundary_))) {
    if (base) base_ = std::make_shared<Factorisation>(*base, TopConstraint::both);
    held_ = std::make_shared<CondensedInterface>(held_plate_, base_);
  }

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, EdgeMotion motion,
                                      const DisplacementOfBodies*, int) override {
    auto interface = held_;
    if (constraint != constraint_under_shear(boundary_))
      interface = std::make_shared<CondensedInterface>(
          std::make_shared<Factorisation>(ElasticBody{mesh_, material_, machine_}, constraint), base_);
    return std::make_unique<CondensedLoadCase>(gap_m_, std::move(interface), top,
                                               unit_motion(mesh_, boundary_, motion));
  }
  std::unique_ptr<SlidingInterface> sliding(const TopDisplacement& top,
                                            const std::vector<Contact>& contact) const override {
    const auto unit = unit_motion(mesh_, boundary_, EdgeMotion::along_x);
    return held_->sliding(held_->load(top), held_->load(unit), gap_m_, mesh::tributary_lengths_m(mesh_),
                          contact);
  }
  std::int64_t n_unknowns() const override {
    return held_plate_->n_unknowns() + (base_ ? base_->n_unknowns() : 0);
  }
  double bytes() const override { return held_plate_->factor_bytes() + (base_ ? base_->factor_bytes() : 0); }
  std::vector<std::size_t> interface_of(int) const override {
    std::vector<std::size_t> all(mesh_.interface_nodes.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

 private:
  const mesh::Mesh& mesh_;
  solid::Material material_;
  boundary::Machine machine_;
  boundary::Boundary boundary_;
  std::vector<double> gap_m_;
  // Held as under shear.
  std::shared_ptr<const Factorisation> held_plate_, base_;
  std::shared_ptr<const CondensedInterface> held_;
};

void require_base_fits(const mesh::Mesh& plate, const mesh::Mesh& base) {
  SLIPFRONT_ASSERT(!base.far_edge_nodes.empty(), "a base that nothing holds cannot be in equilibrium");
  SLIPFRONT_ASSERT(base.interface_nodes.size() == plate.interface_nodes.size(),
                   "interfaces of different nodes");
  const double width_m = plate.x_m[plate.interface_nodes.back()] - plate.x_m[plate.interface_nodes.front()];
  for (std::size_t k = 0; k < plate.interface_nodes.size(); ++k)
    SLIPFRONT_ASSERT(
        std::abs(base.x_m[base.interface_nodes[k]] - plate.x_m[plate.interface_nodes[k]]) <= 1e-9 * width_m,
        "interface nodes that do not face each other");
}

Shape shape_of(const mesh::Mesh& mesh) {
  return {static_cast<double>(mesh.grid.columns), static_cast<double>(mesh.grid.rows), !mesh.coarser.empty()};
}

}  // namespace

std::unique_ptr<SlidingInterface> PlateSolver::sliding(const TopDisplacement&,
                                                       const std::vector<Contact>&) const {
  SLIPFRONT_ASSERT(false, "only a factorisation condenses the interface");
  return nullptr;
}

void TopDisplacement::add(double share, const TopDisplacement& more) {
  for (const auto of : {&TopDisplacement::u_x_m, &TopDisplacement::u_y_m, &TopDisplacement::pushed_u_x_m})
    for (std::size_t k = 0; k < (this->*of).size(); ++k) (this->*of)[k] += share * (more.*of)[k];
}

TopDisplacement unit_motion(const mesh::Mesh& mesh, const boundary::Boundary& boundary, EdgeMotion motion) {
  const std::size_t n = mesh.far_edge_nodes.size();
  const bool is_along_x = motion == EdgeMotion::along_x, is_pushed = !boundary.pushed.empty();
  return {std::vector<double>(n, is_along_x && !is_pushed ? 1.0 : 0.0),
          std::vector<double>(n, motion == EdgeMotion::down ? -1.0 : 0.0),
          std::vector<double>(boundary.pushed.size(), is_along_x ? 1.0 : 0.0)};
}

std::vector<double> gaps_m(const mesh::Mesh& plate, const mesh::Mesh* base) {
  std::vector<double> gap_m;
  for (const auto n : plate.interface_nodes) gap_m.push_back(plate.y_m[n]);
  for (std::size_t k = 0; base != nullptr && k < gap_m.size(); ++k)
    gap_m[k] += base->y_m[base->interface_nodes[k]];
  return gap_m;
}

StaticSolver choose_solver(StaticSolver wanted, double n_unknowns) {
  if (wanted != StaticSolver::automatic) return wanted;
  return n_unknowns <= max_direct_unknowns ? StaticSolver::direct : StaticSolver::iterative;
}

StaticSolver solver_for_shapes(StaticSolver wanted, const Shape& plate, const std::optional<Shape>& base) {
  if (plate.is_graded || (base && base->is_graded)) return StaticSolver::direct;
  if (wanted != StaticSolver::automatic) return wanted;
  const double rows = plate.rows + (base ? base->rows : 0);
  if (rows > max_iterative_slenderness * plate.columns) return StaticSolver::direct;
  if (plate.columns > max_direct_columns) return StaticSolver::iterative;
  const auto [thinner, thicker] = std::minmax(plate.rows, base ? base->rows : plate.rows);
  return thicker > max_iterative_height_ratio * thinner ? StaticSolver::direct : wanted;
}

std::string_view name_of(StaticSolver solver) {
  if (solver == StaticSolver::automatic) return "auto";
  return solver == StaticSolver::direct ? "direct" : "iterative";
}

std::unique_ptr<PlateSolver> make_plate_solver(const ElasticBody& plate, StaticSolver solver,
                                               const std::optional<ElasticBody>& base) {
  const auto& mesh = plate.mesh;
  if (base) require_base_fits(mesh, base->mesh);
  std::optional<Shape> shape_of_base;
  if (base) shape_of_base = shape_of(base->mesh);
  solver = solver_for_shapes(solver, shape_of(mesh), shape_of_base);
  double n_unknowns = 2.0 * mesh.n_nodes();
  if (base) n_unknowns += 2.0 * base->mesh.n_nodes();
  if (!plate.machine.prescribes_far_edge() || choose_solver(solver, n_unknowns) == StaticSolver::direct)
    return std::make_unique<DirectSolver>(plate, base);
  return std::make_unique<IterativeSolver>(plate, base);
}

}  // namespace slipfront::statics
