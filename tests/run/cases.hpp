// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/friction_table.hpp"
#include "input/schema.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "problem/problem.hpp"
#include "run/run.hpp"
#include "support/files.hpp"

namespace slipfront::test {

using problem::make_problem;

/// The plate of Kammer et al. (2012) on the rigid plane.
inline input::Case paper_case() {
  auto config = input::parse_tables({{"plate.width_m", "0.2"},
                                     {"plate.height_m", "0.1"},
                                     {"plate.corner", "relief"},
                                     {"material.stiffness_damping_s", "0.1e-6"},
                                     {"base.kind", "rigid"},
                                     {"loading.tilt_left_m", "0.37e-3"},
                                     {"loading.tilt_right_m", "0.037e-3"},
                                     {"friction.law", "velocity_weakening"},
                                     {"event.kind", "spontaneous"}});
  // What other events and corners than its own have by default.
  config.plate.fillet_radius_m = 5e-3;
  config.trigger.zone_m = 10e-3;
  config.trigger.ramp_s = 5e-6;
  config.nucleation = {.x_m = 0.1, .half_length_m = 10e-3, .taper_m = 5e-3};
  return config;
}

/// That on a mesh that a run takes milliseconds for.
inline input::Case coarse_case(interface::EventKind event = interface::EventKind::spontaneous,
                               double element_size_m = 4e-3) {
  auto config = paper_case();
  config.plate.element_size_m = element_size_m;
  config.event = event;
  config.time.end_s = 250e-6;
  return config;
}

/// A plate under uniform tractions, without ends, whose event starts at a patch.
inline input::Case prestressed_case(double element_size_m = 2e-3) {
  auto config = coarse_case(interface::EventKind::nucleation, element_size_m);
  config.plate.corner = mesh::Corner::none;
  config.plate.sides = mesh::Sides::periodic;
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress = {4e6, 5e6, ""};
  return config;
}

/// The paper's plate loaded by an explicit ramp.
inline input::Case ramped_case() {
  auto config = coarse_case(interface::EventKind::spontaneous, 5e-3);
  config.loading.method = statics::LoadingMethod::ramp;
  return config;
}

/// Parameters of a case's velocity weakening.
struct LawOfCase {
  double &mu_s, &mu_k, &alpha_m2_per_s2;
};
inline LawOfCase law(input::Case& config) {
  auto& friction = config.friction;
  return {friction.parameter("mu_s"), friction.parameter("mu_k"), friction.parameter("alpha_m2_per_s2")};
}

/// Gives a case a table of friction.
inline void set_table(input::Case& config, const std::string& text) {
  const TemporaryFolder folder;
  const auto file = folder / "friction.csv";
  write_file(file, text);
  config.friction_along_x.file = file.string();
  config.friction_along_x.table = input::read_friction_table(file, config.friction);
}

inline bool go_on(std::int64_t, std::int64_t) {
  return true;
}

inline run::Result run_case(const input::Case& config) {
  const auto problem = make_problem(config);
  return run::run_from(problem, run::make_initial_state(problem, go_on), go_on);
}

/// The history of a result that was not written.
inline record::History history_of(const run::Result& result) {
  record::History history;
  history.law_states.resize(result.problem.friction.law.states().size());
  const auto& rows = result.rows.at(results::history_output.file).values;
  history.x_m = result.event.record.x_m;
  const auto n = static_cast<std::ptrdiff_t>(history.x_m.size());
  const auto members = members_of(history);
  for (auto at = rows.begin(); at != rows.end();)
    for (auto* values : members) {
      const auto end = at + (values == members.front() ? 1 : n);
      values->insert(values->end(), at, end);
      at = end;
    }
  return history;
}

/// Its snapshots, of bodies with so many nodes.
inline std::vector<motion::Snapshot> snapshots_of(const run::Result& result, std::int64_t n) {
  std::vector<motion::Snapshot> snapshots;
  const auto found = result.rows.find(results::snapshot_output.file);
  if (found == result.rows.end()) return snapshots;
  const auto& rows = found->second.values;
  for (auto at = rows.begin(); at != rows.end();) {
    motion::Snapshot& snapshot = snapshots.emplace_back();
    snapshot.time_s = *at++;
    for (auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
      for (auto* component : {&field->x, &field->y}) {
        component->assign(at, at + n);
        at += n;
      }
  }
  return snapshots;
}

inline constexpr const char* accepted = "(nothing thrown)";

/// What is wrong with a case before anything is solved, or that it is accepted.
inline std::string check_error(const input::Case& config) {
  return error_of([&] { run::check(make_problem(config)); });
}

}  // namespace slipfront::test
