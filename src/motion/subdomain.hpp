// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "motion/halo.hpp"
#include "motion/partition.hpp"
#include "motion/slip_finder.hpp"
#include "motion/state_by_node.hpp"
#include "motion/stepper.hpp"
#include "processes/processes.hpp"
#include "statics/distributed_field.hpp"

namespace slipfront::motion {

/// Commands of the leader to all subdomains; values follow the command's number.
enum class SubdomainCommand : int {
  network,     ///< run::serve measures it, or answers one that does
  statics,     ///< run::serve does its share of the statics
  fields,      ///< run::serve writes its share of fields.vtkhdf
  build,       ///< run::serve makes the subdomain
  kept,        ///< displacements before the event that the process keeps
  place,       ///< some of these, which the subdomain needs
  start,       ///< begin at an equilibrium, its displacements given or placed before
  set_probes,  ///< look at probes
  memory,      ///< of the last contact update, from which slip is found
  advance,     ///< take steps
  tractions,   ///< near the subdomain's ends, in contact updates of these steps
  energies,    ///< and works
  measures,    ///< see SubdomainMeasures
  snapshot,    ///< own columns of a chunk of it
  probed,      ///< displacements and velocities at the probes
  keep,        ///< the state, for a checkpoint
  restore,     ///< the loads, and a chunk of a state that was kept
  release,     ///< the subdomain is needed no more
  end,         ///< and neither is the process
};

/// Whether the command is collective: the same for all subdomains, with answers that can be joined. It passes
/// down the tree of ranks, and answers pass up (processes/tree.hpp). Other commands go from the leader to
/// each rank; they come before the first collective one, with answers.
bool is_collective(SubdomainCommand command);

/// Cost of a subdomain since it was started or restored.
struct SubdomainCost {
  std::int64_t steps = 0;
  std::int64_t messages = 0, bytes = 0;  ///< that its process has sent
  double computing_s = 0;
  double exchange_s = 0;  ///< in exchanges with its neighbours
  double command_s = 0;   ///< waiting for commands, and for answers of others
};

/// Sums and maxima over a subdomain's owned nodes.
struct SubdomainMeasures {
  double kinetic_J_per_m = 0;
  double mass_kg_per_m = 0, plate_mass_kg_per_m = 0;
  double largest_acceleration_m_per_s2 = 0;
  double node_updates_per_step = 0;
  SubdomainCost cost;
};

/// Tractions near the ends of a subdomain at the contact updates of a command, for onsets of the neighbours'
/// nodes.
class TractionLog {
 public:
  TractionLog() = default;
  /// @param own    places of the subdomain's nodes along its interface
  /// @param reach  nodes around an onset whose tractions are recorded
  TractionLog(solid::Span own, int reach);

  void clear() { values_.clear(); }
  /// Those of the next update, [interface nodes of the subdomain]; first those before the command.
  void add(std::span<const double> t_Pa, std::span<const double> p_Pa);
  /// @pre the nodes lie within reach of an end
  record::Traction at(std::size_t update, int node) const;
  static double bytes_per_update(int n_own, int reach) {
    return 2.0 * sizeof(double) * std::min(n_own, 2 * reach);
  }

 private:
  std::vector<solid::Span> places_;
  std::size_t width_ = 0;  ///< nodes of them
  std::vector<double> values_;
};

/// Request for tractions of a subdomain's log.
struct TractionRequest {
  std::int64_t update = 0;  ///< of the command, from 0
  solid::Span nodes;        ///< places along the subdomain's interface
};

/// Most nodes of a chunk of a snapshot, unless a single row has more.
inline constexpr int nodes_of_snapshot_chunk = 1 << 19;

/// Some rows of nodes in a snapshot.
struct SnapshotChunk {
  MotionComponent component = MotionComponent::u_x;
  int body = 0;
  int first_row = 0, end_row = 0;
};

/// Place of a subdomain in the whole bodies.
struct SubdomainPlace {
  solid::Span own;               ///< columns that it accounts for
  mesh::Subset interface_nodes;  ///< places of its nodes along the interface
};

/// One rank's subdomain of an event's bodies. Every rank has one; DistributedStepper gives all of them the
/// same commands.
class Subdomain {
 public:
  /// @param sources   the bodies' columns `partition.all(processes.rank())`, with their BodySubdomain
  /// @param contact   of the subdomain's interface nodes
  /// @param interface_nodes     their places along the whole interface
  /// @param kept      displacements that this process has found, until the event starts
  Subdomain(Processes& processes, const Partition& partition, std::span<const BodySource> sources,
            const interface::ContactModel& contact, const TimeStepping& time, const Execution& execution,
            const mesh::Subset& interface_nodes, statics::DistributedFields* kept = nullptr);

  /// Carries out a command between build and release.
  void execute(SubdomainCommand command, MessageBuffer& given, MessageBuffer& answer);

  const Stepper& stepper() const { return *stepper_; }

 private:
  void place(MessageBuffer& given);
  void start(MessageBuffer& given);
  void restore(MessageBuffer& given);
  void advance(MessageBuffer& given, MessageBuffer& answer);
  void make_finder(MessageBuffer& given);
  void begin_counting();
  SubdomainCost cost() const;
  void put_snapshot(const SnapshotChunk& chunk, MessageBuffer& answer) const;

  Processes& processes_;
  SubdomainPlace place_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Halo> halo_;
  std::optional<SlipFinder> finder_;
  TractionLog log_;
  std::optional<StateRestorer> restorer_;  ///< until the last chunk has come
  statics::DistributedFields* displacements_;
  /// u_m, u_per_shear of the bodies as unknowns, see statics::Subdomain; empty unless they have been placed.
  std::array<std::array<solid::Field, 2>, 2> placed_;
  Processes::Counters counted_before_;
  std::int64_t first_counted_step_ = 0;
};

/// Executes a collective command on a rank's own subdomain and on those below it in the tree.
/// @param buffer  the command and its values, untouched
/// @return the subdomain's answer, and the joined answer of each child in the tree
/// @throws what the subdomain throws, and ProcessError for another one, after it has all answers
std::vector<MessageBuffer> execute_in_tree(Processes& processes, Subdomain& subdomain,
                                           const MessageBuffer& buffer);
/// Joins such answers.
MessageBuffer joined(SubdomainCommand command, std::span<MessageBuffer> answers);

/// Executes the leader's commands until release.
void serve(Processes& processes, Subdomain& subdomain);

}  // namespace slipfront::motion
