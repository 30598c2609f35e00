// SPDX-License-Identifier: BSD-3-Clause
#include "statics/petsc_solver.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

namespace {

void put_support(const Support& support, Parcel& to) {
  to.put(support.contact).put(support.slip_sign).put(support.anchor_x_m).put(support.mu_s);
}

Support take_support(Parcel& from) {
  Support support;
  support.contact = from.take_all<Contact>();
  support.slip_sign = from.take_all<double>();
  support.anchor_x_m = from.take_all<double>();
  support.mu_s = from.take_all<double>();
  return support;
}

}  // namespace

class PetscLoadCase : public LoadCase {
 public:
  PetscLoadCase(PetscSolver& solver, TopConstraint constraint, const TopDisplacement& top, bool sheared,
                const DisplacementOfBodies* start)
      : solver_(solver) {
    const auto& plate = solver.plate_;
    const auto at_start = unknowns(start != nullptr ? *start : DisplacementOfBodies{}, [&](solid::Field& u) {
      if (start == nullptr) set_uniform_strain(constraint, top, u);
      for (std::size_t k = 0; k < plate.top.size(); ++k) {
        if (constraint == TopConstraint::both) u.x[plate.top[k]] = top.u_x_m[k];
        u.y[plate.top[k]] = top.u_y_m[k];
      }
    });
    std::vector<double> per_shear;
    if (sheared)
      per_shear = unknowns({}, [&](solid::Field& u) {
        for (mesh::Node n = 0; n < plate.n_nodes(); ++n) u.x[n] = share_of_height(n);
        for (const auto n : plate.top) u.x[n] = 1;
      });
    std::vector<Parcel> given;
    for (int k = 0; k < solver.divided_.n_pieces(); ++k) {
      Parcel parcel;
      parcel.put(constraint).put(solver.divided_.of_piece(at_start, k));
      parcel.put(sheared ? solver.divided_.of_piece(per_shear, k) : per_shear);
      given.push_back(std::move(parcel));
    }
    solver.ask(PetscSolver::Command::begin, std::move(given));
  }

  void solve(const Support& support, double accuracy) override {
    Parcel given;
    put_support(support, given);
    given.put(accuracy);
    auto answers = solver_.ask(PetscSolver::Command::solve, {std::move(given)});
    const auto n = static_cast<Eigen::Index>(2 * solver_.plate_.lower.size());
    for (auto* values : {&u0, &u1, &f0, &f1}) *values = Eigen::VectorXd::Zero(n);
    for (std::size_t piece = 0; piece < answers.size(); ++piece) {
      if (answers[piece].take<std::uint8_t>() == 0)
        throw UserError("the static solution by PETSc does not converge; set {} = direct",
                        Key("loading.solver"));
      for (auto* values : {&u0, &u1, &f0, &f1}) {
        const auto of_piece = answers[piece].take_all<double>();
        for (std::size_t k = 0; k < of_piece.size(); ++k)
          (*values)(2 * solver_.lower_[piece][k / 2] + static_cast<Eigen::Index>(k % 2)) = of_piece[k];
      }
    }
  }

  Displacement displacement(double shear) const override { return gathered(1, shear); }
  Displacement displacement_per_shear() const override { return gathered(0, 1); }
  void begin_from(const LoadCase&) override {}

 private:
  double share_of_height(mesh::Node n) const {
    const auto& plate = solver_.plate_;
    return plate.y_m[n] / plate.y_m[plate.top.front()];
  }

  /// From the interface to the loaded edge, whose nodes have the same places along x.
  void set_uniform_strain(TopConstraint constraint, const TopDisplacement& top, solid::Field& u) const {
    const auto& plate = solver_.plate_;
    const double x0 = plate.x_m[plate.top.front()], width = plate.x_m[plate.top.back()] - x0;
    const auto last = static_cast<double>(plate.top.size() - 1);
    for (mesh::Node n = 0; n < plate.n_nodes(); ++n) {
      const auto k =
          static_cast<std::size_t>(std::clamp(std::round((plate.x_m[n] - x0) / width * last), 0.0, last));
      if (constraint == TopConstraint::both) u.x[n] = share_of_height(n) * top.u_x_m[k];
      u.y[n] = share_of_height(n) * top.u_y_m[k];
    }
  }

  /// Of the bodies' displacement, none where there is none yet, with that of the plate changed.
  template <class Change>
  std::vector<double> unknowns(const DisplacementOfBodies& start, Change&& change) const {
    auto above = start.above != nullptr ? *start.above
                                        : solid::Field(static_cast<std::size_t>(solver_.plate_.n_nodes()));
    change(above);
    if (solver_.base_ == nullptr) return solver_.divided_.unknowns({&above});
    const auto below = start.below != nullptr
                           ? *start.below
                           : solid::Field(static_cast<std::size_t>(solver_.base_->n_nodes()));
    return solver_.divided_.unknowns({&above, &below});
  }

  /// factor_0 u0 + factor_1 u1
  Displacement gathered(double factor_0, double factor_1) const {
    std::vector<double> all;
    for (auto& answer : solver_.ask(PetscSolver::Command::displacements,
                                    {std::move(Parcel().put(factor_0).put(factor_1))})) {
      const auto of_piece = answer.take_all<double>();
      answer = {};
      all.insert(all.end(), of_piece.begin(), of_piece.end());
    }
    return solver_.divided_.displacement(all);
  }

  PetscSolver& solver_;
};

double petsc_bytes(double n_unknowns) {
  // Measured of two processes over 9e4 to 1.6e6 unknowns; one takes 950.
  return 1300 * n_unknowns;
}

double divided_bytes(double n_unknowns) {
  // Half of a node: numbers, pieces with their coordinates and cells, and one field on its way.
  return n_unknowns * (4 + 28 + 16);
}

PetscSolver::PetscSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                         Processes* processes)
    : plate_(plate.mesh),
      base_(base ? &base->mesh : nullptr),
      divided_(plate, base, processes != nullptr ? processes->size() : 1),
      processes_(processes) {
  std::size_t n_prescribed = plate.mesh.top.size() + (base ? base->mesh.top.size() : 0);
  n_unknowns_ = 2 * (static_cast<std::int64_t>(divided_.n_pairs()) - static_cast<std::int64_t>(n_prescribed));
  std::vector<Parcel> given;
  for (int k = 0; k < divided_.n_pieces(); ++k) {
    const auto piece = divided_.piece(k);
    auto& lower = lower_.emplace_back();
    for (const auto& place : piece.lower) lower.push_back(place.place);
    piece.put(given.emplace_back());
  }
  ask(Command::build, std::move(given));
}

// PETSc's objects go at the same time everywhere.
PetscSolver::~PetscSolver() {
  ask(Command::drop);
}

std::unique_ptr<LoadCase> PetscSolver::load_case(TopConstraint constraint, const TopDisplacement& top,
                                                 bool sheared, const DisplacementOfBodies* start, int) {
  return std::make_unique<PetscLoadCase>(*this, constraint, top, sheared, start);
}

double PetscSolver::bytes() const {
  return petsc_bytes(static_cast<double>(n_unknowns_));
}

std::vector<std::size_t> PetscSolver::interface_of(int) const {
  std::vector<std::size_t> all(plate_.lower.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

Parcel PetscSolver::carry_out(Command command, Parcel& given, std::unique_ptr<PetscEquations>& equations) {
  Parcel answer;
  switch (command) {
    case Command::build: {
      const auto piece = Piece::take(given);
      given = {};
      equations = std::make_unique<PetscEquations>(piece);
      break;
    }
    case Command::begin: {
      const auto constraint = given.take<TopConstraint>();
      const auto u0 = given.take_all<double>(), u1 = given.take_all<double>();
      equations->begin(constraint, u0, u1);
      break;
    }
    case Command::solve: {
      const auto support = take_support(given);
      const auto at = equations->solve(support, given.take<double>());
      answer.put(static_cast<std::uint8_t>(at.has_value()));
      if (at) answer.put(at->u0).put(at->u1).put(at->f0).put(at->f1);
      break;
    }
    case Command::displacements: {
      auto u = equations->own_u0();
      const auto u1 = equations->own_u1();
      const auto factor_0 = given.take<double>(), factor_1 = given.take<double>();
      for (std::size_t k = 0; k < u.size(); ++k) u[k] = factor_0 * u[k] + factor_1 * u1[k];
      answer.put(u);
      break;
    }
    case Command::drop:
      equations.reset();
      break;
    case Command::release:
      SLIPFRONT_ASSERT(false, "a command of serve_statics");
  }
  return answer;
}

std::vector<Parcel> PetscSolver::ask(Command command, std::vector<Parcel> given) {
  std::vector<Parcel> answers;
  if (processes_ == nullptr) {
    answers.push_back(carry_out(command, given.front(), equations_));
    return answers;
  }
  try {
    for (int rank = 1; rank < processes_->size(); ++rank) {
      auto& of_rank = given[given.size() == 1 ? 0 : static_cast<std::size_t>(rank)];
      processes_->send(rank, Parcel().put(command).append(of_rank));
      if (given.size() > 1) of_rank = {};
    }
    answers.push_back(carry_out(command, given.front(), equations_));
    for (int rank = 1; rank < processes_->size(); ++rank) answers.push_back(processes_->receive(rank));
  } catch (const std::exception& error) {
    processes_->fail(reason_of(error));  // the others wait for this process's share
  }
  return answers;
}

void serve_statics(Processes& processes) try {
  std::unique_ptr<PetscEquations> equations;
  for (;;) {
    auto given = processes.receive(0);
    const auto command = given.take<PetscSolver::Command>();
    if (command == PetscSolver::Command::release) return;
    processes.send(0, PetscSolver::carry_out(command, given, equations));
  }
} catch (const std::exception& error) {
  processes.fail(reason_of(error));
}

void release_statics(Processes& processes) {
  for (int rank = 1; rank < processes.size(); ++rank)
    processes.send(rank, Parcel().put(PetscSolver::Command::release));
}

}  // namespace slipfront::statics
