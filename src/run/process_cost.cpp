// SPDX-License-Identifier: BSD-3-Clause
#include "run/process_cost.hpp"

#include <algorithm>
#include <cmath>

#include "motion/event.hpp"

namespace slipfront::run {

namespace {

constexpr double number_bytes = sizeof(double);

/// Larger messages are sent when they are asked for: Open MPI's over TCP, where latency counts most.
constexpr double eager_bytes = 64 << 10;
/// u_m, v_m_per_s of a snapshot.
constexpr double bytes_of_snapshot = 4 * number_bytes;
/// Of an interface node what SlipFinder knows of the last contact update.
constexpr double bytes_of_memory = 3 * number_bytes + 1;
/// Columns of the part that computes most.
struct Widest {
  double own = 0, halo = 0;
  int n_sides = 0;
};

Widest widest(const motion::Division& division) {
  Widest most;
  for (int part = 0; part < division.n_parts(); ++part) {
    const auto own = division.own(part);
    const int below = division.halo_below(part), above = division.halo_above(part);
    const double n_own = own.end - own.begin, n_halo = below + above;
    const int n_sides = (below > 0 ? 1 : 0) + (above > 0 ? 1 : 0);
    if (n_own + n_halo > most.own + most.halo) most = {n_own, n_halo, n_sides};
  }
  return most;
}

}  // namespace

double leaders_bytes_per_node(bool leads_by_interface, bool keeps_displacements) {
  if (leads_by_interface) return 0;
  return mesh_bytes_per_node + (keeps_displacements ? 0 : state_bytes_per_node);
}

ProcessCost process_cost(const SharedWork& work, const motion::Division& division, int processors,
                         const Network& network, const Handling& handling) {
  const double n_parts = division.n_parts(), others = n_parts - 1;
  const auto part = widest(division);
  const double sharing = std::max(1.0, n_parts / processors);
  const double s_per_column = work.node_updates_per_step / work.n_columns / work.node_updates_per_s * sharing;
  ProcessCost cost;
  cost.own_s = (work.steps + work.energies) * part.own * s_per_column;
  cost.halo_s = work.steps * part.halo * s_per_column;

  const auto latency_s = [&](double bytes) { return (bytes > eager_bytes ? 3 : 1) * network.latency_s; };
  const double halo_bytes = division.halo * work.bytes_per_column;
  const double exchanges = std::floor(work.steps / division.steps_per_exchange);
  cost.bytes_per_step = exchanges * part.n_sides * halo_bytes / work.steps;
  if (part.n_sides > 0) {
    const auto way_s = [&](double bytes) { return part.n_sides * bytes / network.bandwidth_bytes_per_s; };
    const double handling_s = 2 * part.n_sides * halo_bytes *
                              (1 / handling.halo_bytes_per_s + network.processor_s_per_byte * sharing);
    const double steps_s = division.steps_per_exchange * (part.own + part.halo) * s_per_column + handling_s;
    const double interface_bytes = division.halo * work.interface_bytes_per_column;
    const double waiting_s = std::max(
        {0.0, work.interface_share * steps_s + latency_s(interface_bytes) + way_s(interface_bytes) - steps_s,
         way_s(halo_bytes) - steps_s});
    cost.exchange_s = exchanges * (handling_s + waiting_s);
  }

  const auto passed_s = [&](double bytes, double times_handled) {
    return bytes * (others / n_parts / network.bandwidth_bytes_per_s + times_handled / handling.bytes_per_s);
  };
  const double by_leader_and_parts = others > 0 ? 1 + 1 / n_parts : 1;
  const double by_tree = 2 - 1 / n_parts;  // all by the leader, half of it by one below, a quarter ...
  const double told_bytes = work.history_rows * work.values_per_row * number_bytes +
                            (others > 0 ? work.advances * bytes_of_memory * work.n_columns : 0);
  cost.gathering_s = passed_s(told_bytes, by_tree) +
                     passed_s(work.snapshots * bytes_of_snapshot * work.n_nodes, by_leader_and_parts);
  if (others > 0) {
    const double levels = std::ceil(std::log2(n_parts));
    cost.command_s =
        (work.advances + work.energies) * 2 * levels * (network.latency_s + handling.s_per_message);
    const double pieces =
        motion::n_motion_components *
        std::ceil(work.n_nodes / std::max<double>(motion::nodes_of_snapshot_piece, work.n_columns));
    cost.command_s += work.snapshots * pieces * 2 * (network.latency_s + others * handling.s_per_message);
    for (double parts = 1; parts < n_parts; parts *= 2)
      cost.command_s +=
          work.advances * (latency_s(parts * told_bytes / n_parts / work.advances) - network.latency_s);
    const bool is_unstrained = work.leads_by_interface && !work.keeps_displacements;
    cost.start_s = is_unstrained ? 0 : passed_s(state_bytes_per_node * work.n_nodes, by_leader_and_parts);
  }
  cost.statics_s = work.statics_s;
  cost.checkpoint_s = passed_s(kept_bytes_per_node * work.n_nodes, by_leader_and_parts);

  const double share = (part.own + part.halo) / work.n_columns;
  const double messages = 3 * part.n_sides * halo_bytes;  // two that are sent, one that comes
  const double of_part =
      motion::event_bytes(share * work.n_nodes, share * work.n_cells, false, work.precision) +
      share * work.bytes_per_interface_node * work.n_columns + messages;
  cost.memory_bytes = work.program_bytes + std::max(work.shared_statics_bytes, of_part);
  // What a part is sent is made when it is sent. A checkpoint, written from answers taken one by one, takes
  // less than the building of the leader's own part has taken.
  const double sent = n_parts > 1 ? share * state_bytes_per_node : 0;
  const double of_node = leaders_bytes_per_node(work.leads_by_interface, work.keeps_displacements);
  const double starting = work.leads_by_interface ? work.corner_bytes : (of_node + sent) * work.n_nodes;
  cost.record_bytes = work.bytes_per_interface_node * work.n_columns;
  cost.leader_memory_bytes =
      work.program_bytes +
      std::max(work.statics_bytes, of_part + starting + work.recorded_bytes + cost.record_bytes);
  return cost;
}

}  // namespace slipfront::run
