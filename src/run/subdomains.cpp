// SPDX-License-Identifier: BSD-3-Clause
#include "run/subdomains.hpp"

#include <csignal>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "input/friction_along_x.hpp"
#include "input/schema.hpp"
#include "mesh/plate.hpp"
#include "processes/answers.hpp"
#include "run/case_message.hpp"
#include "run/checkpoint.hpp"
#include "run/choices.hpp"
#include "run/fields.hpp"
#include "run/initial_state.hpp"
#include "run/run.hpp"
#include "statics/petsc_solver.hpp"

namespace slipfront::run {

namespace {

/// What a process needs to make its subdomain.
struct Plan {
  motion::Partition partition;
  int threads = 1;
  std::vector<motion::BodySteps> steps;  ///< of the bodies
  std::vector<double> whole_x_m;         ///< of the whole interface: friction along x is read at its nodes

  void put(MessageBuffer& to) const {
    to.put(partition.first).put(partition.halo).put(partition.columns_per_step);
    to.put(partition.steps_per_exchange).put(partition.is_ring);
    to.put(threads).put(static_cast<std::uint64_t>(steps.size()));
    for (const auto& of_body : steps) to.put(of_body.stable_step_s).put(of_body.multiples);
    to.put(whole_x_m);
  }
  static Plan take(MessageBuffer& from) {
    Plan plan;
    plan.partition.first = from.take_all<int>();
    plan.partition.halo = from.take<int>();
    plan.partition.columns_per_step = from.take<int>();
    plan.partition.steps_per_exchange = from.take<int>();
    plan.partition.is_ring = from.take<bool>();
    plan.threads = from.take<int>();
    for (auto n = from.take<std::uint64_t>(); n > 0; --n) {
      const auto stable_step_s = from.take<double>();
      plan.steps.push_back({stable_step_s, from.take_all<int>()});
    }
    plan.whole_x_m = from.take_all<double>();
    return plan;
  }
};

Plan plan_for(const GlobalBodies& whole, int n_processes) {
  Plan plan;
  plan.steps = whole.steps();
  plan.partition = whole.divided(n_processes, plan.steps);
  plan.whole_x_m = interface_x_m(whole.plate());
  return plan;
}

/// Places along the whole interface of a subdomain's nodes.
mesh::Subset lower_of(const GlobalBodies& whole, const Plan& plan, int rank) {
  return motion::interface_nodes_in(whole.plate(), plan.partition.all(rank));
}

interface::ContactModel contact_of(const input::Case& config, const std::vector<double>& whole_x_m,
                                   const mesh::Subset& interface_nodes) {
  auto contact = input::contact_model(config, whole_x_m);
  if (contact.of_nodes.empty()) return contact;
  std::vector<interface::FrictionLaw> laws;
  for (int k = 0; k < interface_nodes.count(); ++k)
    laws.push_back(contact.of_nodes[static_cast<std::size_t>(interface_nodes.number_at(k))]);
  contact.of_nodes = interface::NodeLaws(std::move(laws));
  return contact;
}

/// Some columns of the bodies, for a stepper.
class Columns {
 public:
  /// @param own    of them, those that count
  /// @param steps  of the bodies
  Columns(const input::Case& config, const mesh::Subset& all, int n_columns, solid::Span own,
          const std::vector<motion::BodySteps>& steps, const motion::MaxOverSubdomains& largest)
      : plate(mesh::make_columns(config.plate, all)), base_material_(input::base_material(config)) {
    if (input::has_base_body(config)) base = mesh::make_columns(input::base_plate(config), all);
    for (const auto& of_body : steps) parts_.push_back({all, n_columns, own, of_body, largest});
    sources_.push_back({plate, config.material, &parts_.front()});
    if (base) sources_.push_back({*base, base_material_, &parts_.back()});
  }
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  std::span<const motion::BodySource> sources() const { return sources_; }

  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;

 private:
  solid::Material base_material_;
  std::vector<motion::BodySubdomain> parts_;
  std::vector<motion::BodySource> sources_;
};

/// The process's own subdomain, of columns that it makes itself.
/// @param lower  places of its nodes along the whole interface
std::unique_ptr<motion::Subdomain> make_subdomain(Processes& processes, const input::Case& config,
                                                  const Plan& plan, const mesh::Subset& interface_nodes,
                                                  statics::DistributedFields* kept) {
  const int rank = processes.rank();
  const Columns columns(config, plan.partition.all(rank), plan.partition.n_columns(),
                        plan.partition.own(rank), plan.steps,
                        [&](std::span<double> values) { processes.reduce_max(values); });
  return std::make_unique<motion::Subdomain>(
      processes, plan.partition, columns.sources(), contact_of(config, plan.whole_x_m, interface_nodes),
      config.time, motion::Execution{.threads = plan.threads}, interface_nodes, kept);
}

std::unique_ptr<motion::Subdomain> take_part(Processes& processes, MessageBuffer& given,
                                             statics::DistributedFields& kept) {
  const auto config = unpack_case(given);
  const auto plan = Plan::take(given);
  return make_subdomain(processes, config, plan, mesh::Subset(given.take_all<mesh::Subset::Range>()), &kept);
}

}  // namespace

GlobalBodies::GlobalBodies(const input::Case& config, const mesh::Mesh& plate,
                           const std::optional<mesh::Mesh>& base)
    : config_(config), base_material_(input::base_material(config)) {
  if (plate.is_interface() && config.plate.corner == mesh::Corner::relief)
    corners_ = mesh::make_corners(config.plate, solid::rings_around_others);
  bodies_.push_back({plate, config.material, nullptr, corners_ ? &*corners_ : nullptr});
  if (base) bodies_.push_back({*base, base_material_});
}

std::vector<motion::BodySteps> GlobalBodies::steps() const {
  std::vector<motion::BodySteps> steps;
  for (const auto& body : bodies_) steps.push_back(motion::body_steps(body, config_.time));
  return steps;
}

motion::Partition GlobalBodies::divided(int n_processes, std::span<const motion::BodySteps> steps) const {
  return motion::partition_bodies(bodies_, steps, config_.time, n_processes);
}

void require_divisible(const input::Case& config, const Processes& processes) {
  const auto meshes = check(config, &processes);
  plan_for(GlobalBodies(config, meshes.plate, meshes.base), processes.size());
}

IsolatedSubdomain make_isolated_subdomain(const input::Case& config, const mesh::Mesh& interface,
                                          const std::vector<motion::BodySteps>& steps, solid::Span columns) {
  const mesh::Subset all({{columns.begin, columns.end}});
  Columns some(config, all, interface.grid.stride(), columns, steps, [](std::span<double>) {});
  const auto contact =
      contact_of(config, interface_x_m(interface), motion::interface_nodes_in(interface, all));
  auto stepper = std::make_unique<motion::Stepper>(some.sources(), contact, config.time, motion::Execution{});
  return {std::move(some.plate), std::move(some.base), std::move(stepper)};
}

std::unique_ptr<motion::DistributedStepper> new_distributed_stepper(
    const input::Case& config, const mesh::Mesh& plate, const std::optional<mesh::Mesh>& base,
    Processes& processes, const motion::Execution& execution, statics::DistributedFields* kept) {
  const GlobalBodies whole(config, plate, base);
  auto plan = plan_for(whole, processes.size());
  std::vector<const mesh::Mesh*> meshes;
  for (const auto& body : whole.bodies()) meshes.push_back(&body.mesh);
  plan.threads = execution.threads;
  std::unique_ptr<motion::DistributedStepper> stepper;
  or_fail(processes, [&] {
    for (int rank = 1; rank < processes.size(); ++rank) {
      MessageBuffer buffer;
      buffer.put(motion::SubdomainCommand::build);
      pack_case(config, buffer);
      plan.put(buffer);
      buffer.put(lower_of(whole, plan, rank).ranges());
      processes.send(rank, buffer);
    }
    stepper = std::make_unique<motion::DistributedStepper>(
        processes, plan.partition, make_subdomain(processes, config, plan, lower_of(whole, plan, 0), kept),
        meshes);
  });
  return stepper;
}

void lead(Processes& processes) {
  std::string other;
  for (int rank = 1; rank < processes.size(); ++rank) {
    const auto program = processes.receive(rank).take_text();
    if (other.empty() && program != program_identity())
      other = fmt::format("slipfront: process {} is {}, and process 0 {}; start the same program everywhere",
                          rank, program, program_identity());
  }
  const auto is_one_program = static_cast<std::uint8_t>(other.empty());
  for (int rank = 1; rank < processes.size(); ++rank)
    processes.send(rank, MessageBuffer().put(is_one_program));
  if (!other.empty()) throw UserError("{}", other);
}

namespace {

/// Of a process's links that to another one: whether it measures, or answers.
MessageBuffer network_command(int with, bool measures) {
  MessageBuffer buffer;
  buffer.put(motion::SubdomainCommand::network).put(with).put(static_cast<std::uint8_t>(measures));
  return buffer;
}

void carry_out_network(Processes& processes, MessageBuffer& given) {
  const int with = given.take<int>();
  if (given.take<std::uint8_t>() == 0) return answer_link(processes, with);
  processes.send(0, MessageBuffer().put(measure_link(processes, with)));
}

}  // namespace

std::vector<Link> measure_network(Processes& processes) {
  const auto measured = [&](int from, int to) {
    processes.send(to, network_command(from, false));
    if (from == 0) return measure_link(processes, to);
    processes.send(from, network_command(to, true));
    return processes.receive(from).take<Link>();
  };
  std::vector<Link> links;
  for (int rank = 1; rank < processes.size(); ++rank) links.push_back(measured(rank - 1, rank));
  for (int rank = 2; rank < processes.size(); ++rank) links.push_back(measured(0, rank));
  return links;
}

SharedStatics::SharedStatics(Processes* processes) : processes_(processes) {
  if (processes_ == nullptr) return;
  for (int rank = 1; rank < processes_->size(); ++rank)
    processes_->send(rank, MessageBuffer().put(motion::SubdomainCommand::statics));
}

SharedStatics::~SharedStatics() {
  if (processes_ != nullptr) statics::release_statics(*processes_);
}

void serve(Processes& processes) try {
  // What a signal asks for is the leader's to hear.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ, SIGPIPE, SIGUSR1})
    std::signal(signal, SIG_IGN);
  processes.send(0, MessageBuffer().put(program_identity()));
  if (processes.receive(0).take<std::uint8_t>() == 0) return;
  statics::DistributedFields kept;
  for (;;) {
    auto buffer = processes.receive(0);
    const auto command = buffer.take<motion::SubdomainCommand>();
    if (command == motion::SubdomainCommand::end) return;
    if (command == motion::SubdomainCommand::network) {
      carry_out_network(processes, buffer);
      continue;
    }
    if (command == motion::SubdomainCommand::fields) {
      carry_out_fields(processes, buffer);
      continue;
    }
    if (command == motion::SubdomainCommand::statics) {
      statics::serve_statics(processes, kept);
      continue;
    }
    const auto part = take_part(processes, buffer, kept);
    motion::serve(processes, *part);
  }
} catch (const std::exception& error) {
  processes.fail(reason_of(error));
}

void dismiss(Processes& processes) {
  for (int rank = 1; rank < processes.size(); ++rank)
    processes.send(rank, MessageBuffer().put(motion::SubdomainCommand::end));
}

}  // namespace slipfront::run
