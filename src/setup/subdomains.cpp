// SPDX-License-Identifier: BSD-3-Clause
#include "setup/subdomains.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "mesh/plate.hpp"
#include "problem/contact.hpp"

namespace slipfront::setup {

namespace {

/// What a rank needs to make its subdomain.
struct Plan {
  motion::Decomposition whole;
  int threads = 1;
  std::vector<motion::BodySteps> steps;  ///< of the bodies
  std::vector<double> whole_x_m;         ///< of the whole interface: friction along x is read at its nodes
  std::vector<motion::Probe> probes;
  double tip_slip_rate_m_per_s = 0;  ///< by the tractions, which rank 0 alone has

  template <class Archive>
  void serialize(Archive& archive) {
    archive(whole, threads, steps, whole_x_m, probes, tip_slip_rate_m_per_s);
  }
};

/// Some columns of the bodies, for a stepper.
class Columns {
 public:
  /// @param own    of them, those that count
  /// @param steps  of the bodies
  Columns(const Problem& problem, const mesh::Subset& all, int n_columns, solid::Span own,
          const std::vector<motion::BodySteps>& steps, const motion::MaxOverSubdomains& largest)
      : plate(mesh::make_columns(problem.above().plate, all)) {
    if (problem.has_below()) base = mesh::make_columns(problem.below().plate, all);
    for (const auto& of_body : steps) parts_.push_back({all, n_columns, own, of_body, largest});
    sources_.push_back({plate, problem.above().material, &parts_.front(), nullptr, problem.above().machine});
    if (base) sources_.push_back({*base, problem.below().material, &parts_.back()});
  }
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  std::span<const motion::BodySource> sources() const { return sources_; }

  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;

 private:
  std::vector<motion::BodySubdomain> parts_;
  std::vector<motion::BodySource> sources_;
};

}  // namespace

GlobalBodies::GlobalBodies(const Problem& problem, const mesh::Mesh& plate,
                           const std::optional<mesh::Mesh>& base)
    : problem_(problem) {
  if (plate.is_interface() && problem.above().plate.corner == mesh::Corner::relief)
    corners_ = mesh::make_corners(problem.above().plate, solid::rings_around_others);
  bodies_.push_back(
      {plate, problem.above().material, nullptr, corners_ ? &*corners_ : nullptr, problem.above().machine});
  if (base) bodies_.push_back({*base, problem.below().material});
}

std::vector<motion::BodySteps> GlobalBodies::steps() const {
  std::vector<motion::BodySteps> steps;
  for (const auto& body : bodies_) steps.push_back(motion::body_steps(body, problem_.time));
  return steps;
}

motion::Partition GlobalBodies::divided(int n_processes, std::span<const motion::BodySteps> steps) const {
  return motion::partition_bodies(bodies_, steps, problem_.time, n_processes);
}

void require_divisible(const Problem& problem, const Processes& processes) {
  const auto meshes = check(problem, processes);
  const GlobalBodies whole(problem, meshes.plate, meshes.base);
  whole.divided(processes.size(), whole.steps());
}

IsolatedSubdomain make_isolated_subdomain(const Problem& problem, const mesh::Mesh& interface,
                                          const std::vector<motion::BodySteps>& steps, solid::Span columns) {
  const mesh::Subset all({columns});
  Columns some(problem, all, interface.grid.stride(), columns, steps, [](std::span<double>) {});
  const auto contact =
      contact_model(problem, mesh::interface_x_m(interface), {}, motion::interface_nodes_in(interface, all));
  auto stepper =
      std::make_unique<motion::Stepper>(some.sources(), contact, problem.time, motion::Execution{});
  return {std::move(some.plate), std::move(some.base), std::move(stepper)};
}

std::unique_ptr<motion::DistributedStepper> new_distributed_stepper(const Problem& problem,
                                                                    InitialState& initial,
                                                                    Processes& processes,
                                                                    const motion::Execution& execution) {
  auto message = processes.from_root([&](MessageBuffer& to) {
    const GlobalBodies bodies(problem, initial.mesh, initial.base);
    std::vector<const mesh::Mesh*> meshes;
    for (const auto& body : bodies.bodies()) meshes.push_back(&body.mesh);
    Plan plan;
    plan.steps = bodies.steps();
    plan.whole = motion::decomposition_of(bodies.divided(processes.size(), plan.steps), meshes);
    plan.threads = execution.threads;
    plan.whole_x_m = mesh::interface_x_m(initial.mesh);
    plan.probes = probes_of(problem, initial.mesh, initial.base);
    if (problem.friction.law.never_sticks()) plan.tip_slip_rate_m_per_s = tip_slip_rate_m_per_s(problem);
    to.append(packed(plan, initial.mesh.grid, initial));
  });
  const auto plan = unpacked<Plan>(message);
  if (!processes.is_root()) MessageArchive::reader(message)(initial.mesh.grid, initial);
  const auto rank = processes.rank();
  const auto& partition = plan.whole.partition;
  const Columns own(problem, partition.all(rank), partition.n_columns(), partition.own(rank), plan.steps,
                    [&](std::span<double> values) { processes.reduce_max(values); });
  auto contact = contact_model(problem, plan.whole_x_m, initial.healed,
                               plan.whole.interface_nodes[static_cast<std::size_t>(rank)]);
  contact.tip_slip_rate_m_per_s = plan.tip_slip_rate_m_per_s;
  auto stepper =
      std::make_unique<motion::DistributedStepper>(processes, plan.whole, own.sources(), contact,
                                                   problem.time, motion::Execution{.threads = plan.threads});
  stepper->set_probes(plan.probes);
  return stepper;
}

}  // namespace slipfront::setup
