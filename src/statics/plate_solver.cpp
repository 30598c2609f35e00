// SPDX-License-Identifier: BSD-3-Clause
#include "statics/plate_solver.hpp"

#include <numeric>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "statics/factorisation.hpp"
#include "statics/iterative.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

namespace {

/// On the condensed stiffness of a factorised plate.
class CondensedLoadCase : public LoadCase {
 public:
  CondensedLoadCase(const mesh::Mesh& mesh, std::shared_ptr<const Factorisation> plate,
                    const TopDisplacement& top, bool sheared)
      : mesh_(mesh), plate_(std::move(plate)), load_(plate_->load(top)) {
    const auto n = mesh.top.size();
    unit_shear_ = {{std::vector<double>(n, sheared ? 1.0 : 0.0), std::vector<double>(n, 0.0)},
                   Eigen::VectorXd::Zero(load_.g_N.size())};
    if (sheared) unit_shear_ = plate_->load(unit_shear_.top);
  }

  void solve(const Support& support, double) override {
    const auto& S = plate_->condensed_stiffness();
    const auto& load0 = load_.g_N;
    const auto& load1 = unit_shear_.g_N;
    std::vector<Eigen::Index> unknown;  // degrees of freedom that are not held
    u0 = Eigen::VectorXd::Zero(S.rows());
    u1 = Eigen::VectorXd::Zero(S.rows());
    for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
      const auto x = static_cast<Eigen::Index>(2 * k);
      const auto contact = support.contact[k];
      if (contact == Contact::stick) u0(x) = support.anchor_x_m[k];
      if (contact != Contact::stick) unknown.push_back(x);
      if (contact != Contact::open) u0(x + 1) = -mesh_.y_m[mesh_.lower[k]];
      if (contact == Contact::open) unknown.push_back(x + 1);
    }
    if (!unknown.empty()) {
      const auto size = static_cast<Eigen::Index>(unknown.size());
      Eigen::MatrixXd A(size, size);
      Eigen::MatrixXd rhs(size, 2);
      for (Eigen::Index r = 0; r < size; ++r) {
        // An open node carries no force; a slipping one obeys f_x = -sign mu_s f_y.
        const auto d = unknown[r];
        const double mu = d % 2 == 0 ? support.slip_sign[d / 2] * support.mu_s : 0.0;
        Eigen::RowVectorXd row = S.row(d);
        double g0 = load0(d), g1 = load1(d);
        if (support.contact[d / 2] == Contact::slip) {
          row += mu * S.row(d + 1);
          g0 += mu * load0(d + 1);
          g1 += mu * load1(d + 1);
        }
        for (Eigen::Index c = 0; c < size; ++c) A(r, c) = row(unknown[c]);
        rhs(r, 0) = g0 - row.dot(u0);
        rhs(r, 1) = g1;
      }
      const Eigen::MatrixXd solution = A.partialPivLu().solve(rhs);
      for (Eigen::Index r = 0; r < size; ++r) {
        u0(unknown[r]) = solution(r, 0);
        u1(unknown[r]) = solution(r, 1);
      }
    }
    f0 = S * u0 - load0;
    f1 = S * u1 - load1;
  }

  solid::Field displacement(double shear) const override {
    auto load = load_;
    for (std::size_t k = 0; k < load.top.u_x_m.size(); ++k)
      load.top.u_x_m[k] += shear * unit_shear_.top.u_x_m[k];
    load.g_N += shear * unit_shear_.g_N;
    return plate_->displacement(load, u0 + shear * u1);
  }
  void begin_from(const LoadCase&) override {}
  solid::Field displacement_per_shear() const override { return plate_->displacement(unit_shear_, u1); }

 private:
  const mesh::Mesh& mesh_;
  std::shared_ptr<const Factorisation> plate_;
  Factorisation::Load load_;        ///< the loaded edge where it stands without shear
  Factorisation::Load unit_shear_;  ///< the loaded edge moved by 1 m along x
};

class DirectSolver : public PlateSolver {
 public:
  DirectSolver(const mesh::Mesh& mesh, const solid::Material& material)
      : mesh_(mesh),
        material_(material),
        held_(std::make_shared<Factorisation>(mesh, material, TopConstraint::both)) {}

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, bool sheared,
                                      const solid::Field*, int) override {
    auto plate = held_;
    if (constraint == TopConstraint::vertical)
      plate = std::make_shared<Factorisation>(mesh_, material_, constraint);
    return std::make_unique<CondensedLoadCase>(mesh_, std::move(plate), top, sheared);
  }
  std::int64_t n_unknowns() const override { return held_->n_unknowns(); }
  double bytes() const override { return held_->factor_bytes(); }
  bool iterates() const override { return false; }
  int n_cycles() const override { return 0; }
  int n_levels() const override { return 1; }
  std::vector<std::size_t> interface_of(int) const override {
    std::vector<std::size_t> all(mesh_.lower.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

 private:
  const mesh::Mesh& mesh_;
  solid::Material material_;
  std::shared_ptr<Factorisation> held_;  ///< both displacements of the loaded edge prescribed
};

}  // namespace

StaticSolver choose_solver(StaticSolver wanted, double n_unknowns) {
  if (wanted != StaticSolver::automatic) return wanted;
  return n_unknowns <= most_direct_unknowns ? StaticSolver::direct : StaticSolver::iterative;
}

StaticSolver solver_for_shape(StaticSolver wanted, bool is_graded, double columns, double rows) {
  if (is_graded) return StaticSolver::direct;
  if (wanted != StaticSolver::automatic) return wanted;
  if (rows > most_iterative_slenderness * columns) return StaticSolver::direct;
  return columns > most_direct_columns ? StaticSolver::iterative : wanted;
}

std::string_view name_of(StaticSolver solver) {
  if (solver == StaticSolver::automatic) return "auto";
  return solver == StaticSolver::direct ? "direct" : "iterative";
}

double statics_bytes(StaticSolver solver, double n_unknowns) {
  if (choose_solver(solver, n_unknowns) == StaticSolver::direct)
    return statics_bytes(n_unknowns, estimated_factor_bytes(n_unknowns));
  return iterative_bytes(n_unknowns);
}

void require_statics_memory(StaticSolver solver, double n_unknowns) {
  if (choose_solver(solver, n_unknowns) == StaticSolver::direct) {
    require_statics_memory(n_unknowns, estimated_factor_bytes(n_unknowns));
  } else {
    require_memory(iterative_bytes(n_unknowns),
                   fmt::format("the iterative solution of {:.4g} static unknowns", n_unknowns),
                   "choose a larger plate.element_size_m");
  }
}

std::unique_ptr<PlateSolver> make_plate_solver(const mesh::Mesh& mesh, const solid::Material& material,
                                               StaticSolver solver) {
  solver = solver_for_shape(solver, !mesh.coarser.empty(), mesh.grid.columns, mesh.grid.rows);
  require_statics_memory(solver, 2.0 * mesh.n_nodes());
  if (choose_solver(solver, 2.0 * mesh.n_nodes()) == StaticSolver::direct)
    return std::make_unique<DirectSolver>(mesh, material);
  return std::make_unique<IterativeSolver>(mesh, material);
}

}  // namespace slipfront::statics
