// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/part.hpp"

namespace slipfront::run {

/// What lies between two neighbouring processes, as `slipfront bench --network` measures it.
struct Network {
  double latency_s = 0;
  double bandwidth_bytes_per_s = 0;  ///< each way at once
};
/// Of processes on one machine: Open MPI 4.1, two cores of an AMD EPYC (Zen 4), a virtual machine.
inline constexpr Network shared_memory = {0.4e-6, 4e9};

/// What it costs the leader to command, and to put together what it is answered, measured on such a core.
struct LeaderRates {
  double s_per_message = 2e-6;       ///< to send a command or to receive an answer
  double s_per_update = 0.1e-6;      ///< to join what one part saw in one contact update
  double handled_bytes_per_s = 1e9;  ///< of samples and snapshots, taken apart and joined again
  double halo_bytes_per_s = 2e9;     ///< of each process: halos packed and unpacked
};

/// What a case asks of the processes that share it.
struct SharedWork {
  double n_nodes = 0, n_cells = 0, n_columns = 0;  ///< columns of nodes, the same as interface nodes
  double node_updates_per_step = 0;
  double node_updates_per_s = 0;  ///< of one processor
  double values_per_column = 0;   ///< that an exchange sends
  double updates_per_step = 1;    ///< of the contact
  double steps = 0;
  double commands = 0;  ///< of the event
  double history_rows = 0, values_per_row = 0;
  double snapshots = 0;
  double statics_s = 0, statics_bytes = 0;
  motion::Precision precision = motion::Precision::double_precision;
  double bytes_per_interface_node = 0;  ///< see there
  double program_bytes = 0;
};

/// Times of the whole run, of the process with most to do and of what it waits for.
struct ProcessCost {
  double own_s = 0;           ///< columns that the process accounts for
  double halo_s = 0;          ///< columns that others account for, computed as well
  double exchange_s = 0;      ///< of the halos
  double command_s = 0;       ///< from the leader and back
  double gathering_s = 0;     ///< of samples, of what each contact update saw, of snapshots
  double statics_s = 0;       ///< which the leader solves while the others wait
  double start_s = 0;         ///< meshes and initial motion, sent by the leader
  double bytes_per_step = 0;  ///< that a process between two others sends in exchanges
  double memory_bytes = 0, leader_memory_bytes = 0;

  double event_s() const { return own_s + halo_s + exchange_s + command_s + gathering_s; }
  double total_s() const { return event_s() + statics_s + start_s; }
};

/// The cost of a case shared by the parts of a division, P processes on C processors of one speed:
///
///   own        n u w / r max(1, P/C)               n steps, u node updates per column, w own columns, r rate
///   halo       n u (s h) / r max(1, P/C)           s sides with a neighbour (2, or 1 of two processes), h
///   columns exchange   n/k (L + s m / B + 2 s m / b)       k steps per exchange, m bytes of a halo, L
///   latency,
///                                                  B bandwidth, b packing and unpacking
///   commands   c (2 L + 2 (P - 1) o)               c commands, o for each message of the leader
///   gathering  n q P a + G (1/B + 1/g)             q contact updates a step, a for each part's, G bytes of
///   samples
///                                                  and snapshots that are not the leader's own, g its
///                                                  handling
///   statics    as by one process
///   start      S (1/B + 1/g)                       S bytes of meshes and initial motion
///
/// Nothing overlaps: a part waits for its neighbours before it goes on, and all wait for the leader.
/// @param work        of the whole case
/// @param processors  of the machines together
ProcessCost process_cost(const SharedWork& work, const motion::Division& division, int processors,
                         const Network& network, const LeaderRates& leader = {});

}  // namespace slipfront::run
