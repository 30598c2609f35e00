// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/part.hpp"

namespace slipfront::run {

/// What lies between two neighbouring processes, as `slipfront bench --network` measures it.
struct Network {
  double latency_s = 0;
  double bandwidth_bytes_per_s = 0;  ///< each way at once
  /// By which a byte that goes or comes holds up what is computed meanwhile.
  double processor_s_per_byte = 0;
};
/// Of processes on one machine: Open MPI 4.1, two cores of an AMD EPYC (Zen 4), a virtual machine.
inline constexpr Network shared_memory = {0.5e-6, 10e9};

/// What a core does to what is sent, measured on such a one.
struct Handling {
  double s_per_message = 2e-6;    ///< to send a command or to receive an answer
  double bytes_per_s = 0.8e9;     ///< samples and snapshots, packed by each part and joined
  double halo_bytes_per_s = 5e9;  ///< packed or unpacked
};

/// Of a node: its place and its share of the cells; u_m and u_per_shear before the event.
inline constexpr double mesh_bytes_per_node = 2 * sizeof(double) + sizeof(mesh::Cell),
                        state_bytes_per_node = 4 * sizeof(double);
/// Of a node, what processes keep of it in a checkpoint, with its number.
inline constexpr double kept_bytes_per_node = 40;

/// What the process that leads several has of every node of the bodies while the event begins.
double leaders_bytes_per_node(bool leads_by_interface, bool keeps_displacements);

/// What a case asks of the processes that share it.
struct SharedWork {
  double n_nodes = 0, n_cells = 0, n_columns = 0;  ///< columns of nodes, the same as interface nodes
  double node_updates_per_step = 0;
  double node_updates_per_s = 0;  ///< of one processor
  double bytes_per_column = 0;    ///< that an exchange sends
  /// Of these, and of a step's time the share, what goes with the interface, before other rows.
  double interface_bytes_per_column = 0, interface_share = 0;
  double steps = 0;
  double advances = 1;  ///< commands in which these steps are taken
  double energies = 0;  ///< sums over all nodes
  double history_rows = 0, values_per_row = 0;
  double snapshots = 0;
  bool leads_by_interface = false;          ///< the leader holds nothing of all nodes
  double corner_bytes = 0;                  ///< but for the cells at the corners, while the event begins
  bool keeps_displacements = false;         ///< nor displacements before the event
  double statics_s = 0, statics_bytes = 0;  ///< of the leader
  double shared_statics_bytes = 0;          ///< of each other process, where they share the statics
  motion::Precision precision = motion::Precision::double_precision;
  double bytes_per_interface_node = 0;  ///< see there
  double program_bytes = 0;
  double recorded_bytes = 0;  ///< of the leader: rows of energies, and what waits to be written
};

/// Times of the whole run, of the process with most to do and of what it waits for.
struct ProcessCost {
  double own_s = 0;           ///< columns that the process accounts for
  double halo_s = 0;          ///< columns that others account for, computed as well
  double exchange_s = 0;      ///< of the halos: packing, and what no computing covers of their way
  double command_s = 0;       ///< from the leader to all and back
  double gathering_s = 0;     ///< of samples, of what is known of the last contact update, of snapshots
  double statics_s = 0;       ///< for which the others wait, or which they share
  double start_s = 0;         ///< meshes and initial motion, sent by the leader
  double checkpoint_s = 0;    ///< of each, in no sum: passed on by the leader, besides what the disk takes
  double bytes_per_step = 0;  ///< that the process with most neighbours sends in exchanges
  double record_bytes = 0;    ///< of the leader's: what is recorded at all interface nodes
  double memory_bytes = 0, leader_memory_bytes = 0;

  double event_s() const { return own_s + halo_s + exchange_s + command_s + gathering_s; }
  double total_s() const { return event_s() + statics_s + start_s; }
};

/// The cost of a case shared by the parts of a division, P processes on C processors of one speed.
///
/// n steps in A commands, u node updates of a column in a step, r node updates/s, latency L, bandwidth B:
/// - own columns: (n + e) u w / r max(1, P/C), w of them, e sums of the energies, each as long as a step
/// - halo: n u s h / r max(1, P/C), h columns on s sides with a neighbour, 2, or 1 of two processes
/// - exchange: floor(n/k) (H + max(0, f T + l(i) + s i/B - T, s m/B - T)), H = 2 s m (1/b + c max(1, P/C)),
///   k steps to an exchange in the time T, H included, a share f of it for what goes with the interface; m
///   bytes of a halo, i of these with the interface; rate b of packing, c processor time of a byte on its
///   way
/// - commands: (A + e) 2 d (L + o) + A sum (l(2^i a) - L) + s 2 (L + (P - 1) o), i < d, d levels of the tree
///   of processes, o for a message, a bytes of a part's answer, s pieces of snapshots, for which the leader
///   asks all parts
/// - gathering: G ((1 - 1/P)/B + (2 - 1/P)/g) + S F, G bytes of what parts tell of the interface, joined
/// level
///   by level, S of snapshots
/// - statics: as by one process; by PETSc, of the processes together
/// - start: I F, I bytes of initial motion
///
/// l(m) = L up to 64 KiB and 3 L for more, which MPI sends when it is asked for them.
///
/// F = (1 - 1/P)/B + (1 + 1/P)/g: the bytes of the others pass between processes, the leader handles all at
/// the rate g, each part its own; of one process 1/g.
///
/// Only the halo's way overlaps with computing: rows of a step that has moved them are sent, see
/// motion::Halo. The interface is first in each step, so it is on its way while the rows above it move.
/// @param work        of the whole case
/// @param processors  of the machines together
ProcessCost process_cost(const SharedWork& work, const motion::Division& division, int processors,
                         const Network& network, const Handling& handling = {});

}  // namespace slipfront::run
