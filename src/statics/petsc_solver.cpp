// SPDX-License-Identifier: BSD-3-Clause
#include "statics/petsc_solver.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "processes/answers.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

namespace {

void put_support(const Support& support, MessageBuffer& to) {
  to.put(support.contact).put(support.slip_sign).put(support.anchor_x_m).put(support.mu_s);
}

Support take_support(MessageBuffer& from) {
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
  PetscLoadCase(PetscSolver& solver, TopConstraint constraint, const TopDisplacement& top, EdgeMotion motion,
                const DisplacementOfBodies* start)
      : solver_(solver), is_sheared_(motion == EdgeMotion::along_x) {
    const auto& loaded = solver.loaded_;
    MessageBuffer given;
    given.put(constraint).put(motion).put(start != nullptr ? start->kept : -1);
    given.put(loaded.from_m).put(loaded.to_m - loaded.from_m).put(loaded.y_m);
    given.put(top.u_x_m).put(top.u_y_m);
    solver.ask(PetscSolver::Command::begin, [&](int) { return given; });
  }

  void solve(const Support& support, double accuracy) override {
    MessageBuffer given;
    put_support(support, given);
    given.put(accuracy);
    const auto n = static_cast<Eigen::Index>(2 * solver_.plate_.interface_nodes.size());
    for (auto* values : {&u0, &u1, &f0, &f1}) *values = Eigen::VectorXd::Zero(n);
    bool converges = true;
    solver_.ask(
        PetscSolver::Command::solve, [&](int) { return given; },
        [&](int subdomain, MessageBuffer& answer) {
          converges &= answer.take<std::uint8_t>() != 0;
          if (!converges) return;
          const auto& lower = solver_.interface_nodes_[static_cast<std::size_t>(subdomain)];
          for (auto* values : {&u0, &u1, &f0, &f1}) {
            const auto of_subdomain = answer.take_all<double>();
            for (std::size_t k = 0; k < of_subdomain.size(); ++k)
              (*values)(2 * lower[k / 2] + static_cast<Eigen::Index>(k % 2)) = of_subdomain[k];
          }
        });
    if (!converges)
      throw UserError("the static solution by PETSc does not converge; set {} = direct",
                      Key("loading.solver"));
  }

  Displacement displacement(double shear) const override { return kept(1, shear); }
  Displacement displacement_per_shear() const override { return kept(0, 1); }
  void begin_from(const LoadCase&) override {}

 private:
  /// factor_0 u0 + factor_1 u1
  Displacement kept(double factor_0, double factor_1) const {
    int number = -1;
    solver_.ask(
        PetscSolver::Command::keep,
        [&](int) { return std::move(MessageBuffer().put(factor_0).put(factor_1)); },
        [&](int rank, MessageBuffer& answer) {
          const int of_process = answer.take<int>();
          SLIPFRONT_ASSERT(rank == 0 || of_process == number, "the same number in all processes");
          number = of_process;
        });
    if (!solver_.gathers_) return {{}, {}, DistributedField{number, solver_.divided_.partition()}};
    std::vector<double> all;
    solver_.ask(
        PetscSolver::Command::gather, [&](int) { return std::move(MessageBuffer().put(number)); },
        [&](int, MessageBuffer& answer) {
          const auto of_subdomain = answer.take_all<double>();
          answer = {};
          all.insert(all.end(), of_subdomain.begin(), of_subdomain.end());
        });
    auto u = solver_.divided_.displacement(all);
    // The sheared plate begins from the tilted one; nothing from the sheared one.
    if (is_sheared_)
      solver_.ask(PetscSolver::Command::forget, [&](int) { return std::move(MessageBuffer().put(number)); });
    else
      u.kept = {number, solver_.divided_.partition()};
    return u;
  }

  PetscSolver& solver_;
  bool is_sheared_;
};

void PetscSubdomain::build(const Subdomain& subdomain) {
  kept_.clear();  // of another solver's subdomains
  equations_ = std::make_unique<PetscEquations>(subdomain);
  first_ = subdomain.first;
  top_ = subdomain.top;
  x_m_.assign(static_cast<std::size_t>(subdomain.count), 0.0);
  y_m_ = x_m_;
  for (const auto& node : subdomain.bodies.front().nodes)
    if (subdomain.has(node.pair)) {
      x_m_[node.pair - first_] = node.x_m;
      y_m_[node.pair - first_] = node.y_m;
    }
}

/// Begins at displacements that are kept, or at uniform strain from the interface to the loaded edge, whose
/// nodes have the same places along x; a base at rest.
void PetscSubdomain::begin(MessageBuffer& given) {
  const auto constraint = given.take<TopConstraint>();
  const auto motion = given.take<EdgeMotion>();
  const bool moves_on = motion != EdgeMotion::none;
  const int start = given.take<int>();
  const auto x0_m = given.take<double>(), width_m = given.take<double>(), height_m = given.take<double>();
  const auto u_x_m = given.take_all<double>(), u_y_m = given.take_all<double>();
  const std::size_t n = x_m_.size();
  std::vector<double> u0 = start >= 0 ? kept_.own(start) : std::vector<double>(2 * n, 0.0);
  std::vector<double> u1(moves_on ? 2 * n : 0, 0.0);
  const auto last = static_cast<double>(u_y_m.size() - 1);
  for (std::size_t k = 0; k < n; ++k) {
    const double share_of_height = y_m_[k] / height_m;
    if (motion == EdgeMotion::along_x) u1[2 * k] = share_of_height;
    if (motion == EdgeMotion::down) u1[2 * k + 1] = -share_of_height;
    if (start >= 0) continue;
    const auto above =
        static_cast<std::size_t>(std::clamp(std::round((x_m_[k] - x0_m) / width_m * last), 0.0, last));
    if (constraint == TopConstraint::both) u0[2 * k] = share_of_height * u_x_m[above];
    u0[2 * k + 1] = share_of_height * u_y_m[above];
  }
  for (const auto& [pair, place] : top_) {
    const auto at = 2 * static_cast<std::size_t>(pair - first_);
    if (constraint == TopConstraint::both) u0[at] = u_x_m[place];
    u0[at + 1] = u_y_m[place];
    if (motion == EdgeMotion::along_x) u1[at] = 1;
    if (motion == EdgeMotion::down) u1[at + 1] = -1;
  }
  equations_->begin(constraint, u0, u1);
}

MessageBuffer PetscSubdomain::execute(Command command, MessageBuffer& given) {
  MessageBuffer answer;
  switch (command) {
    case Command::build: {
      const bool is_planned = given.take<bool>();
      const auto subdomain = is_planned ? SubdomainPlan::take(given).make() : Subdomain::take(given);
      given = {};
      build(subdomain);
      answer.put(subdomain.interface_nodes);
      break;
    }
    case Command::begin:
      begin(given);
      break;
    case Command::solve: {
      const auto support = take_support(given);
      const auto at = equations_->solve(support, given.take<double>());
      answer.put(static_cast<std::uint8_t>(at.has_value()));
      if (at) answer.put(at->u0).put(at->u1).put(at->f0).put(at->f1);
      break;
    }
    case Command::keep: {
      auto u = equations_->own_u0();
      const auto u1 = equations_->own_u1();
      const auto factor_0 = given.take<double>(), factor_1 = given.take<double>();
      for (std::size_t k = 0; k < u.size(); ++k) u[k] = factor_0 * u[k] + factor_1 * u1[k];
      answer.put(kept_.add(std::move(u)));
      break;
    }
    case Command::gather:
      answer.put(kept_.own(given.take<int>()));
      break;
    case Command::forget:
      kept_.forget(given.take<int>());
      break;
    case Command::drop:
      equations_.reset();
      break;
    case Command::release:
      SLIPFRONT_ASSERT(false, "a command of serve_statics");
  }
  return answer;
}

PetscSolver::Edge PetscSolver::loaded_edge(const mesh::Mesh& plate, std::span<const mesh::Plate> plates) {
  const auto between = [](const mesh::Mesh& mesh, mesh::Node first, mesh::Node last) {
    return Edge{mesh.x_m[first], mesh.x_m[last], mesh.y_m[first]};
  };
  if (!plate.is_interface()) return between(plate, plate.far_edge_nodes.front(), plate.far_edge_nodes.back());
  const auto row = mesh::make_rows(plates.front(), plate.grid.rows, plate.grid.rows);
  return between(row, 0, row.n_nodes() - 1);
}

PetscSolver::PetscSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                         const SharedBy& shared)
    : plate_(plate.mesh),
      divided_(plate, base, shared.processes != nullptr ? shared.processes->size() : 1, shared.plates),
      processes_(shared.processes),
      gathers_(shared.kept == nullptr),
      share_(shared.kept != nullptr ? *shared.kept : own_kept_),
      loaded_(loaded_edge(plate.mesh, shared.plates)) {
  std::int64_t n_prescribed = std::ssize(loaded_nodes(plate.mesh));
  if (base) n_prescribed += std::ssize(loaded_nodes(base->mesh));
  n_unknowns_ = 2 * (static_cast<std::int64_t>(divided_.n_pairs()) - n_prescribed);
  ask(
      Command::build,
      [&](int rank) {
        MessageBuffer buffer;
        buffer.put(!divided_.are_held());
        if (divided_.are_held())
          divided_.subdomain(rank).put(buffer);
        else
          divided_.plan(rank).put(buffer);
        return buffer;
      },
      [&](int, MessageBuffer& answer) {
        auto& places = interface_nodes_.emplace_back();
        for (const auto& place : answer.take_all<Subdomain::Place>()) places.push_back(place.place);
      });
}

// PETSc's objects go at the same time everywhere.
PetscSolver::~PetscSolver() {
  ask(Command::drop, [](int) { return MessageBuffer(); });
}

std::unique_ptr<LoadCase> PetscSolver::load_case(TopConstraint constraint, const TopDisplacement& top,
                                                 EdgeMotion motion, const DisplacementOfBodies* start, int) {
  return std::make_unique<PetscLoadCase>(*this, constraint, top, motion, start);
}

double PetscSolver::bytes() const {
  // Measured of two processes over 9e4 to 1.6e6 unknowns; one takes 950.
  return 1300 * static_cast<double>(n_unknowns_);
}

std::vector<std::size_t> PetscSolver::interface_of(int) const {
  std::vector<std::size_t> all(plate_.interface_nodes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

void PetscSolver::ask(Command command, const std::function<MessageBuffer(int rank)>& given,
                      const std::function<void(int rank, MessageBuffer& answer)>& take) {
  const auto own = [&] {
    auto buffer = given(0);
    auto answer = share_.execute(command, buffer);
    take(0, answer);
  };
  if (processes_ == nullptr) return own();
  or_fail(*processes_, [&] {
    for (int rank = 1; rank < processes_->size(); ++rank)
      processes_->send(rank, MessageBuffer().put(command).append(given(rank)));
    own();
    for (int rank = 1; rank < processes_->size(); ++rank) {
      auto answer = processes_->receive(rank);
      take(rank, answer);
    }
  });
}

void serve_statics(Processes& processes, DistributedFields& kept) try {
  PetscSubdomain share(kept);
  for (;;) {
    auto given = processes.receive(0);
    const auto command = given.take<PetscSubdomain::Command>();
    if (command == PetscSubdomain::Command::release) return;
    processes.send(0, share.execute(command, given));
  }
} catch (const std::exception& error) {
  processes.fail(reason_of(error));
}

void release_statics(Processes& processes) {
  for (int rank = 1; rank < processes.size(); ++rank)
    processes.send(rank, MessageBuffer().put(PetscSubdomain::Command::release));
}

}  // namespace slipfront::statics
