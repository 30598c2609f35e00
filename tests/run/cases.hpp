// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "run/run.hpp"
#include "setup/cases.hpp"

namespace slipfront::test {

inline run::Result run_case(const input::Case& config) {
  const auto problem = make_problem(config);
  return run::run_from(problem, setup::make_initial_state(problem, go_on), go_on);
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

}  // namespace slipfront::test
