// SPDX-License-Identifier: BSD-3-Clause
#include "setup/outputs.hpp"

#include "results/snapshots.hpp"
#include "setup/snapshot_plan.hpp"

namespace slipfront::setup {

results::Origin origin_of(const Problem& problem) {
  return {problem.source.title, problem.source.case_text};
}

results::OutputSetup output_setup(const Problem& problem, double step_s, double n_interface, double n_nodes) {
  const auto& material = problem.above().material;
  results::OutputSetup setup{.origin = origin_of(problem),
                             .step_s = step_s,
                             .end_s = problem.time.end_s,
                             .n_interface = n_interface,
                             .n_nodes = n_nodes,
                             .history_interval_s = problem.output.history_interval_s,
                             .probes = problem.probes,
                             .probe_interval_s = problem.probe_interval_s,
                             .snapshot_times_s = snapshot_plan(problem, step_s).times_s,
                             .snapshot_stress = problem.output.snapshot_stress,
                             .moment_rate = problem.output.moment_rate,
                             .shear_modulus_Pa = solid::shear_modulus_Pa(material),
                             .c_S_m_per_s = solid::shear_speed_m_per_s(material),
                             .further_stress = prescribed_stress(problem)};
  for (const auto& state : problem.friction.law.states())
    setup.law_states.push_back({state.name, state.unit, state.description});
  return setup;
}

results::OutputSetup output_setup(const Problem& problem, const InitialState& initial, double step_s) {
  const auto& x_m = initial.subcritical.tractions.x_m;
  auto setup =
      output_setup(problem, step_s, static_cast<double>(x_m.size()), static_cast<double>(initial.n_nodes));
  setup.x_m = x_m;
  setup.tributary_m = initial.tributary_m;
  setup.seam = results::seam(initial.mesh);
  if (initial.base) {
    const auto below = results::seam(*initial.base, static_cast<std::size_t>(n_nodes_of(initial.mesh)));
    setup.seam.insert(setup.seam.end(), below.begin(), below.end());
  }
  return setup;
}

}  // namespace slipfront::setup
