// SPDX-License-Identifier: BSD-3-Clause
#include "run/parts.hpp"

#include <csignal>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "input/friction_along_x.hpp"
#include "input/schema.hpp"
#include "mesh/part.hpp"
#include "run/checkpoint.hpp"
#include "run/choices.hpp"

namespace slipfront::run {

namespace {

void put_mesh(const mesh::Mesh& mesh, Parcel& to) {
  to.put(mesh.grid).put(mesh.x_m).put(mesh.y_m).put(mesh.cells).put(mesh.lower).put(mesh.top);
  to.put(mesh.absorbing);
}

mesh::Mesh take_mesh(Parcel& from) {
  mesh::Mesh mesh;
  mesh.grid = from.take<mesh::Grid>();
  mesh.x_m = from.take_all<double>();
  mesh.y_m = from.take_all<double>();
  mesh.cells = from.take_all<mesh::Cell>();
  mesh.lower = from.take_all<mesh::Node>();
  mesh.top = from.take_all<mesh::Node>();
  mesh.absorbing = from.take_all<mesh::AbsorbingNode>();
  return mesh;
}

/// What a process needs to make its part.
struct Plan {
  motion::Division division;
  int threads = 1;
  std::vector<double> stable_steps_s;  ///< of the bodies
  int first_lower = 0;  ///< of the process that this is for: its first place along the interface

  void put(Parcel& to) const {
    to.put(division.first).put(division.halo).put(division.steps_per_exchange).put(threads);
    to.put(stable_steps_s).put(first_lower);
  }
  static Plan take(Parcel& from) {
    Plan plan;
    plan.division.first = from.take_all<int>();
    plan.division.halo = from.take<int>();
    plan.division.steps_per_exchange = from.take<int>();
    plan.threads = from.take<int>();
    plan.stable_steps_s = from.take_all<double>();
    plan.first_lower = from.take<int>();
    return plan;
  }
};

/// @param meshes  the process's columns of the bodies
std::unique_ptr<motion::Part> make_part(Processes& processes, const input::Case& config, const Plan& plan,
                                        const std::vector<mesh::Mesh>& meshes) {
  const auto all = plan.division.all(processes.rank()), own = plan.division.own(processes.rank());
  const auto base_material = input::base_material(config);
  std::vector<motion::PartOfBody> parts;
  for (const double stable_s : plan.stable_steps_s)
    parts.push_back(
        {{own.begin - all.begin, own.end - all.begin}, stable_s, {1}, [&](std::span<double> values) {
           processes.take_largest(values);
         }});
  std::vector<motion::BodySource> sources = {{meshes.front(), config.material, &parts.front()}};
  if (meshes.size() > 1) sources.push_back({meshes.back(), base_material, &parts.back()});
  const auto contact = input::contact_model(config, interface_x_m(meshes.front()));
  return std::make_unique<motion::Part>(
      processes, plan.division, sources, contact, config.time, motion::Execution{.threads = plan.threads},
      motion::PlaceInWhole{parts.front().own, all.begin, plan.division.first.back(), plan.first_lower});
}

std::unique_ptr<motion::Part> take_part(Processes& processes, Parcel& given) {
  if (const auto program = given.take_text(); program != program_identity())
    throw UserError("the program here is {}, and that of process 0 {}; start the same one everywhere",
                    program_identity(), program);
  const std::filesystem::path case_file = given.take_text();
  const auto plan = Plan::take(given);
  std::vector<mesh::Mesh> meshes;
  while (!given.is_empty()) meshes.push_back(take_mesh(given));
  return make_part(processes, input::read_case(case_file), plan, meshes);
}

}  // namespace

void require_divisible(const input::Case& config) {
  if (config.plate.sides == mesh::Sides::periodic)
    throw UserError("{} = periodic cannot be shared by several processes; start one alone, with threads",
                    Key("plate.sides"));
  const auto require_even = [](const mesh::Plate& plate, const char* key) {
    if (plate.coarsenings > 0)
      throw UserError(
          "{} = {} cannot be shared by several processes; start one alone, with threads, or choose 0",
          Key(key), plate.coarsenings);
  };
  require_even(config.plate, "plate.coarsenings");
  if (input::has_base_body(config)) require_even(input::base_plate(config), "base.coarsenings");
}

std::unique_ptr<motion::PartedStepper> new_parted_stepper(const input::Case& config, const mesh::Mesh& plate,
                                                          const std::optional<mesh::Mesh>& base,
                                                          const Together& together,
                                                          const motion::Execution& execution) {
  require_divisible(config);
  auto& processes = *together.processes;
  const auto base_material = input::base_material(config);
  std::vector<motion::BodySource> whole = {{plate, config.material}};
  if (base) whole.push_back({*base, base_material});
  Plan plan;
  plan.threads = execution.threads;
  for (const auto& body : whole) plan.stable_steps_s.push_back(motion::stable_step_s(body));
  plan.division = motion::divide_columns(plate.grid.stride(), processes.size(),
                                         motion::columns_per_step(plan.stable_steps_s, config.time),
                                         motion::halo_for(plate, config.fronts.l_star_m));
  const auto columns_of = [&](int rank) {
    const auto all = plan.division.all(rank);
    std::vector<mesh::Mesh> meshes;
    for (const auto& body : whole) {
      auto part = mesh::columns_of(body.mesh, all.begin, all.end);
      if (meshes.empty()) plan.first_lower = static_cast<int>(part.first_lower);
      meshes.push_back(std::move(part.mesh));
    }
    return meshes;
  };
  std::vector<const mesh::Mesh*> bodies = {&plate};
  if (base) bodies.push_back(&*base);
  for (int rank = 0; rank < processes.size(); ++rank) columns_of(rank);  // refuses cuts through corners
  for (int rank = 1; rank < processes.size(); ++rank) {
    Parcel parcel;
    parcel.put(motion::PartCommand::build).put(program_identity()).put(together.case_file.string());
    const auto meshes = columns_of(rank);
    plan.put(parcel);
    for (const auto& mesh : meshes) put_mesh(mesh, parcel);
    processes.send(rank, parcel);
  }
  std::unique_ptr<motion::PartedStepper> stepper;
  try {
    const auto meshes = columns_of(0);
    stepper = std::make_unique<motion::PartedStepper>(processes, plan.division,
                                                      make_part(processes, config, plan, meshes), bodies);
  } catch (const std::exception& error) {
    processes.fail(error.what());  // the others wait for this part
  }
  return stepper;
}

void serve(Processes& processes) {
  // What a signal asks for is the leader's to hear.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) std::signal(signal, SIG_IGN);
  for (;;) {
    auto parcel = processes.receive(0);
    if (parcel.take<motion::PartCommand>() == motion::PartCommand::end) return;
    try {
      const auto part = take_part(processes, parcel);
      motion::serve(processes, *part);
    } catch (const std::exception& error) {
      processes.fail(error.what());
    }
  }
}

void dismiss(Processes& processes) {
  for (int rank = 1; rank < processes.size(); ++rank)
    processes.send(rank, Parcel().put(motion::PartCommand::end));
}

}  // namespace slipfront::run
